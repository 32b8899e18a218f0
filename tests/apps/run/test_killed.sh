#!/bin/sh
# test_killed.sh [KILLS]: pupil run with .mp4, .mkv and --record, killed at random moments. Except for runs killed in
# their first second, each video has its name and plays; at most the recording's last second is missing; the next run of
# the same output leaves nothing unfinished. With 200 kills: tests/apps/run/test_killed.sh 200.
set -u
kills=${1:-4}
. "$(dirname "$0")/../../lib.sh"
use_fake_camera
fps=30
seed=${2:-$(date +%s)}

# play FILE: sets $had to the number of frames that can be read
play() {
    had=0
    if "${PUPIL_PROGRAM:?}" replay "$1" --stats frames.csv -q -y 2>said.err; then
        had=$(($(wc -l <frames.csv) - 1))
    else
        fail "$1 does not play: $(cat said.err)"
    fi
}

short=0 worst=0
for i in $(seq "$kills"); do
    ms=$((200 + (seed * 7919 + i * 6151) % 2800))
    delay=$((ms / 1000)).$(printf %03d $((ms % 1000)))
    rm -rf recording x.mp4 x.mkv
    "$program" fake:real fake:size=64x48 fake:fps=$fps -o x.mp4 -o x.mkv --record recording -q >said.out 2>said.err &
    running=$!
    sleep "$delay"
    kill -9 $running 2>/dev/null || fail "it had ended by itself: $(cat said.err)"
    wait $running 2>/dev/null
    running=
    recorded=0
    [ -e recording/frames.jsonl ] && recorded=$(wc -l <recording/frames.jsonl)
    for file in x.mp4 x.mkv; do
        had=0
        if [ -e $file ]; then
            play $file
        elif [ "$recorded" -gt $fps ]; then
            fail "kill $i after $delay s (seed $seed): $file is not there, $recorded frames were recorded"
        else
            short=$((short + 1))
        fi
        lost=$((recorded - had))
        [ $lost -le $fps ] || fail "kill $i after $delay s (seed $seed): $file has $had frames of $recorded"
        [ $lost -le $worst ] || worst=$lost
    done
done
"$program" fake:size=64x48 -o x.mp4 -o x.mkv -n 3 -q -y 2>said.err || fail "the next run: $(cat said.err)"
absent recording/none
echo "$kills kills: at most $worst frames of ${fps} a second were lost; $short videos were too young to have a name"
end_test
