#!/bin/sh
# uvc_guest.sh TEST CAMERA NODE PUPIL: in the guest of vm.uvc. A USB port that has its far end in user space; uvc.c, and
# then the program as its user meets it.
set -u
camera=$2 node=$3 pupil=$4
cd "$TMPDIR" || exit 1
modprobe -d "$MODULES" vhci-hcd
modprobe -d "$MODULES" uvcvideo
failures=0
"$1" "$camera" || failures=1

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# last NAME: the value in the last record
last() {
    awk -F, -v name="$1" '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) n = i } { v = $n } END { print v }' run.csv
}

# Light that is taken for a display's codes (linear) is a tone curve to pupil. It is regulated all the same; its brightest
# parts, which would clip, may cost a stop (highlight_ev).
for answers in display linear; do
    "$camera" $answers &
    plugged=$!
    for _ in $(seq 200); do
        path=$("$node" find uvcvideo capture 0) && break
        sleep 0.1
    done
    "$node" set "$path" "Auto Exposure" 3
    "$node" set "$path" Gain 40
    timeout 90 "$pupil" run -d "$path" --width 320 --height 240 --framerate 15 --mode sensor -n 60 -q --stats run.csv ||
        fail "$answers: pupil run: exit $?"
    [ "$(last sensor)" = converged ] || fail "$answers: the sensor is $(last sensor)"
    least=0.155
    [ $answers = display ] || least=0.08
    awk -v level="$(last output_level)" -v least=$least 'BEGIN { exit !(level > least && level < 0.21) }' ||
        fail "$answers: shown at $(last output_level), not at 0.18"
    [ "$("$node" get "$path" "Auto Exposure"; "$node" get "$path" Gain)" = "3
40" ] || fail "$answers: the controls are not put back"
    if [ $answers = display ]; then
        timeout 120 "$pupil" probe -d "$path" --quick -q >probe.txt || fail "pupil probe: exit $?"
        cat probe.txt
        [ "$("$node" get "$path" Gain)" = 40 ] || fail "pupil probe does not put the gain back"
    fi
    echo "pupil run, $answers: exposure $(last exposure_s) s, gain $(last gain), shown at $(last output_level)"
    kill -TERM $plugged
    wait $plugged
done
echo "$failures failures"
[ "$failures" = 0 ]
