#!/bin/sh
# pupil sim and pupil bench ae: what they print and write, that it repeats, what is refused with which words.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
# a run: its summary, its frames
"$program" sim --light '2s step +3ev; 4s step -6ev' --stats run.jsonl >summary.txt 2>noise.txt
[ ! -s noise.txt ] || fail "on stderr: $(cat noise.txt)"
[ "$(wc -l <run.jsonl)" = 420 ] || fail "$(wc -l <run.jsonl) lines for 14 s at 30 frames a second"
for words in '^controller  pupil' '^settled     [0-9]* frames after frame 120' '^overshoot ' '^swings      0 of' \
    '^at the end .*; converged\(, [a-z_]*\)*$'; do
    grep -q -- "$words" summary.txt || fail "no $words in $(cat summary.txt)"
done
for words in '^{"time_s":0.000000,"frame":0,"dropped":0,"light_ev":5.500000,' '"told_exposure_s":' '"error_ev":' \
    '"state":"converged"'; do
    grep -q -- "$words" run.jsonl || fail "no $words in $(head -1 run.jsonl)"
done
grep -q 'nan\|inf' run.jsonl && fail "a number that is none: $(grep -m1 'nan\|inf' run.jsonl)"
if command -v python3 >/dev/null; then
    python3 -c 'import json, sys; [json.loads(l) for l in open("run.jsonl")]' || fail "no JSON"
fi
"$program" sim --light '2s step +3ev; 4s step -6ev' --stats - >again.jsonl
cmp run.jsonl again.jsonl || fail "another run is another one"
echo '2s step +3ev # a line
4s step -6ev' >light.txt
"$program" sim --light @light.txt --stats - >again.jsonl
cmp run.jsonl again.jsonl || fail "a script from a file is another one"

# cameras behave as configured
"$program" sim -c delay=1/4,law=third,drop=20%,bits=10 --duration 4 --stats some.jsonl --json >said.out
grep -q '^{"controller":"pupil","frames":120,.*"swings":0}$' said.out || fail "summary: $(cat said.out)"
grep -q '"dropped":[1-9]' some.jsonl || fail "no frame dropped"
"$program" sim --controller rpi --json -l '2s step 6ev' >said.out
grep -q '"controller":"rpi".*"settle_frames":3[4-7],' said.out || fail "rpi settles otherwise: $(cat said.out)"
"$program" sim --controller integrator1 --json >said.out
grep -q '"swings":0}' said.out && fail "a naive integrator does not swing: $(cat said.out)"
"$program" sim --scene room --json -l '2s step 2ev' -q >said.out
grep -q '"swings":0}' said.out || fail "the room: $(cat said.out)"
"$program" sim --mains 50 -l '0s -3ev; lamp 50Hz 30%' --stats - >lamp.jsonl
tail -1 lamp.jsonl | grep -q '"band_ev":0.0[01]' || fail "bands with the mains told: $(tail -1 lamp.jsonl)"

# a key by the light settles as fast as a fixed one, at its own level
"$program" sim --key-at -1:0.05,5.5:0.18 --light '2s step -4ev' --json >said.out
grep -q '"settle_frames":5,"overshoot_ev":0.0000[0-9]*,"aim_ev":-\?0.00' said.out || fail "--key-at: $(cat said.out)"

# cameras with which the previous loop ended wrong
# A wall in light that moves as fast as the loop follows: its level stays, and is not white.
"$program" sim -q --check --delay 4 \
    --camera "seed=18653,fps=9.92030184,readout=0ms,line=62.9999466us,shortest=188.99984us,\
longest=100.803384ms,gain=14.1996488,law=third,delay=1/4,size=16x32,black=256,\
noise=0.0094574355ev,scene=flat:2.11358,light=-0.743566161ev,off=1" \
    --light "0s -1.856ev; 1.0080s 2.064ev; 3.0241s 4.026ev; 6.8546s ramp -0.5122ev/s 3.7297s; 10.5844s 2.116ev; 11.1892s -0.330ev" >again.txt ||
    fail "$(grep verdict again.txt)"
# Only one control moves, and its delay is known: the filter is as fast as with both.
"$program" sim -q --check --delay 4 \
    --camera "seed=18492,fps=13.3505848,readout=38.641058ms,line=22.8069968us,shortest=68.4209905us,\
longest=74.9030857ms,gain=36.4075736,law=sixteenth,delay=2/4,size=16x32,black=256,\
curve=gamma:0.951846,scene=window:1.86951,light=10.466174ev,black_off=-23.1950731%" \
    --light "0s -2.689ev; 2.0973s -24.000ev; 3.8950s -9.911ev; 5.9173s -9.714ev; 7.6401s -9.911ev" >again.txt ||
    fail "$(grep verdict again.txt)"
# A search stopped below the brightest setting, and the aim is out of reach: the last gain is asked for.
"$program" sim -q --check --delay 4 \
    --camera "seed=7342,fps=52.8761191,readout=14.49363ms,line=15.5348963us,shortest=31.0697925us,\
longest=39.8859335ms,gain=25.397245,delay=2/4,size=16x32,bits=8,\
curve=gamma:1.66465,scene=window:4.36907,light=8.7161125ev,white=98%/98%" \
    --light "0s 3.138ev; lamp 60Hz 30.5% daylight 14.9% pwm 74%; 0.3782s ramp -13.7546ev/s 1.0969s; 1.4751s -11.950ev; \
1.8912s -9.367ev; 2.3912s -8.474ev; 2.8912s -10.675ev; 4.2233s ramp 5.9622ev/s 0.7754s; 4.9987s -6.052ev; \
5.5472s ramp -4.8543ev/s 0.8132s; 6.3604s -10.000ev; 6.3604s lamp off" >again.txt || fail "$(grep verdict again.txt)"
# Frames without metadata say nothing of the delay: what the controls did before is not computed again.
"$program" sim -q --check --delay 5 \
    --camera "seed=5311577,fps=9.04146509,readout=88.4173137ms,line=23.6459319us,shortest=23.6459319us,\
longest=110.601544ms,gain=2.172581,law=third,delay=1/1,jitter=1/0,size=16x32,bits=16,black=4096,well=6252.20294,\
read=9.88817405,shot=1,scene=lognormal:1.54274,light=6.38267585ev,mute=22.3964669%,dead_exposure=0.886796ms/2.31482ms" \
    --light "0s -0.508ev; 1.2166s -0.579ev; 1.7166s 1.664ev; 2.2166s -1.910ev; 2.7166s 1.557ev; 7.8619s -1.039ev; \
8.3619s 0.131ev; 8.8619s -1.086ev; 9.3619s -0.743ev; 9.8619s 0.583ev; 10.3619s -0.892ev; 11.0831s -0.161ev" >again.txt ||
    fail "$(grep verdict again.txt)"

# Slow programs: their frames have waited in a queue, and nothing says which setting they were taken with.
for queue in 2/2 2/15 3/4 3/9 4/3 4/6 4/10 4/16; do
    for told in truth nothing; do
        "$program" sim -q --check --camera "queue=$queue,told=$told,noise=0.01ev,curve=gamma:0.8" \
            --light '4s step +3ev; 30s step -5ev; 60s step +1.5ev; 90s step -3ev' >again.txt ||
            fail "queue=$queue,told=$told: $(grep verdict again.txt)"
    done
done

if command -v gnuplot >/dev/null; then
    "$program" sim --plot run.svg >/dev/null
    grep -q '<svg' run.svg || fail "no plot"
    expect 1 "a plot is an .svg or a .png file" sim --plot run.jpg
    [ ! -e run.jpg ] || fail "half a plot"
    expect 1 "run.svg: is there already; -y replaces it" sim --plot run.svg
    expect 0 "" sim --plot run.svg -y
    expect 1 "run.svg: is there already; -y replaces it" bench ae --plot run.svg
fi
cp run.jsonl kept.jsonl
expect 1 "run.jsonl: is there already; -y replaces it, and run-1.jsonl is free" sim --stats run.jsonl
cmp -s run.jsonl kept.jsonl || fail "statistics that were there are gone"
expect 0 "" sim --stats run.jsonl -y

# random cameras, and one of them again
status=0
"$program" sim --random 30 --seed 1000 >many.txt 2>noise.txt || status=$?
[ "$status" -le 1 ] && [ ! -s noise.txt ] || fail "random: exit $status, $(cat noise.txt)"
grep -q '^pupil: 30 cameras from seed 1000, [0-9]* frames: [0-9]* failed' many.txt || fail "random: $(cat many.txt)"
status=0
"$program" sim --random 5 --seed 3 --controller integrator1 >many.txt || status=$?
[ "$status" = 1 ] || fail "naive integrators around random cameras: exit $status"
again=$(sed -n 's/^seed [0-9]*: .*a swing of .* again with: pupil \(.*\) --plot again.svg$/\1/p' many.txt | head -1)
[ -n "$again" ] || fail "no swing: $(cat many.txt)"
grep -q '^all cameras  *5  *100.0% ' many.txt || fail "no table: $(cat many.txt)"
status=0
"$program" $again >said.out 2>noise.txt || status=$?
[ "$status" = 1 ] && grep -q "^verdict  *wrong: .*a swing of" said.out || fail "pupil $again: exit $status, $(cat said.out)"
grep -q "the loop ends wrong: .*a swing of" noise.txt || fail "pupil $again: said $(cat noise.txt)"
"$program" sim --random 20 --json >many.json || :
if command -v python3 >/dev/null; then
    python3 -c 'import json; r = [json.loads(l) for l in open("many.json")][-1]; assert r["faults"][-1]["cameras"] == 20 == r["plants"]' ||
        fail "random as JSON: $(cat many.json)"
fi

# a loop that ends wrong, if that is asked for; and light that allows no verdict
"$program" sim --light '2s step 3ev' --check >said.out || fail "--check: $(cat said.out)"
grep -q "^verdict  *right: shown" said.out || fail "--check: $(cat said.out)"
"$program" sim --light '2s 14ev' --check >said.out || fail "--check out of reach: $(cat said.out)"
grep -q "^verdict  *right, but the aim is darker than the camera can" said.out || fail "out of reach: $(cat said.out)"
"$program" sim --controller integrator1 >said.out || fail "a loop that ends wrong, without --check"
expect 1 "the loop ends wrong: shown" sim --controller integrator1 --check
expect 0 "" sim --camera fps=5,drop=20% --check # long enough for a verdict
expect 1 "the light is not still for long enough" sim --light 'lamp 50Hz 30%' --check

# the comparison
"$program" bench --ae --test hunt --controller pupil --json >lines.txt
[ "$(wc -l <lines.txt)" = 16 ] || fail "not a line a pair: $(cat lines.txt)"
grep -q '^{"controller":"pupil","test":"hunt","of":"","gain_law":"256/(256-n)","delay":4,"believed":1,"step_ev":1,' \
    lines.txt || fail "hunt: $(cat lines.txt)"
"$program" bench ae --test strobe --controller rpi >said.out
grep -q '^strobe  *1 frame  *rpi  *[0-9.]* *0.0200 *[0-9]* of 16' said.out || fail "strobe: $(cat said.out)"

if command -v gnuplot >/dev/null; then
    "$program" bench ae --plot steps.svg >said.out 2>noise.txt
    [ ! -s noise.txt ] && [ ! -s said.out ] || fail "bench ae --plot: $(cat noise.txt said.out)"
    for name in pupil "pupil, flash_frames 0" rpi libipa softisp openpilot integrator0.25 integrator1; do
        grep -qF ">$name<" steps.svg || fail "no curve of $name"
    done
fi

for help in "sim --help" "help sim" "bench ae --help"; do
    "$program" $help >help.txt
    [ "$(wc -l <help.txt)" -le 24 ] || fail "$help is $(wc -l <help.txt) lines"
    grep -q "usage: pupil" help.txt || fail "pupil $help says $(cat help.txt)"
done
"$program" sim --camera help | grep -q 'delay=3' || fail "no keys of a camera"
"$program" sim --light help | grep -q 'flash' || fail "no words of a light"

expect 2 "--light: statement 1: 'stp' is no statement" sim --light '2s stp 1ev'
expect 2 "camera: bird: there is no such key" sim -c bird=3
expect 2 "camera: its delay of exposure is 9; 1..8 is right" sim -c delay=9
expect 2 "--controller wizard: must be one of pupil rpi" sim --controller wizard
expect 2 "--delay 0: must be a whole number from 1 to 16" sim --delay 0
expect 2 "--mains 55: must be 0, 50, 60 or auto" sim --mains 55
expect 2 "--key-at 0:0.1,1:0.2: must be EV:KEY" sim --key-at 0:0.1,1:0.2
expect 2 "--key-at: needs --controller pupil" sim --key-at 0:0.1 --controller rpi
expect 2 "--threads 300: must be a whole number from 0 to 256" sim --random 2 --threads 300
expect 2 "--duration soon: must be a number" sim --duration soon
expect 2 "--random: camera, light, scene and duration" sim --random 3 -c delay=2
expect 2 "--stats and --plot are of one run" sim --random 3 --stats x.jsonl
expect 2 "extra: it takes no argument" sim extra
expect 2 "--shiny" sim --shiny
expect 2 "no-such.txt: No such file" sim --light @no-such.txt
expect 1 "no-such-scene" sim --scene no-such-scene
expect 1 "no/such" sim --stats no/such/run.jsonl
expect 2 "--test size: must be one of settle" bench ae --test size
expect 2 "--controller x: must be one of pupil" bench ae --controller x
expect 2 "it takes no argument" bench ae all
expect 2 "--plot draws all loops" bench ae --plot a.svg --test settle
expect 1 "no/such.svg" bench ae --plot no/such.svg
end_test
