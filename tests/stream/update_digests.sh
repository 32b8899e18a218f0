#!/bin/sh
# update_digests.sh: rewrites tests/stream/digests.txt and tests/scene/digests.txt from an unoptimised build, and prints
# what changed. Only run it if you meant to change the bits, and say why in the commit.
set -eu
cd "$(dirname "$0")/../.."
build=build/digest
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=None -DCMAKE_C_FLAGS=-O0 -DPUPIL_PROGRAM=OFF -DPUPIL_TESTS=ON >/dev/null
cmake --build "$build" --target digests -j2 >/dev/null

# update FOLDER COMMAND...
update() {
    folder=$1
    shift
    "$@" >"$build/digests.txt"
    [ -e "$folder/digests.txt" ] || : >"$folder/digests.txt"
    diff "$folder/digests.txt" "$build/digests.txt" || :
    cp "$build/digests.txt" "$folder/digests.txt"
}
update tests/stream "$build/tests/stream/digest"
update tests/scene "$build/tests/scene/scene_digest" tests/scene
