#!/bin/sh
# pupil bench scene: what it prints, that it reports no more memory than the lights need, what is refused, Ctrl-C.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
cat >small.scene <<'SCENE'
material grey diffuse 0.5 0.5 0.5
plane material grey position_m 0 0 0 normal 0 1 0
lamp a sphere position_m 1 2 1 radius_m 0.2 intensity 2
lamp b point position_m -1 2 1 intensity 2 level 0
camera position_m 0 1 3 look_at_m 0 0.5 0 fov_degrees 50
SCENE
{ cat small.scene; echo "sensor bits 12 shot_noise"; } >sensor.scene

"$program" bench scene small.scene sensor.scene --size 64x32 --frames 5 --threads 1 >table.txt 2>noise.txt
[ ! -s noise.txt ] || fail "on stderr: $(cat noise.txt)"
[ "$(grep -c "^small.scene " table.txt)" = 4 ] || fail "no row of small.scene in each table: $(cat table.txt)"
[ "$(grep -c "^sensor.scene " table.txt)" = 4 ] || fail "no row of sensor.scene in each table: $(cat table.txt)"
grep -q "sensor.scene: .* not sums" table.txt || fail "the cost of the sensor is not told: $(cat table.txt)"

"$program" bench scene small.scene --size 64x32 --frames 5 --json >lines.txt
[ "$(wc -l <lines.txt)" = 1 ] || fail "not an object a line: $(cat lines.txt)"
for words in '"scene":"small.scene"' '"width":64' '"frames":5,' '"lights":2,' '"image_bytes":49152' '"sum_bytes":73728' \
    '"memcpy_bytes":49152' '"render_of_each_s":\[[0-9.]*,[0-9.]*\]' '"warm":{"sum_us":' '"cold":{"sum_us":' '}$'; do
    grep -q -- "$words" lines.txt || fail "no $words in $(cat lines.txt)"
done
grep -q '"render_of_each_s":\[[0.,]*\]' lines.txt && fail "no light takes time to render: $(cat lines.txt)"
grep -q 'nan\|inf' lines.txt && fail "a number that is none: $(cat lines.txt)"

for help in "bench --help" "help bench" "bench scene --help"; do
    "$program" $help >help.txt
    [ "$(wc -l <help.txt)" -le 24 ] || fail "$help is $(wc -l <help.txt) lines"
    grep -q "usage: pupil bench" help.txt || fail "pupil $help says $(cat help.txt)"
done
call 2 "usage: pupil bench WHAT" bench
expect 2 "kettles: nothing that can be measured" bench kettles
expect 2 "--frames 0" bench scene --frames 0
expect 2 "--size 0x9" bench scene --size 0x9
expect 2 "--threads 300" bench scene --threads 300
expect 2 "--shiny" bench scene --shiny
expect 2 "at most 16 scenes" bench scene 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17
expect 1 "no-such" bench scene no-such small.scene --size 8x8 --frames 1
{ cat small.scene; echo "camera position_m 0 1 4 look_at_m 0 0 0 fov_degrees 50 at_frame 9"; } >moves.scene
expect 1 "its camera moves" bench scene moves.scene --size 8x8
grep -v '^lamp' small.scene >dark.scene
expect 1 "no light" bench scene dark.scene --size 8x8

# Ctrl-C while it renders: a quick end, nothing on standard output. A background job of sh ignores SIGINT, not SIGTERM.
"$program" bench scene small.scene --size 4000x4000 >said.out 2>said.err &
sleep 0.5
kill -TERM $!
status=0
wait $! || status=$?
[ "$status" = 130 ] || fail "interrupted: exit $status, $(cat said.err)"
grep -q "interrupted" said.err || fail "interrupted: said $(cat said.err)"
[ ! -s said.out ] || fail "interrupted: $(cat said.out)"
end_test
