#!/bin/sh
# test_meter_only.sh: docs/examples/meter_only.c on frames with known light, and the examples' messages for wrong
# arguments and input. $PUPIL_EXAMPLES is the folder that they were built into.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
meter=$PUPIL_EXAMPLES/meter_only

fail() { echo "test_meter_only.sh: $*"; exit 1; }

# 4 x 2 pixels of Y' = 235 and of Y' = 126: limited range, so 1 and 0.50228, which is 0.2158 of light (IEC 61966-2-1): 0
# and -2.21 EV. Half a frame at the end is ignored.
for i in 1 2 3 4; do printf '\353\200\353\200'; done >"$work/white"
for i in 1 2 3 4; do printf '\176\200\176\200'; done >"$work/grey"
{ cat "$work/white" "$work/grey" "$work/grey"; head -c 7 "$work/grey"; } | "$meter" 4 2 >"$work/out"
[ "$(wc -l <"$work/out")" = 3 ] || fail "3 frames gave $(wc -l <"$work/out") lines"
sed -n 1p "$work/out" | grep -q 'metered [+-]0.00 EV, adapted [+-]0.00 EV, clipped 100.0 %' || fail "white: $(head -n 1 "$work/out")"
sed -n 2p "$work/out" | grep -q 'metered -2.21 EV, adapted -0.0[0-9] EV, clipped 0.0 %' || fail "grey: $(sed -n 2p "$work/out")"

for arguments in "" "4" "0 4" "4 99999" "four 4"; do
    # unquoted on purpose
    "$meter" $arguments </dev/null >"$work/out" 2>"$work/err" && fail "'$arguments' is taken"
    grep -q '^usage: meter_only WIDTH HEIGHT' "$work/err" || fail "'$arguments': $(cat "$work/err")"
done

full=$PUPIL_EXAMPLES/full
if [ -x "$full" ]; then
    "$full" "$work/none" 2>"$work/err" && fail "full takes a device that is not there"
    grep -qF "full: $work/none: No such file or directory" "$work/err" || fail "no device: $(cat "$work/err")"
    "$full" "$work/err" 2>"$work/err2" && fail "full takes a file that is no device"
    grep -q "^full: VIDIOC_G_FMT: " "$work/err2" || fail "no camera: $(cat "$work/err2")"
fi
echo "ok"
