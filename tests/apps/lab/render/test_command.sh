#!/bin/sh
# pupil render: linear and display outputs, ranges, what is refused, and that a range is part of the whole.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
cat >small.scene <<'SCENE'
size width_px 32 height_px 24
frames 6
material grey diffuse 0.5 0.5 0.5
plane material grey position_m 0 0 0 normal 0 1 0
sphere material grey position_m 0 0.5 0 radius_m 0.5
lamp a sphere position_m 1 2 1 radius_m 0.2 intensity 2
level a at_frame 3 value 4
camera position_m 0 1 3 look_at_m 0 0.5 0 fov_degrees 50
SCENE

expect 0 "rendered 1 frame in" render small.scene -o a.exr -o a.hdr -o a.pfm -o a.png
for kind in exr pfm; do
    "$program" replay a.$kind -q -y -o b.png
    cmp a.png b.png || fail "$kind is not what was rendered"
done
"$program" render small.scene -q -o all
"$program" render small.scene -q -n 2..4 -o part --threads 3
[ "$(ls all | wc -l) $(ls part | wc -l)" = "6 3" ] || fail "$(ls all part)"
for n in 2 3 4; do cmp all/frame_00000$n.exr part/frame_00000$n.exr || fail "frame $n of a range"; done
cmp -s all/frame_000000.exr all/frame_000002.exr || fail "nothing changes between frames 0 and 2"
cmp -s all/frame_000002.exr all/frame_000003.exr && fail "the lamp's level does nothing"
"$program" render small.scene -q -o a.y4m
"$program" replay synth:small.scene -q --dither off -o b.y4m # render has none
cmp a.y4m b.y4m || fail "render maps other than replay"
"$program" render walk -q -n 2 --size 16x9 -o walk.y4m

"$program" render --help >help.txt
[ "$(wc -l <help.txt)" -le 24 ] || fail "--help is $(wc -l <help.txt) lines"
expect 2 "no scene" render -o a.exr
expect 2 "no output" render room
expect 2 "--frames 4..2" render small.scene -n 4..2 -o x.exr
expect 2 "--size 0x9" render small.scene --size 0x9 -o x.exr
expect 2 "--threads 300" render small.scene --threads 300 -o x.exr
expect 2 "--fps 0" render small.scene --fps 0 -o x.exr
expect 2 "--shiny" render small.scene --shiny -o x.exr
expect 2 "named once" render small.scene -o x.exr -o x.exr
expect 1 "synth:room" render no-such -o x.exr
expect 1 "not empty" render small.scene -o all
expect 1 "one picture" render small.scene -n 3 -o x.exr
expect 1 "no kind of output" render small.scene -o x.bmp
echo "camera position_m 0 1" >bad.scene
expect 1 "bad.scene:1: " render bad.scene -o x.exr
echo "material m diffuse 0 0 0
mesh nothing.obj material m position_m 0 0 0
camera position_m 0 1 3 look_at_m 0 0 0 fov_degrees 50" >bad.scene
expect 1 "nothing.obj" render bad.scene -o x.exr
[ ! -e x.exr ] || fail "an output of a failed run"
! ls -a | grep -q '\.part$' || fail "leftovers: $(ls -a)"
end_test
