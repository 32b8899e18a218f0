#!/bin/sh
# pupil run with two cameras, each in its own process: one exposure through a step of light, within the limits of both;
# each has its own outputs; a lost one ends alone. Needs $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera
needs python3

# two STATUS WORDS ARGUMENTS...: /dev/video9 is the second camera, a stop more sensitive
two() {
    status=$1 words=$2
    shift 2
    rm -f s0.csv s1.csv
    call "$status" "$words" fake:real fake:fps=20 fake:size=64x48 fake:flat=600 fake:other-light=2 "$@" -d /dev/video0 \
        -d /dev/video9 --camera-ev 1 --stats s%i.csv
}
# alike FROM TO FIELD EV [FRAMES]: in these frames, by sequence, the two are so many stops apart, within 0.05; shown:
# exposure x gain x the factor of the picture. On a busy machine one camera's process may write a setting a frame later
# than the other; FRAMES: in a step of light, one may be so many frames behind
alike() {
    python3 - "$@" <<'END' || fail "$*"
import csv, math, sys
begin, end, field, ev = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], float(sys.argv[4])
frames = int(sys.argv[5]) if len(sys.argv) > 5 else 0
def read(name):
    rows = {int(r["sequence"]): r for r in csv.DictReader(open(name))}
    if field != "shown":
        return {n: float(r[field]) for n, r in rows.items()}
    return {n: float(r["exposure_s"]) * float(r["gain"]) * float(r["digital"]) for n, r in rows.items()}
a, b = read("s0.csv"), read("s1.csv")
both = [n for n in a if n in b and begin <= n < end]
assert len(both) > (end - begin) / 2, len(both)
near = {n: [m for m in range(n - frames, n + frames + 1) if m in b] for n in both}
worst = max(min(abs(math.log2(a[n] / b[m]) - ev) for m in near[n]) for n in both)
print(f"frames {begin} to {end}: {field} within {worst:.3f} EV")
assert worst <= 0.05, worst
END
}
restored() { [ "$(grep -cxF "$fake_restored" said.err)" = 3 ] || fail "the controls: $(cat said.err)"; } # one is the first process's
rows() { [ "$(wc -l <"$1")" = "$2" ] || fail "$1 has $(wc -l <"$1") lines, not $2: $(cat said.err)"; }

two 0 "/dev/video9: 100 frames" fake:light=8@50 --mode sensor -n 100 -o p%i.y4m
restored
alike 10 98 shown 1 1
alike 75 98 shown 1
alike 75 98 output_level 0
grep -q ",following," s1.csv && ! grep -q ",following," s0.csv || fail "who follows?"
grep -qE "sees (0\.9[0-9]|1\.0[0-9]) EV more light than the camera that leads, --camera-ev \+1\.00" said.err || fail "$(cat said.err)"
rows s0.csv 101
[ -s p0.y4m ] && cmp -s p0.y4m p1.y4m && fail "two outputs are one"

two 0 "" fake:light=8@50 --mode both -n 100
alike 10 98 shown 1 1
alike 75 98 output_level 0
alike 75 98 scale 0

# within the limits of both: the second has a gain of two at most, and it is dark
two 0 "" fake:light=0.05@1 fake:other-gain=32 --mode sensor -n 60
alike 40 58 shown 1

# lost: one sentence, its output is complete, and the other camera runs to the end
two 1 "unplugged" fake:light=8@50 fake:other-unplug=40 --mode sensor -n 100
[ "$(grep -c "^pupil run: " said.err)" = 1 ] || fail "lost: $(cat said.err)"
rows s0.csv 101
rows s1.csv 41
two 1 "unplugged" fake:light=8@70 fake:unplug=40 fake:other-unplug=1000 --mode sensor -n 110
[ "$(grep -c "^pupil run: " said.err)" = 1 ] || fail "the first is lost: $(cat said.err)"
rows s0.csv 41
rows s1.csv 111
tail -n 1 s1.csv | grep -q ",converged," || fail "the second does not lead: $(tail -n 1 s1.csv)"

# a signal to only the first process ends both
"$program" fake:real fake:fps=20 fake:size=64x48 fake:other-light=1 -d /dev/video0 -d /dev/video9 --stats e%i.jsonl -q 2>said.err </dev/null &
running=$!
sleep 2
kill -TERM $running
wait $running || fail "SIGTERM: exit $?: $(cat said.err)"
running=
[ -s e0.jsonl ] && [ -s e1.jsonl ] || fail "SIGTERM: no outputs"
restored

# killed, with threads, each of whose ends is signalled to the cameras' processes; also together with a manager's
# SIGTERM: the outputs are complete
for with in "" TERM; do
    "$program" fake:real fake:fps=20 fake:size=64x48 fake:other-light=1 fake:threads -d /dev/video0 -d /dev/video9 \
        --stats k%i.csv -o k%i.y4m -y -q 2>said.err </dev/null &
    running=$!
    sleep 2
    cameras=$(cat "/proc/$running/task/$running/children")
    [ "$(echo "$cameras" | wc -w)" = 2 ] || fail "the cameras' processes: $cameras"
    kill -9 $running
    # shellcheck disable=SC2086 # ids
    [ -z "$with" ] || kill -$with $cameras
    wait $running 2>/dev/null
    running=
    for camera in $cameras; do
        until_true "a camera goes on" eval '! kill -0 $camera 2>/dev/null'
    done
    for output in k0.csv k1.csv k0.y4m k1.y4m; do
        [ -s $output ] || fail "killed $with: no $output: $(cat said.err)"
    done
    rm -f k?.csv k?.y4m
done

# a camera's process that is killed is named by its device
"$program" fake:real fake:fps=20 fake:size=64x48 fake:other-light=1 -d /dev/video0 -d /dev/video9 -n 60 -q 2>said.err </dev/null &
running=$!
sleep 1
cameras=$(cat "/proc/$running/task/$running/children")
kill -9 "$(echo "$cameras" | awk '{ print $2 }')"
ends 1
grep -q "pupil run: /dev/video9: its process was ended by signal 9" said.err || fail "killed: $(cat said.err)"

both="-d 0 -d /dev/video9"
# shellcheck disable=SC2086 # words
{
    call 2 "p.y4m: each of several cameras has its own; %i in the name" $both -o p.y4m
    call 2 "-: each of several cameras has its own" $both --stats -
    call 2 "/dev/video9: is the same camera as --device /dev/video9" $both -d /dev/video9
    call 2 "--control c%i: belongs to the first camera only" $both --control c%i
    call 2 "e0.csv: named for two outputs" $both --control e0.csv --stats e%i.csv
    echo mine >there1.csv # of the second camera
    call 2 "there1.csv" $both --stats there%i.csv -o there%i.y4m -n 2
    [ ! -e there0.csv ] && [ ! -e there0.y4m ] || fail "the first camera has begun"
    [ "$(sentences)" = 1 ] || fail "more than one sentence: $(cat said.err)"
    call 0 "" fake:real fake:fps=20 fake:size=64x48 fake:other-light=1 $both --stats n%i-%i.csv -n 2
    [ -s n0-0.csv ] && [ -s n1-1.csv ] || fail "two places in a name"
    call 2 "--camera-ev: has to have a number for each camera but the first: 1" $both --camera-ev 1,2
    call 2 "--camera-ev 17: must be stops from -16 to 16" $both --camera-ev 17
    call 2 "--camera-ev: needs several cameras" -d 0 --camera-ev 1
    call 2 "--mode digital does not touch" $both --mode digital
    call 2 "--shutter and --gain: work with one camera only" $both --gain 2
    call 2 "--fused: works with one camera only" $both --fused
    call 2 "at most 8 cameras" $both $both $both $both $both
}

end_test
