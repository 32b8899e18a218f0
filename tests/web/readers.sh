#!/bin/sh
# readers.sh BUILD: readers.js with files of all formats, and those of $PUPIL_SHARED, or ../shared next to the checkout.
set -eu
build=$1
folder=$(cd "$(dirname "$0")" && pwd)
for tool in node ffmpeg python3; do
    command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
python3 "$folder/make_stills.py" "$room"
shared=${PUPIL_SHARED:-$folder/../../../shared}
others=
if [ -d "$shared/malformed" ]; then
    # Without pictures of pure colours, which the program takes for a sensor's noise, and one of 4096 x 2048.
    others=$(find "$shared/malformed" "$shared/hdr" -name '*.exr' -o -name '*.png' -o -name '*.hdr' -o -name '*.pfm' |
        grep -Ev 'spruit|n6a16|basi6a16|AllHalfValues|tinyexr_2by2|rgbr4x4|denormal_and_fltmax' | sort)
fi
# Names of files without spaces: unquoted on purpose.
node "$folder/readers.js" "$build" "$PUPIL_PROGRAM" "$room"/* $others
