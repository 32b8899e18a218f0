#!/bin/sh
# pupil run --view in a virtual screen, on a camera in the process: the live picture, keys that reach the camera, a pause
# that stops the picture alone, and an end that gives the camera back. Needs $PUPIL_RUN_FAKE.
set -u
program=${PUPIL_RUN_FAKE:-}
[ -n "$program" ] || { echo "skipped: built without cameras"; exit 77; }
for tool in Xvfb xdotool import convert; do
    command -v $tool >/dev/null || { echo "skipped: no $tool (on Debian: xvfb xdotool imagemagick)"; exit 77; }
done
room=$(mktemp -d) || exit 1
server=
running=
cleanup() {
    [ -z "$running" ] || kill "$running" 2>/dev/null
    [ -z "$server" ] || kill "$server" 2>/dev/null
    rm -rf "$room"
}
trap cleanup EXIT
trap 'exit 1' INT TERM
cd "$room" || exit 1
failures=0
export SDL_VIDEODRIVER=x11 SDL_VIDEO_X11_FORCE_EGL=1 XDG_RUNTIME_DIR="$room"

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

env -u DISPLAY -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER "$program" -n 2 --view -o a.y4m 2>said.err
got=$?
grep -qE "PUPIL_(GLES|WINDOW|EGL)" said.err && { echo "skipped: $(cat said.err)"; exit 77; }
[ $got = 1 ] || fail "no display: exit $got"
grep -q "display" said.err || fail "no display: said $(cat said.err)"
grep -qx "fake: auto 3, exposure 77, gain 40" said.err || fail "no display: the camera is not given back: $(cat said.err)"
[ ! -e a.y4m ] || fail "no display, but an output"

Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp -noreset 3>number >xvfb.log 2>&1 &
server=$!
tries=0
while [ ! -s number ] && [ $tries -lt 100 ]; do sleep 0.1; tries=$((tries + 1)); done
[ -s number ] || { echo "skipped: Xvfb does not start: $(cat xvfb.log)"; exit 77; }
DISPLAY=:$(cat number)
export DISPLAY

# until WORDS COMMAND...: the command is true within twenty seconds; a slow machine draws when it can
until_true() {
    words=$1
    shift
    tries=0
    while ! "$@"; do
        tries=$((tries + 1))
        [ $tries -lt 100 ] || { fail "$words: $(cat said.err)"; return 1; }
        sleep 0.2
    done
}
mean() {
    import -window root look.png
    convert look.png -crop 280x100+180+140 +repage -colorspace gray -format '%[fx:int(65535*mean)]' info:
}
lines() { wc -l <live.jsonl; }
has_window() { xdotool search --name pupil >window 2>/dev/null; }
brighter_than() { [ "$(mean)" -gt "$1" ]; }
more_than() { [ "$(lines)" -gt "$1" ]; }
is_gone() { ! kill -0 $running 2>/dev/null; }

for mode in sensor both; do
    # what stays the same from frame to frame: a scene of one value
    "$program" fake:real fake:size=320x240 fake:flat=600 --mode $mode --view --stats - >live.jsonl 2>said.err &
    running=$!
    until_true "$mode: no window" has_window || break
    until_true "$mode: no picture" brighter_than 10000
    before=$(mean)
    xdotool key plus plus plus
    until_true "$mode: + is not brighter than $before" brighter_than $((before * 11 / 10))
    xdotool key space
    at=$(lines)
    until_true "$mode: a pause stops the run" more_than $((at + 10))
    xdotool key space q
    until_true "$mode: q does not end it" is_gone || kill -9 $running
    wait $running
    got=$?
    running=
    [ $got = 0 ] || fail "$mode: exit $got: $(cat said.err)"
    grep -qx "fake: auto 3, exposure 77, gain 40" said.err || fail "$mode: the camera is not given back: $(cat said.err)"
done

# row gains are the CPU's work; the window shows what it made
"$program" fake:size=320x240 fake:format=Y12 fake:flat=600 fake:light=4@1 fake:lamps=100,0.3,0.025 --shutter 1ms --row-gains \
    --readout 25 --view -n 90 2>said.err || fail "row gains: exit $?: $(cat said.err)"
grep -Eq "; by the CPU; row gains in [3-9][0-9] of 90 frames$" said.err || fail "row gains: $(cat said.err)"

[ $failures = 0 ] && echo "run --view: all as expected"
exit $((failures > 0))
