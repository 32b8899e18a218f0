#!/bin/sh
# pupil record, the program itself: Ctrl-C and SIGTERM end it properly, and its recording is complete.
set -eu
. "$(dirname "$0")/../../lib.sh"
use_pupil

# frames DIR: how many frames come back
frames() {
    "$program" replay "$1" -q --stats frames.csv -y || { fail "replay $1"; return; }
    tail -n +2 frames.csv | wc -l
}

# ends_by SIGNAL: five frames through a pipe that stays open, then the signal.
ends_by() {
    rm -f pipe
    mkfifo pipe
    "$program" record -q - "$1" <pipe &
    pid=$!
    exec 3>pipe
    cat five.y4m >&3
    tries=0
    until [ "$(cat "$1/frames.jsonl" 2>/dev/null | wc -l)" -ge 3 ] || [ $tries -ge 300 ]; do
        sleep 0.1
        tries=$((tries + 1))
    done
    kill "-$1" $pid
    ended=0
    wait $pid || ended=$?
    exec 3>&-
    [ $ended = 0 ] || fail "SIG$1 ends it with $ended"
    [ "$(frames "$1")" = "$(wc -l <"$1/frames.jsonl")" ] || fail "SIG$1: not every line has its frame"
}

"$program" replay synth:walk --size 64x48 -n 5 -q -o five.y4m
ends_by INT
ends_by TERM

# A source's metadata comes back unchanged, with the same statistics.
"$program" record -q synth:walk --width 64 --height 48 -n 7 walk
"$program" replay synth:walk --size 64x48 -n 7 -q --stats a.csv
"$program" replay walk -q --stats b.csv
for f in a b; do # without the names and the times that it took
    cut -d, -f1,3-18,22 "$f.csv" >"$f.txt"
done
cmp a.txt b.txt || fail "a recording replays to other statistics"

"$program" replay walk five.y4m -q -o - >said 2>&1 && fail "two inputs, one a recording"
grep -q 'a recording must be the only input' said || fail "$(cat said)"
# the recording being read is not replaced
cp -r walk before
for input in walk walk/frames.mkv ./walk/; do
    status=0
    "$program" record "$input" walk -y -q 2>said || status=$?
    [ $status = 2 ] && grep -q 'walk: is also an input, and would be replaced' said || fail "$input: $status, $(cat said)"
done
diff -r before walk || fail "a recording that was an input is changed"
"$program" record walk other -q
"$program" record walk other -y -q || fail "another recording is not replaced"

"$program" record walk/frames.mkv -q 2>said && fail "a file alone is recorded"
grep -q 'walk/frames.mkv: is a file; to record it, name a folder behind it' said || fail "a file alone: $(cat said)"

"$program" help record | grep -q '^usage: pupil record' || fail "no help"
end_test
