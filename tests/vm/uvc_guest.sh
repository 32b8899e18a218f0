#!/bin/sh
# uvc_guest.sh TEST CAMERA NODE FULL PUPIL [plots]: in the guest of vm.uvc. A USB port that has its far end in user
# space; uvc.c, then the program as a user sees it, then docs/examples/full.c. With the last word the program's plots
# are printed, packed.
set -u
camera=$2 node=$3 full=$4 pupil=$5 plots=${6:-}
. "$(dirname "$0")/uvc_plug.sh"
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

# until_converged N: so many frames have come, and the level of the last is right; on a busy machine it takes more
until_converged() {
    for _ in $(seq 200); do
        [ "$(wc -l <run.jsonl)" -lt "$1" ] || [ "$(last sensor)" != converged ] || return 0
        sleep 0.3
    done
}

lost() { sed -n 's/.*"lost": *\([0-9]*\).*/\1/p' run.jsonl | awk '{ n += $1 } END { print n + 0 }'; }
# one program for all commands: on the emulated processor to start one takes as long as some frames
tell() { echo "$*" >&3; }
# more N: so many more frames have come
more() {
    aim=$(($(wc -l <run.jsonl) + $1))
    for _ in $(seq 300); do
        [ "$(wc -l <run.jsonl)" -lt $aim ] || return 0
        sleep 0.2
    done
    fail "no $1 frames in a minute"
}
# settings N: the number of different settings of the last N frames
settings() { tail -n "$1" run.jsonl | sed 's/.*"exposure_s": *\([^,]*\),"gain": *\([^,]*\),.*/\1 \2/' | sort -u | wc -l; }

# The run is changed through its socket while frames come: a lock holds through a step of light; a limit, compensation
# and a region take effect. Lost frames are printed: a busy emulated processor loses some anyway, apps.run.control loses
# none.
change_it() {
    mkfifo orders
    "$pupil" ctl run.sock <orders >ctl.out 2>&1 &
    asks=$!
    exec 3>orders
    tell status
    more 12
    before=$(lost)
    tell lock on
    more 8
    "$node" light $plugged 9
    more 12
    [ "$(settings 12)" = 1 ] || fail "the lock does not hold: $(settings 12) settings"
    tell lock off
    more 15
    tell shutter-max 5ms
    more 15
    awk -v s="$(last exposure_s)" 'BEGIN { exit !(s <= 0.00501) }' || fail "shutter-max: $(last exposure_s) s"
    tell shutter-max off
    tell roi 0.4,0.4,0.2,0.2
    tell ev -1
    more 15
    tell roi off
    tell ev 0
    "$node" light $plugged 8
    until_converged $(($(wc -l <run.jsonl) + 25))
    echo "pupil ctl: $(wc -l <ctl.out) answers; frames lost: $before before, $(lost) after; exposure $(last exposure_s) s"
    exec 3>&-
    wait $asks || fail "ctl: $(cat ctl.out)"
    [ "$(grep -c '^{"ok":true' ctl.out)" = 9 ] || fail "ctl: $(cat ctl.out)"
}

# Linear light that is taken for a display's codes is a tone curve to pupil. The loop still works; the brightest parts,
# which would clip, may cost a stop of exposure (highlight_ev), which is up to 2.4 stops of that picture: 0.034. In
# between eight times the light for a while; 5 frames a second, so that a busy machine loses few.
for answers in display linear; do
    plug $answers
    : >run.jsonl
    # shellcheck disable=SC2086 # words
    "$pupil" run -d "$path" --width 320 --height 240 --framerate 5 --mode sensor -t 200 -q --stats - --control run.sock \
        ${plots:+--plot run.svg} >run.jsonl &
    runner=$!
    until_converged 20
    "$node" light $plugged 9
    until_converged 45
    "$node" light $plugged 8
    until_converged 70
    [ $answers = linear ] || change_it
    kill -TERM $runner
    wait $runner || fail "$answers: pupil run: exit $?"
    [ -z "$plots" ] || { echo "plot uvc-$answers.svg"; gzip -9 <run.svg | base64; echo "end of plot"; }
    [ -z "$plots" ] || { echo "plot uvc-$answers.jsonl"; gzip -9 <run.jsonl | base64; echo "end of plot"; }
    [ "$(last sensor)" = converged ] || fail "$answers: the sensor is $(last sensor)"
    least=0.155
    [ $answers = display ] || least=0.034
    awk -v level="$(last output_level)" -v least=$least 'BEGIN { exit !(level > least && level < 0.21) }' ||
        fail "$answers: shown at $(last output_level), not at 0.18"
    is_put_back || fail "$answers: the controls are not put back"
    if [ $answers = display ]; then
        timeout 120 "$pupil" probe -d "$path" --quick -q >probe.txt || fail "pupil probe: exit $?"
        cat probe.txt
        [ "$("$node" get "$path" Gain)" = 40 ] || fail "pupil probe does not put the gain back"
    fi
    echo "pupil run, $answers: exposure $(last exposure_s) s, gain $(last gain), shown at $(last output_level)"
    kill -TERM $plugged
    wait $plugged
done

# level LIGHT: log-average of the camera's picture, given its present controls: UVC_LIGHT at 10 ms, gain 1 and light 8
level() {
    awk -v exposure="$("$node" get "$path" "Exposure Time, Absolute")" -v gain="$("$node" get "$path" Gain)" -v light="$1" \
        'BEGIN { print 0.1 * exposure / 100 * gain / 16 * 8 ^ (light - 8) }'
}

# until_right LIGHT: the level is right, and still is four seconds later; within two minutes
until_right() {
    right=0
    for _ in $(seq 120); do
        sleep 1
        if awk -v level="$(level "$1")" 'BEGIN { exit !(level > 0.155 && level < 0.21) }'; then
            right=$((right + 1))
        else
            right=0
        fi
        [ $right -lt 5 ] || return 0
    done
    fail "full: light $1: the camera's picture is at $(level "$1"), not at 0.18"
}

# A program that only uses the library, on a camera whose writes are slower than frames and refused in a third of cases.
plug display hard
mkfifo frames
tail -c 230400 <frames >last.rgb &
reader=$!
"$full" "$path" >frames 2>full.err &
runner=$!
for light in 8 9 7; do
    "$node" light $plugged $light
    until_right $light
    echo "full: light $light: the camera's picture is at $(level $light)"
done
kill -TERM $runner
wait $runner
[ $? = 143 ] || fail "full: $(cat full.err)"
wait $reader
is_put_back || fail "full: the controls are not put back"
# The middle of the last shown picture: 0.18 is sRGB 118.
shown=$(tail -c +$((120 * 960 + 480 + 1)) last.rgb | head -c 3 | od -An -tu1 | awk '{ print $2 }')
[ "${shown:-0}" -gt 90 ] && [ "$shown" -lt 135 ] || fail "full: the middle of its picture is $shown"
kill -TERM $plugged
wait $plugged
echo "$failures failures"
[ "$failures" = 0 ]
