#!/bin/sh
# update_digests.sh: writes tests/stream/digests.txt anew from an unoptimised build, and prints what changed. To be run
# only by someone who meant to change the bits, and can say why in the commit.
set -eu
cd "$(dirname "$0")/../.."
build=build/digest
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=None -DCMAKE_C_FLAGS=-O0 -DPUPIL_PROGRAM=OFF -DPUPIL_TESTS=ON >/dev/null
cmake --build "$build" --target digest >/dev/null
"$build/tests/stream/digest" >"$build/digests.txt"
[ -e tests/stream/digests.txt ] || : >tests/stream/digests.txt
diff tests/stream/digests.txt "$build/digests.txt" || :
cp "$build/digests.txt" tests/stream/digests.txt
