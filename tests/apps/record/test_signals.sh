#!/bin/sh
# pupil record, the program itself: Ctrl-C and SIGTERM end it as it should end, and what it wrote is whole.
set -eu
pupil=$PUPIL_PROGRAM
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

fail() {
    echo "FAILED: $*"
    status=1
}

# frames DIR: how many frames come back
frames() {
    "$pupil" replay "$1" -q --stats "$work/frames.csv" || { fail "replay $1"; return; }
    tail -n +2 "$work/frames.csv" | wc -l
}

# ends_by SIGNAL: five frames through a pipe that stays open, then the signal.
ends_by() {
    rm -f "$work/pipe"
    mkfifo "$work/pipe"
    "$pupil" record -q - "$work/$1" <"$work/pipe" &
    pid=$!
    exec 3>"$work/pipe"
    cat "$work/five.y4m" >&3
    tries=0
    until [ "$(cat "$work/$1/frames.jsonl" 2>/dev/null | wc -l)" -ge 3 ] || [ $tries -ge 300 ]; do
        sleep 0.1
        tries=$((tries + 1))
    done
    kill "-$1" $pid
    ended=0
    wait $pid || ended=$?
    exec 3>&-
    [ $ended = 0 ] || fail "SIG$1 ends it with $ended"
    [ "$(frames "$work/$1")" = "$(wc -l <"$work/$1/frames.jsonl")" ] || fail "SIG$1: not every line has its frame"
}

"$pupil" replay synth:walk --size 64x48 -n 5 -q -o "$work/five.y4m"
ends_by INT
ends_by TERM

# What a source says comes back as it was, and the same statistics with it.
"$pupil" record -q synth:walk --width 64 --height 48 -n 7 "$work/walk"
"$pupil" replay synth:walk --size 64x48 -n 7 -q --stats "$work/a.csv"
"$pupil" replay "$work/walk" -q --stats "$work/b.csv"
for f in a b; do # without the names and the times that it took
    cut -d, -f1,3-18,22 "$work/$f.csv" >"$work/$f.txt"
done
cmp "$work/a.txt" "$work/b.txt" || fail "a recording replays to other statistics"

"$pupil" replay "$work/walk" "$work/five.y4m" -q -o - >"$work/said" 2>&1 && fail "two inputs, one a recording"
grep -q 'a recording must be the only input' "$work/said" || fail "$(cat "$work/said")"
"$pupil" help record | grep -q '^usage: pupil record' || fail "no help"
exit $status
