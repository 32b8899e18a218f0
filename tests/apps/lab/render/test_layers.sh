#!/bin/sh
# pupil render --layers: the files' channels, that their light is the frame's, what is refused.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
cat >small.scene <<'SCENE'
size width_px 33 height_px 24
frames 3
material grey diffuse 0.5 0.5 0.5
plane material grey position_m 0 0 0 normal 0 1 0
sphere material grey position_m 0 0.5 0 radius_m 0.5
lamp a sphere position_m 1 2 1 radius_m 0.2 intensity 2
level a at_frame 1 value 4
camera position_m 0 1 3 look_at_m 0 0.5 0 fov_degrees 50
SCENE

# channels FILE: the names in its header
channels() {
    tr '\0' '\n' <"$1" | head -n 400 | grep -a -x 'R\|G\|B\|Z\|N\.[XYZ]\|albedo\.[RGB]\|occlusion\.Y\|ssao\.Y' | sort -u | tr '\n' ' '
}

expect 0 "rendered 1 frame in" render small.scene --layers depth,normal,albedo -o a.exr
[ "$(channels a.exr)" = "$(printf '%s\n' B G R Z N.X N.Y N.Z albedo.B albedo.G albedo.R | sort | tr '\n' ' ')" ] ||
    fail "channels: $(channels a.exr)"
"$program" render small.scene -q --layers ssao -o b.exr
"$program" render small.scene -q --layers occlusion,ssao -o c.exr
[ "$(channels b.exr)" = "$(printf '%s\n' B G R ssao.Y | sort | tr '\n' ' ')" ] || fail "channels: $(channels b.exr)"
# besides header and offsets, one plane of floats per channel
[ $(($(wc -c <c.exr) - $(wc -c <b.exr))) -lt $((33 * 24 * 4 + 64)) ] || fail "sizes: $(wc -c b.exr c.exr)"

# for an EXR reader the light is that of a frame without layers
"$program" render small.scene -q -o light.exr
"$program" replay light.exr -q -o light.png
"$program" replay a.exr -q -o a.png
cmp light.png a.png || fail "the light beside layers is other light"
"$program" render small.scene -q --layers depth -o all
"$program" render small.scene -q --layers depth -n 1..2 --threads 2 -o part
[ "$(ls all | wc -l) $(ls part | wc -l)" = "3 2" ] || fail "$(ls all part)"
for n in 1 2; do cmp all/frame_00000$n.exr part/frame_00000$n.exr || fail "frame $n of a range"; done
cmp -s all/frame_000000.exr all/frame_000001.exr && fail "the lamp's level does nothing"

expect 2 "--layers fog: must be one or more of depth" render small.scene --layers fog -o x.exr
expect 2 "--layers depth,depth" render small.scene --layers depth,depth -o x.exr
expect 2 "--layers depth," render small.scene --layers depth, -o x.exr
expect 1 "a .exr, or a folder" render small.scene --layers depth -o x.pfm
expect 1 "a .exr, or a folder" render small.scene --layers depth -o x.mp4
expect 1 "one output" render small.scene --layers depth -o x.exr -o y.exr
expect 1 "no-such" render no-such --layers depth -o x.exr
expect 1 "not empty" render small.scene --layers depth -o all
[ ! -e x.exr ] || fail "an output of a failed run"
! ls -a | grep -q '\.part$' || fail "leftovers: $(ls -a)"
end_test
