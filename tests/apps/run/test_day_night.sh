#!/bin/sh
# pupil run --day-night, on a camera in the process: a change if it is dark or light for long enough; none if only for a
# moment, or between the two. Needs $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera

# changes FILE.csv: each value of day_night and for how many frames it holds
changes() {
    awk -F, '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == "day_night") n = i; next }
        $n != was { if (count) printf "%s %d ", was, count; was = $n; count = 0 } { count++ } END { print was, count }' "$1"
}

# The light of the scene is 3.9 EV (0.1465 / 10 ms) at first: night is below 0.19 of it, day above 0.55. Dusk, with a
# moment of darkness before it and a moment of light in it, then dawn.
lights=
for light in 0.02@120 1@140 0.5@180 0.35@220 0.25@260 0.18@300 0.125@340 1@400 0.09@420 0.06@460 0.125@500 0.25@540 0.35@580 \
    0.5@620 0.7@660 1@700; do
    lights="$lights fake:light=$light"
done
for mode in sensor both; do
    # shellcheck disable=SC2086 # words
    call 0 "night from frame" fake:flat=600 $lights --mode $mode --day-night 1.5,3,1 -n 850 --stats $mode.csv
    [ "$(grep -c "^night from frame\|^day from frame" said.err)" = 3 ] || fail "$mode: $(cat said.err)"
    changes $mode.csv | awk '{ exit !(NF == 8 && $1 == "unknown" && $3 == "day" && $5 == "night" && $7 == "day") }' ||
        fail "$mode: $(changes $mode.csv)"
done
call 0 "" fake:flat=600 --mode sensor -n 5 --stats without.csv -q
[ "$(changes without.csv)" = " 5" ] || fail "without: $(changes without.csv)"
for wrong in 1 1,2 1,2,0 2,1,5 -65,1,5 1,2,x 1,2,3,4 nan,1,5; do
    call 2 "--day-night $wrong: must be two EV of scene light from -64 to 64" --day-night=$wrong
done
call 2 "--day-night: needs --mode sensor or both" --day-night 1,2,3 --mode digital
call 1 "--day-night: " fake:no-controls --day-night 1,2,3 -n 1

end_test
