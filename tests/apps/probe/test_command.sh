#!/bin/sh
# pupil probe as a user sees it, on a camera in the process: what is printed, what is refused, and that the camera's
# controls are restored, also on Ctrl-C. Needs $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera

# probe STATUS WORDS ARGUMENTS...: the exit status, words in standard output or error, and the controls as before
probe() {
    status=$1 words=$2
    shift 2
    call "$status" "" "$@"
    grep -qF -- "$words" said.out said.err || fail "$*: no '$words' in: $(cat said.out said.err)"
    case $* in
    *absent* | *no-controls* | *unplug*) ;;
    *) grep -qxF "$fake_restored" said.err || fail "$*: controls: $(cat said.err)" ;;
    esac
}

quiet() { # nothing but the camera's own word on standard error, and something printed
    [ -z "$(grep -v '^fake: auto' said.err)" ] || fail "says: $(cat said.err)"
    [ -s said.out ] || fail "nothing is printed"
}
refused() { # one sentence, and nothing printed
    probe "$@"
    [ "$(sentences)" = 1 ] || fail "not one sentence: $(cat said.err)"
    [ ! -s said.out ] || fail "printed: $(cat said.out)"
}

probe 0 "delay of exposure 4 frames after" fake:flat=500 fake:delay=4 probe -d 0
quiet
probe 0 "delay of gain 2 frames after" fake:flat=500 fake:delay=4 fake:gain-earlier=2 probe --quick -q
quiet
probe 0 '"slope":' fake:flat=500 probe --json --quick -d "Fake Camera"
quiet
probe 0 "memory     dma-heap /dev/dma_heap/system" fake:flat=500 fake:slow=1,0,1 probe --quick
probe 0 "exposure   cannot be set: /dev/video0: this camera has neither" fake:no-controls probe
quiet
probe 0 "usage: pupil probe" probe --help

refused 1 "pupil probe: no camera is there" fake:absent probe
refused 1 "pupil probe: /dev/video9: " probe -d /dev/video9
refused 1 "the camera was unplugged" fake:unplug=50 probe
refused 2 "pupil probe: --fast: no such option" probe --fast
refused 2 "pupil probe: -d: its value is missing" probe -d
refused 2 "pupil probe: 0: it takes no argument" probe 0
"$program" fake:flat=500 probe --quick >/dev/full 2>said.err
[ $? = 1 ] || fail "a full disk: exit status"
grep -qF "standard output cannot be written" said.err || fail "a full disk: $(cat said.err)"

# Ctrl-C, early and in the middle of a step: nothing printed, everything restored
for signal in INT TERM HUP; do
    for after in 0.3 1.2; do
        "$program" fake:real fake:flat=500 probe >said.out 2>said.err &
        running=$!
        until_true "$signal: nothing handles it" handles_signals
        sleep "$after"
        kill -s "$signal" "$running"
        ends 130
        grep -qxF "pupil probe: stopped; the camera's controls are as they were" said.err || fail "$(cat said.err)"
        grep -qxF "$fake_restored" said.err || fail "$signal: $(cat said.err)"
        [ ! -s said.out ] || fail "$signal: printed: $(cat said.out)"
    done
done
# A crash of the program, in the middle
{
    "$program" fake:flat=500 fake:crash=80 probe >said.out 2>said.err
    got=$?
} 2>/dev/null # the shell's own words, which look like a crash that nobody asked for
[ $got = 139 ] || fail "crash: exit status $got"
for value in "9a0901 = 3" "9a0902 = 77" "980913 = 40"; do # EXPOSURE_AUTO, EXPOSURE_ABSOLUTE, GAIN
    grep -qxF "fake: after the crash $value" said.err || fail "crash: $(cat said.err)"
done

end_test
