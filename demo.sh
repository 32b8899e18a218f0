#!/bin/sh
# demo.sh: on a bare Debian 12, installs what is missing, builds pupil, renders the room and replays it. What it leaves:
# report/index.html, to be opened in a browser, and out/room.mp4.
set -eu
cd "$(dirname "$0")"
. cmake/packages.sh

install_missing "$packages_of_the_program"

echo "== building into build/release"
mkdir -p build
{ cmake --preset release && cmake --build --preset release; } >build/demo.log 2>&1 </dev/null || {
    tail -n 40 build/demo.log >&2
    echo "$0: the build failed; all of its output is in build/demo.log" >&2
    exit 1
}

echo "== pupil replay synth:room-radiosity -o out/room.mp4 --report report --overwrite"
mkdir -p out
build/release/apps/pupil replay synth:room-radiosity -o out/room.mp4 --report report --overwrite </dev/null

echo "== done: open report/index.html in a browser; the video alone is out/room.mp4"
