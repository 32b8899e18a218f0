#!/bin/sh
# uvc_guest.sh TEST CAMERA NODE PUPIL [plots]: in the guest of vm.uvc. A USB port that has its far end in user space;
# uvc.c, and then the program as its user meets it. With a last word its plots are printed, packed.
set -u
camera=$2 node=$3 pupil=$4 plots=${5:-}
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
    tail -n 1 run.jsonl | sed -n "s/.*\"$1\": *\"*\([^,\"}]*\).*/\1/p"
}

# until_converged N: so many frames have come, and the level of the last is right; a busy machine takes more of them
until_converged() {
    for _ in $(seq 200); do
        [ "$(wc -l <run.jsonl)" -lt "$1" ] || [ "$(last sensor)" != converged ] || return 0
        sleep 0.3
    done
}

# Light that is taken for a display's codes (linear) is a tone curve to pupil. It is regulated all the same; its brightest
# parts, which would clip, may cost a stop of exposure (highlight_ev), which is up to 2.4 of that picture: 0.034. Eight
# times the light for a while in between; 5 frames a second, so that a busy machine loses few.
for answers in display linear; do
    "$camera" $answers &
    plugged=$!
    for _ in $(seq 200); do
        path=$("$node" find uvcvideo capture 0) && break
        sleep 0.1
    done
    "$node" set "$path" "Auto Exposure" 3
    "$node" set "$path" Gain 40
    : >run.jsonl
    # shellcheck disable=SC2086 # words
    "$pupil" run -d "$path" --width 320 --height 240 --framerate 5 --mode sensor -t 200 -q --stats - \
        ${plots:+--plot run.svg} >run.jsonl &
    runner=$!
    until_converged 20
    "$node" light $plugged 9
    until_converged 45
    "$node" light $plugged 8
    until_converged 70
    kill -TERM $runner
    wait $runner || fail "$answers: pupil run: exit $?"
    [ -z "$plots" ] || { echo "plot uvc-$answers.svg"; gzip -9 <run.svg | base64; echo "end of plot"; }
    [ -z "$plots" ] || { echo "plot uvc-$answers.jsonl"; gzip -9 <run.jsonl | base64; echo "end of plot"; }
    [ "$(last sensor)" = converged ] || fail "$answers: the sensor is $(last sensor)"
    least=0.155
    [ $answers = display ] || least=0.034
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
