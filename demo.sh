#!/bin/sh
# demo.sh: on a bare Debian 12 or 13, installs what is missing, builds pupil, renders the room and replays it. It leaves
# report/index.html and out/pupil.html, to be opened in a browser, and out/room.mp4.
set -eu
cd "$(dirname "$0")"
. cmake/packages.sh

install_missing "$packages_of_the_program
$packages_of_the_page"

echo "== building into build/release, and the page into build/wasm: some minutes; the output goes to build/demo.log"
{
    cmake --preset release && cmake --build --preset release &&
        cmake --preset wasm && cmake --build --preset wasm
} >build/demo.log 2>&1 </dev/null || {
    tail -n 40 build/demo.log >&2
    echo "$0: the build failed; all of its output is in build/demo.log" >&2
    exit 1
}

echo "== pupil replay synth:room-radiosity -o out/room.mp4 --report report --overwrite"
mkdir -p out
build/release/apps/pupil replay synth:room-radiosity -o out/room.mp4 --report report --overwrite </dev/null

cp build/wasm/apps/web/pupil.html out/pupil.html

echo "== done: open report/index.html in a browser; the video alone is out/room.mp4"
echo "== and out/pupil.html: the same in the browser itself, with its camera or your HDR files"
echo "== the program is build/release/apps/pupil; to install it: cmake --install build/release, as root"
