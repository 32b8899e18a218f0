#!/bin/sh
# test_examples.sh PROGRAMS: the examples in C++ on a still and a video that OpenCV wrote. They are short.
set -eu
programs=$1
source=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "test_examples.sh: $*"; exit 1; }

"$programs/make_inputs" "$work"
"$programs/opencv_still" "$work/in.hdr" "$work/out.png"
"$programs/opencv_video" "$work/in.avi" "$work/out.avi" >"$work/said" 2>"$work/notes"
# sRGB 120 is 0.1878 of light, -2.41 EV
grep -qE '^50 frames, the last one adapted to -2.[3-6]' "$work/said" || fail "$(cat "$work/said")"
grep -q 'pupil::pupil_camera' "$work/notes" || fail "$(cat "$work/notes")"
"$programs/make_inputs" "$work" check
for program in opencv_still opencv_video; do
    "$programs/$program" "$work/none" "$work/out" 2>"$work/notes" && fail "$program reads a file that is not there"
    "$programs/$program" 2>"$work/notes" && fail "$program takes no arguments"
    grep -q "^usage: $program INPUT" "$work/notes" || fail "$program: $(cat "$work/notes")"
done

for name in opencv_still opencv_video; do
    file=$source/docs/examples/$name.cpp
    [ "$(wc -l <"$file")" -le 40 ] || fail "$name.cpp is longer than 40 lines"
done
echo ok
