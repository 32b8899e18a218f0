#!/bin/sh
# page.sh BUILD: page.py with the page of BUILD (the preset wasm, with its tests).
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
python=
for one in python3 /usr/bin/python3; do
    $one -c 'import selenium' 2>/dev/null && python=$one
done
[ -n "$python" ] || { echo "skipped: no python3-selenium"; exit 77; }
for tool in chromium chromedriver ffmpeg; do
    command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
mkdir "$room/stills"
"$python" "$here/make_stills.py" "$room/stills"
"$python" "$here/page.py" "$build/apps/web/pupil.html" "$build/tests/stream" "$here/../stream/digests.txt" "$PUPIL_PROGRAM" \
    "$room/stills" "$build/shots"
