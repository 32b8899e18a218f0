#!/bin/sh
# CMake options of packagers: impossible ones are refused by name, and unity builds are disabled.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# refuses WORDS ARGUMENTS...: configuring fails, with these words in the message
refuses() {
    words=$1
    shift
    cmake --preset minimal -B "$work/refused" "$@" >"$work/log" 2>&1 && { echo "FAILED: cmake takes $*"; exit 1; }
    tr -s '\n ' ' ' <"$work/log" | grep -qF "$words" || { echo "FAILED: cmake $*: $(cat "$work/log")"; exit 1; }
    rm -rf "$work/refused"
}
refuses "PUPIL_SHARED and PUPIL_STATIC are both OFF" -DPUPIL_SHARED=OFF -DPUPIL_STATIC=OFF
refuses 'PUPIL_LEVELS: "sse"' -DPUPIL_LEVELS=sse

cmake --preset minimal -B "$work/packager" -DCMAKE_UNITY_BUILD=ON >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
! grep -qi unity "$work/packager/build.ninja" || { echo "FAILED: a unity build"; exit 1; }
