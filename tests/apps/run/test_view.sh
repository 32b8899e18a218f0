#!/bin/sh
# pupil run --view in a virtual screen, on a camera in the process: the live picture, keys that act on the camera, a
# pause that only stops the picture, and an end that gives the camera back. Needs $PUPIL_RUN_FAKE.
set -u
. "$(dirname "$0")/../screen.sh"
. "$(dirname "$0")/../../lib.sh"
use_fake_camera

on_no_screen -n 2
grep -qxF "$fake_restored" said.err || fail "no display: the camera is not given back: $(cat said.err)"
begin_screen

lines() { wc -l <live.jsonl; }
has_window() { xdotool search --name pupil >window 2>/dev/null; }
brightness() { look && mean 280x100+180+140; }
brighter_than() { [ "$(brightness)" -gt "$1" ]; }
more_than() { [ "$(lines)" -gt "$1" ]; }

for mode in sensor both; do
    # a picture that is the same in every frame: a scene of one value
    "$program" fake:real fake:size=320x240 fake:flat=600 --mode $mode --view --stats - >live.jsonl 2>said.err &
    running=$!
    until_true "$mode: no window" has_window || break
    until_true "$mode: no picture" brighter_than 10000
    before=$(brightness)
    xdotool key plus plus plus
    until_true "$mode: + is not brighter than $before" brighter_than $((before * 11 / 10))
    xdotool key space
    at=$(lines)
    until_true "$mode: a pause stops the run" more_than $((at + 10))
    xdotool key space q
    ends 0
    grep -qxF "$fake_restored" said.err || fail "$mode: the camera is not given back: $(cat said.err)"
done

# row correction gains are computed by the CPU; the window shows its result
"$program" fake:size=320x240 fake:format=Y12 fake:flat=600 fake:light=4@1 fake:lamps=100,0.3,0.025 --shutter 1ms --row-gains \
    --readout 25 --view -n 90 2>said.err || fail "row gains: exit $?: $(cat said.err)"
grep -Eq "; by the CPU; row correction gains in [3-9][0-9] of 90 frames$" said.err || fail "row gains: $(cat said.err)"

end_test
