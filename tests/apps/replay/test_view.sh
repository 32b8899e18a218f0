#!/bin/sh
# pupil replay --view in a virtual screen: the window opens, each key has its effect on the pixels, on the CPU's and the
# GPU's path; closing, Ctrl-C, no display.
set -u
. "$(dirname "$0")/../screen.sh"
. "$(dirname "$0")/../../lib.sh"
use_pupil

# no display: a sentence, and nothing is left
on_no_screen replay synth:walk --size 64x36 -n 2
begin_screen

# start ARGUMENTS...: a window; its number in $window
start() {
    "$program" replay "$@" --view 2>said.err &
    running=$!
    window=
    tries=0
    while [ -z "$window" ] && kill -0 $running 2>/dev/null && [ $tries -lt 300 ]; do
        sleep 0.1
        window=$(xdotool search --name pupil 2>/dev/null | head -n 1)
        tries=$((tries + 1))
    done
    [ -n "$window" ] || fail "no window: $(cat said.err)"
}
# pixels COLOUR: how many are in the window
pixels() {
    convert look.png -crop 480x270+80+105 +repage -fill black +opaque "$1" -fill white -opaque "$1" -colorspace gray \
        -format '%[fx:int(mean*w*h+0.5)]' info:
}
# The title can be read without a screenshot.
titled() {
    xdotool getwindowname "$window" | grep -qF -- "$1"
}
until_titled() { until_true "not in the title: $1" titled "$1"; }
# The window's corner stays where it was.
has_bars() { look && [ "$(mean 440x20+100+115)" = 0 ] && [ "$(mean 440x60+100+200)" -gt 1000 ]; }
brighter_than() { look && [ "$(mean 440x60+100+125)" -gt "$1" ]; }
darker_than() { look && [ "$(mean 440x60+100+125)" -lt "$1" ]; }
has() { look && [ "$(pixels "$1")" -gt "$2" ]; }
has_no() { look && [ "$(pixels "$1")" -lt "$2" ]; }
# the left half is unchanged, the right one much brighter
is_split() { look && [ "$(mean 140x60+340+125)" -gt $(($(mean 140x60+150+125) * 5 / 4)) ]; }
is_even() { look && [ "$(mean 140x60+340+125)" -lt $(($(mean 140x60+150+125) * 21 / 20)) ]; }

# A picture of one brightness, so that halves can be compared, and bright enough to show stops.
printf 'PF\n480 270\n-1.0\n' >grey.pfm
head -c 1555200 /dev/zero | sed 's/\x00\x00\x00\x00/\x00\x00\x80\x3e/g' >>grey.pfm

# Darker by 3 stops in its lower half, so that there is an edge of 480 pixels in two rows.
printf 'PF\n480 270\n-1.0\n' >step.pfm
head -c 777600 /dev/zero | sed 's/\x00\x00\x00\x00/\x00\x00\x00\x3e/g' >>step.pfm
head -c 777600 /dev/zero | sed 's/\x00\x00\x00\x00/\x00\x00\x80\x3f/g' >>step.pfm

# check_picture ARGUMENTS...: what the keys do to the picture
check_picture() {
    start grey.pfm --loop --fps 20 "$@"
    [ -n "$window" ] || return
    until_true "no picture" brighter_than 1000
    before=$(mean 440x60+100+125)
    xdotool key plus plus plus
    until_true "+ is not brighter than $before" brighter_than $((before * 5 / 4))
    until_titled "EV +1.00"
    until_true "the picture is not even" is_even
    xdotool key s
    until_true "s does not split" is_split
    until_true "no line where the split is" has '#F0F0F0' 200
    xdotool key Left Left Left Left Left Left Left Left Left
    until_true "left does not move the split" is_even
    xdotool key s minus minus Down
    until_true "- is not as dark as before ($before)" darker_than $((before * 21 / 20))
    xdotool key space plus plus plus
    until_true "a paused picture has no keys" brighter_than $((before * 5 / 4))
    xdotool key q
    ends 0
}

# check_rest ARGUMENTS...: overlays, and the title
check_rest() {
    start step.pfm --loop --fps 20 "$@"
    [ -n "$window" ] || return
    until_true "no picture" brighter_than 1000
    xdotool key p
    for colour in '#D55E00' '#009E73' '#0072B2'; do
        until_true "p shows nothing of $colour" has "$colour" 20
    done
    xdotool key p
    until_true "p does not go" has_no '#D55E00' 1
    xdotool key h
    until_true "h has no words" has '#F0F0F0' 1000
    xdotool key h
    until_true "h does not go" has_no '#F0F0F0' 1
    until_true "edges of themselves" has_no '#FF0080' 1
    xdotool key e
    until_true "e marks no edges" has '#FF0080' 200
    xdotool key e
    until_true "e does not go" has_no '#FF0080' 1
    for formula in 1 2 3 4; do
        xdotool key $formula
        until_titled "formula $formula"
    done
    xdotool key bracketright
    until_titled "weight 0.035"
    xdotool key 0 bracketleft
    until_titled "tau 0.21 and 0.64"
    xdotool key l
    until_titled "locked"
    xdotool key l
    xdotool windowsize "$window" 480 400 # with bars of 65 above and below
    until_true "a larger window has no bars" has_bars
    xdotool key f F11 Escape # full screen, and back
    ends 0
}

check_picture
grep -q "by the CPU\|GPU: " said.err || fail "who did the frames is not told: $(cat said.err)"
check_picture --gles
grep -q "GPU: \|the CPU continues" said.err || fail "who did the frames is not told: $(cat said.err)"
check_rest --gles-version 3.0 --white none

# the window's close button, Escape, Ctrl-C; at the end of the input the window stays, unless something is written
start step.pfm -q
sleep 1
kill -0 $running 2>/dev/null || fail "a still does not stay"
xdotool key e
until_true "e marks no edges of a still" has '#FF0080' 200
xdotool key Escape
ends 0
start grey.pfm --loop -q
kill -INT $running
ends 130

# outputs are the same with a window as without, and closing it keeps the frames shown so far
"$program" replay synth:walk --size 64x36 -n 20 -q -o without.y4m
start synth:walk --size 64x36 -n 20 -q -o with.y4m
ends 0
cmp -s without.y4m with.y4m || fail "--view changes the picture that is written"
start synth:walk --size 64x36 -q -o part.y4m
sleep 1
xdotool key q
ends 0
[ -s part.y4m ] || fail "closing the window loses the output"

end_test
