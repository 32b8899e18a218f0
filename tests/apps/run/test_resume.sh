#!/bin/sh
# pupil run --resume: the first frames of a run are as bright as the last ones of the previous run, on a camera in the
# process; the state is kept per camera, written no matter how the run ends, and no other file is touched. Needs
# $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera

# run STATUS WORDS ARGUMENTS...: the exit status, and words in standard error; the camera is far too bright as its user
# left it
run() {
    status=$1 words=$2
    shift 2
    call "$status" "$words" fake:real fake:flat=600 fake:light=12@1 "$@" -q
    case "$*" in
    *fake:no-controls* | *fake:unplug*) ;; # there are none at the end
    *) grep -qxF "$fake_restored" said.err || fail "run $*: the controls: $(cat said.err)" ;;
    esac
}

# said LINES: so many sentences
said() { [ "$(grep -c '^pupil run' said.err)" = "$1" ] || fail "not $1 sentences: $(cat said.err)"; }

# off_key FILE.csv: how many of its first ten frames are not at the key of 0.18
off_key() {
    awk -F, '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == "output_level") n = i; next }
        NR <= 11 && ($n < 0.165 || $n > 0.195) { off++ } END { print off + 0 }' "$1"
}
first_sequence() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "sequence") n = i; next } { print $n; exit }' "$1"
}
header="pupil run --resume 1: exposure x gain in seconds, driver, bus, card of each camera"
line=$(printf 'fake\tfake:1\tFake Camera')

# without --resume, and the first time, when there is no file; on a busy machine frames are lost and it takes seconds
run 0 "" --mode sensor -n 40 --stats without.csv
[ "$(off_key without.csv)" -ge 5 ] || fail "without --resume only $(off_key without.csv) of the first frames are off"
run 0 "" --mode sensor -n 180 --stats first.csv --resume kept
said 0
[ "$(off_key first.csv)" -ge 5 ] || fail "the first time only $(off_key first.csv) of the first frames are off"
[ "$(head -n 1 kept)" = "$header" ] && [ "$(sed -n 2p kept | cut -f2-)" = "$line" ] && [ "$(wc -l <kept)" = 2 ] ||
    fail "kept: $(cat kept)"
# 0.18 / (0.1465 x 12 / 0.01 s) within a tenth of a stop: if the light jumps in the frame in which a late write comes
# into force, the loop takes the camera for a nonlinear one, and the digital factor gets less of the rest below a tenth
# of a millisecond
sed -n 2p kept | awk '{ exit !($1 > 0.000955 && $1 < 0.001095) }' || fail "kept: $(cat kept)"

# the second time
for mode in sensor both; do
    run 0 "" --mode $mode -n 20 --stats second.csv -y --resume kept
    said 0
    [ "$(off_key second.csv)" = 0 ] || fail "$mode: $(off_key second.csv) of the first frames are not at the key"
    [ "$(first_sequence second.csv)" -le 30 ] || fail "$mode: begins with frame $(first_sequence second.csv)"
    [ "$(wc -l <second.csv)" = 21 ] || fail "$mode: $(wc -l <second.csv) lines"
done

# another camera's setting is not used, and stays in the file
printf '%s\n0.5\tfake\tfake:2\tFake Camera\n0.25\tuvcvideo\tusb-1\tOther\n' "$header" >other
run 0 "" --mode sensor -n 90 --stats other.csv --resume other
said 0
[ "$(off_key other.csv)" -ge 5 ] || fail "another camera's total is used"
[ "$(sed -n 2p other | cut -f2-)" = "$line" ] && [ "$(sed -n 3p other)" = "$(printf '0.5\tfake\tfake:2\tFake Camera')" ] &&
    [ "$(sed -n 4p other)" = "$(printf '0.25\tuvcvideo\tusb-1\tOther')" ] && [ "$(wc -l <other)" = 4 ] ||
    fail "other cameras: $(cat other)"

# a damaged file: undamaged lines are used; an empty file; a file of something else
printf '%s\n0.00102\t%s\n0.5\tfa' "$header" "$line" >torn
run 0 "torn: is damaged; what it says of this camera is used" --mode sensor -n 20 --stats torn.csv --resume torn
said 1
[ "$(off_key torn.csv)" = 0 ] || fail "torn: $(off_key torn.csv) of the first frames are not at the key"
[ "$(wc -l <torn)" = 2 ] || fail "torn is not mended: $(cat torn)"
for bad in nan 1e300 -1 0 x ''; do
    printf '%s\n%s\t%s\n' "$header" "$bad" "$line" >torn
    run 0 "torn: is damaged; it says nothing of this camera" --mode sensor -n 2 --resume torn
    said 1
done
# an endless file, also behind a link
printf '%s\n0.00102\t%s\n' "$header" "$line" >endless
truncate -s 1T endless
timeout -k 1 20 "$program" fake:real fake:flat=600 fake:light=12@1 --mode sensor -n 20 --stats endless.csv -q --resume endless \
    2>said.err </dev/null || fail "a file of a terabyte: exit $?: $(cat said.err)"
grep -q "endless: is damaged; what it says of this camera is used" said.err || fail "a terabyte: $(cat said.err)"
[ "$(off_key endless.csv)" = 0 ] && [ "$(wc -c <endless)" -lt 1000 ] || fail "a terabyte: $(wc -c <endless) bytes"
# the tail of an overlong line is not a line
{ printf '%s\n0.00102\t%s\n' "$header" "$line" && printf "%687s" "" && printf '8.5\tfake\tfake:2\tFake Camera\n'; } >long
run 0 "long: is damaged; what it says of this camera is used" --mode sensor -n 20 --resume long
[ "$(wc -l <long)" = 2 ] || fail "a line that is too long: $(cut -c 1-80 long)"
: >empty
run 0 "" --mode sensor -n 90 --resume empty
said 0
[ "$(wc -l <empty)" = 2 ] || fail "empty: $(cat empty)"
# zeros of the right size, as a loss of power may leave them
head -c 90 /dev/zero >zeros
run 0 "zeros: is damaged; it says nothing of this camera" --mode sensor -n 90 --resume zeros
said 1
[ "$(wc -l <zeros)" = 2 ] || fail "zeros: $(od -c zeros)"
printf 'a picture of a holiday\0' >holiday.jpg
cp holiday.jpg before.jpg
run 1 "holiday.jpg: was not written by --resume" --resume holiday.jpg -o out.y4m
said 1
cmp -s holiday.jpg before.jpg || fail "another file is overwritten"

# a camera that came back in other light, just before the end: its setting from before is not kept
"$program" fake:delay=3 fake:flat=600 fake:unplug=60 fake:back=1 fake:light=16@61 --reopen 5 --mode both -n 63 -q \
    --resume returned 2>said.err || fail "a camera that came back: $(cat said.err)"
[ ! -e returned ] || fail "kept of a camera that came back: $(cat returned)"

# refused before the camera is touched
run 1 "none/kept" --resume none/kept -o out.y4m
said 1
mkdir folder
run 1 "folder: is a folder" --resume folder -o out.y4m
run 1 "/dev/null: is a device" --resume /dev/null -o out.y4m
run 2 "--resume -: must be a file" --resume - -o out.y4m
run 2 "kept: named for two outputs" --resume kept --stats kept -o out.y4m
run 2 "--resume: needs an exposure that pupil controls" --resume kept --mode digital -o out.y4m
run 2 "--resume: needs an exposure that pupil controls" --resume kept --shutter 10ms --gain 2 -o out.y4m
run 1 "--resume: " fake:no-controls --resume kept -o out.y4m
[ ! -e out.y4m ] || fail "an output of a run that was refused"
[ "$(wc -l <kept)" = 2 ] || fail "a run that was refused changes what is kept: $(cat kept)"

# a setting that is not at rest is not kept
run 0 "" --mode sensor -n 3 --resume early
[ ! -e early ] || fail "a run of three frames keeps $(cat early)"

# after every kind of end
for signal in INT TERM; do
    rm -f lines kept there
    mkfifo lines
    "$program" fake:real fake:flat=600 fake:light=12@1 --resume kept --stats - >lines 2>said.err </dev/null &
    running=$!
    awk '/"sensor":"converged"/ && ++n == 15 { print >"there"; close("there") }' <lines &
    reader=$!
    tries=0
    while [ ! -e there ] && [ $tries -lt 300 ]; do sleep 0.1; tries=$((tries + 1)); done
    kill -$signal $running
    wait $running || fail "SIG$signal: exit $?"
    running=
    wait $reader
    [ "$(wc -l <kept)" = 2 ] || fail "SIG$signal does not keep it: $(cat said.err)"
done
run 1 "unplugged" fake:unplug=150 --resume unplugged
[ "$(wc -l <unplugged)" = 2 ] || fail "unplugging does not keep it"

# every minute of the camera's clock, which here runs as fast as frames are processed
"$program" fake:flat=600 -n 100000000 -q --resume minute >said.out 2>said.err </dev/null &
running=$!
tries=0
while [ ! -e minute ] && [ $tries -lt 300 ]; do sleep 0.1; tries=$((tries + 1)); done
kill -9 $running
wait $running 2>/dev/null
running=
[ "$(wc -l <minute)" = 2 ] && [ "$(head -n 1 minute)" = "$header" ] || fail "not written while it runs: $(cat said.err)"

end_test
