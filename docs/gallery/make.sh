#!/bin/sh
# make.sh IMAGES [PUPIL [BEFORE]]: makes the gallery of docs/pictures.md: its contact sheets in docs, and build/gallery
# with each picture and the tables.
#
# IMAGES is the folder of the HDR images. PUPIL and BEFORE are programs; without them this tree is built, and an older
# one, from before highlights held back the level. Needs Debian's python3-numpy, python3-opencv, python3-pil, ffmpeg with
# zscale and libplacebo, and a Vulkan driver (mesa-vulkan-drivers will do).
set -eu
cd "$(dirname "$0")/../.."
images=$1
before_commit=732f9d7
build() { # SOURCE BUILD
    cmake -S "$1" -B "$2" -DCMAKE_BUILD_TYPE=Release -DPUPIL_LAB=ON -DPUPIL_TESTS=OFF >/dev/null
    cmake --build "$2" --target pupil -j2 >/dev/null
}
if [ $# -lt 2 ]; then
    build . build/gallery/now
    set -- "$images" build/gallery/now/apps/pupil
fi
if [ $# -lt 3 ]; then
    [ -e build/gallery/tree ] || git worktree add --detach build/gallery/tree "$before_commit" >/dev/null
    build build/gallery/tree build/gallery/before
    set -- "$images" "$2" build/gallery/before/apps/pupil
fi
/usr/bin/python3 docs/gallery/gallery.py "$2" "$3" "$images" build/gallery
cp build/gallery/gallery-*.jpg docs
echo "docs/gallery-low-key.jpg, docs/gallery-ordinary.jpg; tables: build/gallery/tables.md"
