#!/bin/sh
# branches.sh BUILD: builds the library and its tests for coverage in BUILD, runs the quick tests of the rooms below, and
# fails unless each way of each branch of these rooms ran, except those of branches.txt.
set -eu
build=$1
mkdir -p "$build"
rooms="lib/base lib/core lib/flicker lib/look lib/sensor"
tests='^((core|look|flicker|sensor|stream)[.]|veil[.]frames$|row_gain[.]map$)'
cmake --preset coverage -B "$build" -DPUPIL_PROGRAM=OFF -DPUPIL_GPU=OFF -DPUPIL_MEDIA=OFF -DPUPIL_PYTHON=OFF \
    -DCMAKE_C_FLAGS="-O0 --coverage -fprofile-update=atomic" >"$build.log" 2>&1 || { cat "$build.log"; exit 1; }
cmake --build "$build" -j "$(nproc)" >>"$build.log" 2>&1 || { tail -40 "$build.log"; exit 1; }
find "$build" -name '*.gcda' -exec rm -f {} +
ctest --test-dir "$build" -L '^quick$' -R "$tests" -j "$(nproc)" >>"$build.log" 2>&1 || { tail -40 "$build.log"; exit 1; }
# shellcheck disable=SC2086 # a list
exec python3 cmake/branches.py --unreached tests/tree/branches.txt "$build" $rooms
