#!/bin/sh
# A sequence of the room costs its renders and its sums, and a sum is at the speed of memory. Of three tries one must
# do: times of a machine that has other things to do.
set -eu
program=${PUPIL_PROGRAM:?}
said=$(mktemp)
trap 'rm -f "$said"' EXIT

# number NAME: of the object in $said, the last of that name ("cold" is after "warm")
number() { sed "s/.*\"$1\":\([0-9.]*\).*/\1/" "$said"; }

for try in 1 2 3; do
    "$program" bench scene room --json >"$said"
    frames=$(number frames_s) sums=$(number sums_s) ratio=$(number ratio_memcpy_per_byte)
    echo "frames $frames s, their sums alone $sums s; a sum over a memcpy, by the byte, from memory: $ratio"
    # 1.1: the levels of each frame and the clock; 1.2: more streams than a copy has
    if awk "BEGIN { exit !($frames <= 1.1 * $sums && $ratio <= 1.2) }"; then
        exit 0
    fi
done
echo "FAILED: frames above 1.1 sums, or a sum above 1.2 of a memcpy by the byte"
exit 1
