#!/bin/sh
# pupil bench deferred: what it prints, and what is refused.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
cat >small.scene <<'SCENE'
samples antialias 1
material grey diffuse 0.5 0.5 0.5
plane material grey position_m 0 0 0 normal 0 1 0
lamp a point position_m 1 2 1 intensity 2 unshadowed
lamp b point position_m -1 2 1 intensity 2 level 0.5
camera position_m 0 1 3 look_at_m 0 0.5 0 fov_degrees 50
SCENE
"$program" bench deferred small.scene --size 32x24 >table.txt
grep -q "the same to the bit" table.txt || fail "no comparison: $(cat table.txt)"
[ "$(grep -c '^ *[0-9]* *[0-9.]* *[0-9.]* *[0-9.]* *[0-9.]* *[0-9.]* *[0-9.]*$' table.txt)" = 3 ] ||
    fail "no three rows of figures: $(cat table.txt)"
grep -q 'nan\|inf' table.txt && fail "a number that is none: $(cat table.txt)"
sed 's/antialias 1/antialias 2/' small.scene >fine.scene
expect 1 "other bits than the frame" bench deferred fine.scene --size 32x24
{ cat small.scene; echo "camera position_m 0 1 4 look_at_m 0 0 0 fov_degrees 50 at_frame 9"; } >moves.scene
expect 1 "its camera moves" bench deferred moves.scene
grep -v '^lamp' small.scene >dark.scene
expect 1 "no lamp" bench deferred dark.scene
expect 1 "radiosity" bench deferred room-radiosity --size 8x8
expect 1 "no-such" bench deferred no-such
expect 2 "more than one scene" bench deferred room room
expect 2 "--threads 0" bench deferred --threads 0
end_test
