#!/bin/sh
# run_guest.sh NODE PUPIL: in the guest of vm.run, after capture_guest.sh loaded vivid: the program as a user sees it,
# on the kernel's drivers. NODE: node_command.c.
set -u
node=$1
pupil=$2
cd "$TMPDIR" || exit 1
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# run STATUS WORDS ARGUMENTS...: the exit status, and words that standard error must hold
run() {
    status=$1 words=$2
    shift 2
    timeout 60 "$pupil" "$@" >said.out 2>said.err </dev/null
    got=$?
    [ "$got" = "$status" ] || fail "pupil $*: exit $got, expected $status: $(cat said.err)"
    [ -z "$words" ] || grep -qF -- "$words" said.err || fail "pupil $*: no '$words' in: $(cat said.err)"
}

# until_lines N FILE: waits, for a minute at most
until_lines() {
    for _ in $(seq 600); do
        [ ! -e "$2" ] || [ "$(wc -l <"$2")" -lt "$1" ] || return 0
        sleep 0.1
    done
    fail "$2 has no $1 lines after a minute"
}

# column NAME FILE.csv: its values
column() {
    awk -F, -v name="$1" '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) n = i; next } { print $n }' "$2"
}
rows() { tail -n +2 "$1" | wc -l; }

webcam=$("$node" find vivid capture 1)
hdmi=$("$node" find vivid capture 0)
monitor=$("$node" find vivid output 0)

# what there is
run 0 "" list
grep -q "^$webcam .*vivid" said.out || fail "list: $(cat said.out)"
run 0 "" list --json
grep -q '"YUYV"' said.out || fail "list --json has no YUYV"

# modes: vivid has no exposure control: a sentence if one is needed
frames="--width 320 --height 180 --framerate 60 -q"
# Unquoted on purpose.
run 0 "" run -d "$webcam" $frames -n 10 --stats plain.csv
run 0 "" run -d "$webcam" $frames --mode digital -n 10 --stats digital.csv -o digital.y4m
for file in plain digital; do
    [ "$(rows $file.csv)" = 10 ] || fail "$file: $(rows $file.csv) records of 10 frames"
done
[ "$(wc -c <digital.y4m)" -gt $((10 * 320 * 180 * 3)) ] || fail "digital.y4m is too short"
run 1 "its exposure time cannot be set" run -d "$webcam" $frames --mode sensor -n 10

# a recording, replayed: the same statistics, bit for bit; with a clock in the picture, so that no two frames are alike
"$node" set "$webcam" "OSD Text Mode" 0 || fail "the clock"
for format in YUYV; do
    run 0 "" run -d "$webcam" $frames --mode digital --format $format -n 12 --record rec.$format -y --stats live.csv \
        --white-balance off
    run 0 "" replay rec.$format -q --stats again.csv -y
    for name in frame metered_ev adapted_ev scale; do
        column $name live.csv >a
        column $name again.csv >b
        cmp -s a b || fail "$format: the recording's $name is not the live run's: $(paste a b | head -n 3)"
    done
    [ "$(column metered_ev live.csv | sort -u | wc -l)" -gt 3 ] || fail "$format: the frames are all alike"
done

# killed while it records: what was written is usable
"$pupil" run -d "$webcam" $frames --mode digital --record rec.killed --stats killed.jsonl >said.out 2>&1 &
runner=$!
until_lines 10 rec.killed/frames.jsonl
kill -9 $runner
wait $runner 2>/dev/null
run 0 "" replay rec.killed -q --stats again.csv -y
[ "$(rows again.csv)" -gt 5 ] || fail "killed: $(rows again.csv) frames are in the recording"
[ "$(rows again.csv)" -le "$(wc -l <rec.killed/frames.jsonl)" ] || fail "killed: frames without a line"

"$node" set "$webcam" "OSD Text Mode" 2 || fail "the camera's text"
# into an output node that another reader reads: a still picture, the same codes as a file without dither
"$node" set "$webcam" "Test Pattern" 1 || fail "bars"
for end in "$hdmi" "$monitor"; do
    [ "$end" = "$monitor" ] || "$node" input "$end" 3 || fail "HDMI"
    "$node" timings "$end" 640 480 60 || fail "timings"
done
"$node" cable "$hdmi" || fail "the cable"
"$node" format "$monitor" RGB3 640 480 || fail "the monitor's format"
still="--width 640 --height 480 --framerate 25 --mode digital --lock -q"
run 0 "" run -d "$webcam" $still -n 1 -o one.png -y
run 0 "" replay one.png -q --stats file.csv -y
"$pupil" run -d "$webcam" $still --dither off -o "$monitor" --stats - >wrote.jsonl 2>out.said &
writer=$!
until_lines 3 wrote.jsonl
run 0 "" run -d "$hdmi" --mode digital --format RGB3 -n 4 -q --stats screen.csv
[ "$(column metered_ev screen.csv | sort -u)" = "$(column metered_ev file.csv)" ] ||
    fail "the monitor shows $(column metered_ev screen.csv | sort -u), the file has $(column metered_ev file.csv)"
kill -TERM $writer
wait $writer || fail "the writer: exit $?: $(cat out.said)"
run 1 "takes frames of 640x480, not of 320x180" run -d "$webcam" $frames --mode digital -n 3 -o "$monitor"

# unplugged in the middle: a sentence, and a recording with every delivered frame
"$pupil" run -d "$webcam" $frames --mode digital --record rec.gone --stats gone.csv >said.err 2>&1 &
runner=$!
until_lines 10 rec.gone/frames.jsonl
echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind
wait $runner && fail "unplugged: exit 0"
grep -q "the camera was unplugged" said.err || fail "unplugged: $(cat said.err)"
run 0 "" replay rec.gone -q --stats again.csv -y
column metered_ev gone.csv >a
column metered_ev again.csv >b
[ "$(rows gone.csv)" -gt 5 ] && cmp -s a b || fail "unplugged: $(rows gone.csv) frames came, $(rows again.csv) are recorded"

echo "$failures failures"
[ "$failures" = 0 ]
