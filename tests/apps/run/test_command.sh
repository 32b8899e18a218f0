#!/bin/sh
# pupil run as a user sees it, on a camera in the process: modes, outputs, every way to end, what is refused; and the
# camera's controls are always restored. Needs $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera

put_back() {
    grep -qxF -- "$fake_restored" said.err || fail "$1: the controls are not put back: $(cat said.err)"
    grep -q "are left" said.err && fail "$1: $(cat said.err)"
}

# refused STATUS WORDS ARGUMENTS...: one sentence, and nothing is written
refused() {
    call "$@"
    [ "$(sentences)" = 1 ] || fail "run $*: not one sentence: $(cat said.err)"
    [ ! -e out.y4m ] || fail "run $*: an output is there"
    put_back "$*"
}

# column NAME FILE.csv: its values
column() {
    awk -F, -v name="$1" '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) n = i; next } { print $n }' "$2"
}
rows() { tail -n +2 "$1" | wc -l; }
last() { column "$1" "$2" | tail -n 1; }
sum() { column "$1" "$2" | awk '{ s += $1 } END { print s + 0 }'; }
# within VALUE LOW HIGH
within() { awk -v v="$1" -v a="$2" -v b="$3" 'BEGIN { exit !(v >= a && v <= b) }'; }

# help and usage
"$program" --help >help.txt 2>said.err || fail "--help does not exit 0"
help_fits 44 90 help.txt
refused 2 "--metreing" --metreing spot
refused 2 "-d /dev/video0" /dev/video0
for bad in "--mode fast" "--shutter 0" "--shutter 10m" "--shutter 1/0" "--shutter ms" "--shutter 2000s" "--gain 0" "--gain x" \
    "--mains 55" "--flicker-period 9ms" "--width 0" "--height 99999" "--size 64" "--framerate 0" "--format YUYVX" \
    "--control-delay 0" "--control-delay 16" "--buffers 1" "--buffers 33" "--reopen -1" "--timeout 0" "--timeout 5h" "--frames 0" "--ev 17" "--key 2" "--white dark" \
    "--metering moon" "--roi 0.5,0.5,0.6,0.1" "--trim 95,5" "--meter-rows 3" "--transfer pq" "--threads 1000" \
    "--gles-version 3.0" "--weight 0.1" "--fused --mode sensor" "--mains 50 --mode digital" \
    "--no-frame-rate-priority --mode digital" "--control-delay 2 --mode digital" "--curve linear --mode digital" \
    "--curve srgb" "--key-at 4 --mode sensor" "--key-at 4:0.1,x --mode sensor" "--key-at 0:0.1,1:0.2 --mode sensor" \
    "--key-at 0:0.1,0:0.1 --mode sensor" "--key-at 0:1,1:1,2:1,3:1,4:1,5:1,6:1,7:1,8:1 --mode sensor" \
    "--key-at 0:0.1,5:2" "--key 0.1 --key-at 0:0.1" \
    "--readout 0 --row-gains" "--readout 2s --row-gains" "--readout 25" "--row-gains --gles" \
    "--row-gains --view --gles-version 3.1" "--row-gains --fused" "--row-gains --mains off"; do
    # shellcheck disable=SC2086 # words
    refused 2 "${bad%% *}" $bad -o out.y4m
done
refused 2 "named for two outputs" -o a.mp4 -o ./a.mp4
refused 2 "named for two outputs" -o - --stats -
refused 2 "named for two outputs" --record a -o a
refused 2 "named for two outputs" --control x.y4m -o ./x.y4m
refused 2 "named for two outputs" --control x --stats x
refused 2 "named for two outputs" --control x --resume x
mkdir frames
refused 2 "frames/s.csv: is inside frames," -o frames --stats frames/s.csv
rmdir frames
refused 2 "is the camera itself" -d /dev/video0 -o /dev/video0
refused 1 "/dev/video9" -d 9 -o out.y4m
refused 1 "no camera" -d "no such camera" -o out.y4m
refused 1 "MJPX" --format MJPX -o out.y4m
refused 1 "--shutter: this camera exposes from 0.1 to 1000 ms" --shutter 10us -o out.y4m
refused 1 "--gain: this camera has gains from 1 to 64" --gain 65 -o out.y4m
refused 1 "none/out.mp4" -o none/out.mp4 -q
# detected before a camera is opened
for name in "--stats stats.txt" "-o picture.bmp" "--plot plot.jpg"; do
    # shellcheck disable=SC2086 # words
    refused 2 "${name#* }: " $name
done
"$program" fake:absent -o out.y4m 2>said.err
[ $? = 1 ] || fail "no camera: exit"
grep -q "no camera is there" said.err || fail "no camera: $(cat said.err)"
absent out.y4m

# a camera without controls: its picture is adapted to, or there is a sentence if more was asked for
"$program" fake:no-controls -n 5 -o plain.y4m 2>said.err || fail "no controls: $(cat said.err)"
grep -q "EXPOSURE_ABSOLUTE.*--mode digital" said.err || fail "no controls are not told: $(cat said.err)"
for asked in "--mode sensor" "--mode both" "--shutter 10ms" "--gain 2" "--mains 50" "--control-delay 2" "--curve unknown"; do
    # shellcheck disable=SC2086 # words
    "$program" fake:no-controls -n 5 $asked -q 2>said.err
    [ $? = 1 ] || fail "no controls, $asked: exit"
    grep -qF -- "${asked}" said.err || grep -qF -- "${asked%% *}" said.err || fail "no controls, $asked: $(cat said.err)"
done

# lamps and a rolling shutter: the readout is the driver's or given; else there are no gains, with the reason
lamps="fake:size=64x96 fake:format=Y12 fake:flat=600 fake:light=4@1 fake:lamps=100,0.3,0.025"
# shellcheck disable=SC2086 # words
{
    call 0 "; row correction gains in " $lamps fake:lines=998400,196 --shutter 1ms --row-gains -n 90
    grep -Eq "row correction gains in [3-9][0-9] of 90 frames$" said.err || fail "row gains: $(cat said.err)"
    put_back "row gains"
    call 0 "; row correction gains in " $lamps --shutter 1ms --row-gains --readout 25ms --mode digital --mains 50 -n 90
    grep -Eq "row correction gains in [3-9][0-9] of 90 frames$" said.err || fail "row gains, --readout: $(cat said.err)"
    call 0 "does not report its readout (PIXEL_RATE and HBLANK); give it with --readout MS" $lamps --row-gains -n 9
    call 0 "without the camera's controls its readout is not known" $lamps --row-gains -n 9 --mode digital
    call 0 "--mains 50 or 60" fake:no-controls $lamps --row-gains --readout 25 -n 9
    call 0 "" $lamps --shutter 1ms -n 9
    grep -q "row" said.err && fail "row gains that were not asked for: $(cat said.err)"
}

# modes: the requested values are written, and the controls are restored
for mode in digital sensor both; do
    call 0 "mode $mode" fake:delay=3 fake:flat=600 fake:light=2@150 --mode $mode -n 300 --stats $mode.csv -o $mode.y4m
    put_back "$mode"
    [ "$(rows $mode.csv)" = 300 ] || fail "$mode: $(rows $mode.csv) records"
    within "$(last output_level $mode.csv)" 0.165 0.195 || fail "$mode: shown at $(last output_level $mode.csv), not at 0.18"
    [ "$(sum lost $mode.csv)" = 0 ] || fail "$mode: lost $(sum lost $mode.csv)"
done
[ "$(column exposure_s digital.csv | sort -u)" = "" ] || fail "digital: an exposure is told: nobody asked the camera"
[ "$(last sensor digital.csv)" = "" ] || fail "digital: the sensor is $(last sensor digital.csv)"
for mode in sensor both; do
    [ "$(last sensor $mode.csv)" = converged ] || fail "$mode: the sensor is $(last sensor $mode.csv)"
    within "$(last digital $mode.csv)" 0.93 1.07 || fail "$mode: a digital factor of $(last digital $mode.csv) is left"
    [ "$(last in_force_from $mode.csv)" -gt 150 ] || fail "$mode: no reaction to the light"
    within "$(last metered_ev $mode.csv)" "$(last p01_ev $mode.csv)" "$(last p99_ev $mode.csv)" ||
        fail "$mode: metered $(last metered_ev $mode.csv) EV lies outside of the frame's quantiles"
    within "$(last scene_ev $mode.csv)" 4.8 5.0 || fail "$mode: the light is $(last scene_ev $mode.csv), not log2(0.2930 / 0.01)"
done
# the display's key and the camera's own
call 0 "" fake:delay=3 --mode both --ev 1 -n 90 --stats brighter.csv
within "$(last camera_key brighter.csv)" 0.1799 0.1801 && within "$(last key brighter.csv)" 0.3599 0.3601 ||
    fail "--ev: keys $(last camera_key brighter.csv) $(last key brighter.csv), not 0.18 and 0.36"
# a key by the light: 3.87 EV, log2(600 / 4095 / 0.01), then two stops less; each halfway between two points
night="fake:delay=3 fake:flat=600 fake:light=0.25@150 --mode sensor --key-at 0.87:0.04,2.87:0.08,4.87:0.12 -n 300"
# shellcheck disable=SC2086 # words
call 0 "" $night --stats night.csv
for what in output_level key; do
    within "$(column $what night.csv | sed -n 149p)" 0.091 0.105 || fail "--key-at: $what $(column $what night.csv | sed -n 149p), not 0.098"
    within "$(last $what night.csv)" 0.052 0.061 || fail "--key-at: $what $(last $what night.csv), not 0.0566"
done
[ "$(last sensor night.csv)" = converged ] || fail "--key-at: the sensor is $(last sensor night.csv)"
# a machine so busy that the thread that writes controls is late: the camera's clock waits for it, and nothing changes
# shellcheck disable=SC2086 # words
call 0 "" $night fake:work=0.003 --stats loaded.csv
for what in asked_exposure_s exposure_s in_force_from output_level; do
    [ "$(column $what night.csv)" = "$(column $what loaded.csv)" ] || fail "on a busy machine $what is another"
done
call 0 "mode both" -n 3 # the default, where there are controls
call 0 "" --shutter 1/100 --gain 2 -n 20 --stats hand.csv --mode digital
within "$(last exposure_s hand.csv)" 0.00999 0.01001 || fail "--shutter 1/100: $(last exposure_s hand.csv) s"
within "$(last gain hand.csv)" 2 2 || fail "--gain 2: $(last gain hand.csv)"
put_back "manual"
call 0 "" --shutter 5000 -n 40 --stats hand.csv -y
within "$(last exposure_s hand.csv)" 0.00499 0.00501 || fail "--shutter 5000: $(last exposure_s hand.csv) s"
call 0 "" --mains 50 fake:flat=600 fake:light=0.7@1 -n 120 --stats mains.csv
for e in $(column asked_exposure_s mains.csv | sort -u); do
    awk -v e="$e" 'BEGIN { n = e / 0.01; exit !(e < 0.01 || n - int(n + 0.5) < 1e-6 && int(n + 0.5) - n < 1e-6) }' ||
        fail "--mains 50: an exposure of $e s"
done
call 0 "" -t 2s --stats two.csv
[ "$(rows two.csv)" -ge 59 ] && [ "$(rows two.csv)" -le 61 ] || fail "-t 2s: $(rows two.csv) frames of 30 a second"
call 0 "latency unknown" fake:stamps=1000000 -t 1s --stats clock.csv # of another clock: arrival counts
[ "$(rows clock.csv)" -ge 29 ] && [ "$(rows clock.csv)" -le 31 ] || fail "another clock, -t 1s: $(rows clock.csv) frames"
[ -z "$(last latency_us clock.csv)" ] || fail "another clock: a latency of $(last latency_us clock.csv) us"
call 0 "64x48 at 15 frames/s" -t 2 --framerate 15 --width 64 --height 48 --format YUYV
call 0 "NV12" --format NV12 --buffers 3 --newest -n 5 -d "fake camera" 
put_back "by name"

# every output, complete; statistics as JSON; a plot
call 0 "" fake:real -n 40 -o a.mp4 -o a.mkv -o frames --stats a.jsonl --record rec
[ "$(find frames -name '*.png' | wc -l)" = 40 ] || fail "not 40 pictures"
[ -s a.mp4 ] && [ -s a.mkv ] && [ -s rec/frames.mkv ] || fail "an output is missing"
[ "$(wc -l <a.jsonl)" = 40 ] || fail "not 40 lines"
grep -q '"sequence":39,"lost":0,"flagged":0,"late":0,"exposure_s":' a.jsonl || fail "a line: $(tail -n 1 a.jsonl)"
# existing outputs are kept; names with a time or a number are new each time
refused 2 "a.mp4: is there already; -y replaces it, and a-1.mp4 is free" -o a.mp4
[ -s a.mp4 ] || fail "a.mp4 is gone"
for n in 000 001 002; do
    call 0 "; shot-$n.png" -n 1 -o shot-%03d.png
done
# two runs that begin together get different numbers
"$program" fake:real -n 5 -q -o two-%d.y4m &
call 0 "; two-" fake:real -n 5 -o two-%d.y4m
wait $! || fail "the other of two runs fails"
[ -s two-0.y4m ] && [ -s two-1.y4m ] || fail "of two runs: $(ls -A two-* .two-*)"
left=$(find . -name '.*.part')
[ -z "$left" ] || fail "left behind: $left"
before=$(date +%Y%m%d)
call 0 "" -n 1 -o day-%Y%m%d.png
[ -s "day-$before.png" ] || [ -s "day-$(date +%Y%m%d).png" ] || fail "no file of today: $(ls day-*)"
refused 2 "is there already" -n 1 -o day-%Y%m%d.png
call 0 "-0.png" -n 1 -o day-%Y%m%d-%1d.png
refused 2 "5%.png: a % is followed by" -n 1 -o 5%.png
call 0 "; 5%.png" -n 1 -o 5%%.png
rm -f shot-* day-* two-* 5*.png
if command -v gnuplot >/dev/null; then
    call 0 "" -n 40 --plot a.svg
    grep -q "<svg" a.svg || fail "no plot"
fi
absent out.y4m
call 0 "/dev/video2" -n 10 -o /dev/video2

# a recording replays to the same statistics
if [ -n "${PUPIL_PROGRAM:-}" ]; then
    call 0 "" fake:real fake:light=4@20 -n 60 --record again --stats live.csv
    "$PUPIL_PROGRAM" replay again --stats replay.csv -q -y 2>said.err || fail "the recording does not replay: $(cat said.err)"
    cut -d, -f1,3-18,22 live.csv | tr -d '\r' >live.cut
    cut -d, -f1,3-18,22 replay.csv | tr -d '\r' >replay.cut
    cmp -s live.cut replay.cut || fail "a recording replays to other statistics"
fi

# frames lost to a slow disk: the exit status says so
if [ -n "${PUPIL_PROGRAM:-}" ]; then
    "$program" fake:hasty fake:size=320x240 fake:format=RG10 -n 200 -q --record hasty >said.out 2>said.err
    got=$?
    "$PUPIL_PROGRAM" replay hasty --stats hasty.csv -q
    [ "$(rows hasty.csv)" = 200 ] && want=0 || want=3
    [ $got = $want ] || fail "$(rows hasty.csv) of 200 frames recorded: exit $got, expected $want"
    rm -rf hasty
fi

# lost frames are counted, and outputs play at the camera's speed
call 0 "" fake:drop=0.3 fake:flag=0.1 -n 100 --stats lost.csv -o lost.y4m
[ "$(sum lost lost.csv)" -gt 20 ] || fail "lost frames are not counted"
[ "$(sum flagged lost.csv)" -gt 2 ] || fail "damaged frames are not counted"
first=$(column sequence lost.csv | head -n 1)
want=$(($(last sequence lost.csv) - first + 1))
bytes=$(($(wc -c <lost.y4m) - $(head -n 1 lost.y4m | wc -c)))
[ "$bytes" = $((want * (64 * 48 * 3 + 6))) ] || fail "lost.y4m is not as long as the $want frames that were due"

# ends: a closed pipe, a signal, the camera's own end; written frames are kept
for stream in "-o -" "--stats -"; do
    # shellcheck disable=SC2086 # words
    { "$program" $stream -o piped.y4m; echo $? >status; } 2>said.err | head -c 30000 >/dev/null
    [ "$(cat status)" = 0 ] || fail "$stream into a closed pipe: exit $(cat status): $(cat said.err)"
    [ -s piped.y4m ] || fail "$stream into a closed pipe: the other output is lost"
    [ "$(grep -c '^pupil run' said.err)" = 0 ] || fail "$stream into a closed pipe is no failure: $(cat said.err)"
    put_back "$stream"
    rm -f piped.y4m
done
# ... in the first frame: there is no other output, none is named, and that is not a failure, either
{
    until [ -e closed ]; do sleep 0.1; done
    "$program" -o - -o first.y4m --stats first.csv --plot first.svg -n 20
    echo $? >status
} 2>said.err | { exec <&- && : >closed; }
[ "$(cat status)" = 0 ] || fail "a closed pipe at first: exit $(cat status): $(cat said.err)"
grep -q 'first\.' said.err && fail "a closed pipe at first: $(cat said.err)"
for path in first.y4m first.csv first.svg; do absent $path; done

# begin ARGUMENTS...: in the background, until its first record is there
begin() {
    rm -f lines
    mkfifo lines
    "$program" fake:real "$@" --stats - >lines 2>said.err </dev/null &
    running=$!
    exec 4<lines
    read -r line <&4 || fail "no frame: $(cat said.err)"
    cat <&4 >/dev/null &
    exec 4<&-
}
for signal in INT TERM HUP; do
    # a shell makes its background jobs ignore SIGINT, and a signal that is ignored at a program's start stays ignored
    begin -y -o signal.y4m -o signal.mp4
    kill -$signal $running
    ends 0
    [ -s signal.y4m ] && [ -s signal.mp4 ] || fail "SIG$signal loses outputs"
    put_back "SIG$signal"
    rm -f signal.*
done

call 1 "unplugged" fake:unplug=30 -o unplug.y4m --stats unplug.csv --record unplug
[ "$(rows unplug.csv)" = 30 ] && [ -s unplug.y4m ] && [ -s unplug/frames.mkv ] || fail "unplugging loses what was there"
call 0 "opened again 1" fake:unplug=30 fake:back=1 --reopen 5 -n 90 --stats back.csv
[ "$(rows back.csv)" = 90 ] || fail "--reopen: $(rows back.csv) frames"
# while its controls are being opened again its light is unknown
for name in asked_exposure_s sensor sensor_reason camera_key scene_ev; do column $name back.csv >$name.column; done
away=$(paste -d , ./*.column | grep '^,' | sort -u) # in alphabetical order
[ "$away" = ",,,searching,waiting" ] || fail "--reopen: while there are no controls: $away"
call 1 "32 x 24 pixels now" fake:unplug=30 fake:back=1 fake:again=32x24@25 --reopen 5 -o size.y4m -o size.mp4 --stats size.csv
[ "$(rows size.csv)" = 30 ] && [ -s size.mp4 ] && [ -s size.y4m ] || fail "another size loses what was there"
call 1 "did not come back within 2 seconds" fake:unplug=30 --reopen 2 --stats gone.csv
[ "$(rows gone.csv)" = 30 ] || fail "--reopen in vain: $(rows gone.csv) frames"
call 1 "no frame within 5 seconds" fake:stall=20 -o stall.y4m
put_back "a camera that stalls"
call 0 "20 frames" fake:end=19 -o end.y4m
put_back "the camera's end"

# an output that fails ends the run; the others are kept
mkdir full
if mount -t tmpfs -o size=64k tmpfs full 2>/dev/null; then
    call 1 "full/small.y4m" -o full/small.y4m -o large.y4m -n 50
    put_back "a full disk"
    [ -s large.y4m ] || fail "a full disk for one output loses the other"
    bytes=$(($(wc -c <full/small.y4m) - $(head -n 1 full/small.y4m | wc -c)))
    [ "$bytes" = $((7 * (64 * 48 * 3 + 6))) ] || fail "a full disk: not whole frames: $bytes bytes"
    grep -q 'full/small.y4m: .*; the 7 frames before are kept$' said.err || fail "a full disk: $(cat said.err)"
    rm full/small.y4m
    head -c 54k /dev/zero >full/most
    call 1 "full/small.svg: the plot cannot be written" --plot full/small.svg -n 40
    absent full/small.svg
    umount full
fi

# the sixth write of controls hangs for five seconds: ten seconds of the camera pass, and no frame is lost
call 0 "300 frames" fake:sleep=6,5 -n 300 --stats hang.csv
[ "$(sum lost hang.csv)" = 0 ] || fail "a write that hangs loses $(sum lost hang.csv) frames"
[ "$(last sensor_reason hang.csv)" = waiting ] || fail "a write that hangs: the sensor is $(last sensor_reason hang.csv), not waiting"
[ "$(column in_force_from hang.csv | sort -u | wc -l)" -le 2 ] || fail "the write did not hang"
put_back "a write that hangs"

# states and reasons are those of pupil/sensor.h
call 0 "60 frames" fake:real fake:light=0.0001@1 -n 60 --stats dark.csv
[ "$(last sensor dark.csv) $(last sensor_reason dark.csv)" = "limited gain_max" ] ||
    fail "in the dark the sensor is $(last sensor dark.csv) by $(last sensor_reason dark.csv), not limited by gain_max"

# a camera that is busy for a moment: the refused setting is asked for again, and the original one is restored
call 0 "refused by the camera: " fake:real fake:flat=600 fake:light=4@15 fake:refuse=6,6,16 -n 110 --stats busy.csv
[ "$(last exposure_s busy.csv)" = "$(last asked_exposure_s busy.csv)" ] || fail "a refused exposure is not asked for again"
within "$(last output_level busy.csv)" 0.165 0.195 || fail "after a refusal: shown at $(last output_level busy.csv)"
put_back "a camera that is busy"
call 0 "" --mode digital --shutter 1/100 --gain 2 fake:refuse=6,2,16 fake:real -n 15
put_back "a camera that is busy at the end"
call 0 "" --mode digital --shutter 1/100 --gain 2 fake:refuse=5,3,16 fake:real -n 30 --stats busy.csv -y
within "$(last exposure_s busy.csv)" 0.00999 0.01001 || fail "--shutter that was refused at first: $(last exposure_s busy.csv)"

# writes take a fifth of a second while the assumed delay is wrong by one frame: no step back
call 0 "" fake:real fake:flat=600 fake:light=2@30 fake:write=0.2 -n 75 --stats slow.csv
column asked_exposure_s slow.csv | awk 'NR > 30 && $1 > 1.1 * least { exit 1 } NR <= 30 || $1 < least { least = $1 }' ||
    fail "slow writes make it swing: $(column asked_exposure_s slow.csv | uniq | tr '\n' ' ')"

# a fatal signal: the controls are restored before the end
{
    ("$program" fake:crash=20 -o crash-%d.y4m) >said.out 2>said.err
    got=$?
} 2>/dev/null # the shell's own words, which look like a crash that nobody asked for
[ $got = 139 ] || fail "SIGSEGV is not what it ends with: $got"
for left in "9a0902 = 77" "980913 = 40" "9a0901 = 3"; do
    grep -q "after the crash $left" said.err || fail "a crash leaves a control: no '$left' in $(cat said.err)"
done

[ "$(wc -c <crash-0.y4m)" -ge $((19 * (64 * 48 * 3 + 6))) ] || fail "a crash loses frames: $(wc -c <crash-0.y4m) bytes"
left=$(find . -name '.crash*')
[ -z "$left" ] || fail "a crash leaves $left"

# a second Ctrl-C discards outputs that take too long to complete
mkdir bin
cat >bin/gnuplot <<'PLOT'
#!/bin/sh
read -r line || exit 0 # asked only whether it is there
: >"$(dirname "$0")/plotting"
sleep 2
PLOT
chmod +x bin/gnuplot
before=$PATH
PATH=$room/bin:$PATH
begin --plot slow.svg
kill -TERM $running
tries=0
while [ ! -e bin/plotting ] && [ $tries -lt 100 ]; do sleep 0.1; tries=$((tries + 1)); done
[ -e bin/plotting ] || fail "no plot was begun: $(cat said.err)"
kill -TERM $running
ends 130
PATH=$before
grep -q "given up" said.err || fail "giving up is not told: $(cat said.err)"
put_back "a second signal"
absent slow.svg

end_test
