#!/bin/sh
# Options that choose frames; options without effect on an input are refused.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil

walk="replay synth:walk --size 32x18 -q"
column() { awk -F, -v name="$1" '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) n = i; next } { print $n }' "$2"; }

# trimming: only the frames of that time, where adaptation begins
# shellcheck disable=SC2086 # words
"$program" $walk --fps 25 -n 100 -o clip.mkv --stats all.csv || fail "a clip"
for how in "-ss 1 -t 0.4" "--ss 1s --duration 400ms"; do
    # shellcheck disable=SC2086
    expect 0 "" replay clip.mkv -q $how --stats part.csv -y
    [ "$(column time_s part.csv | awk '{ printf "%.2f ", $1 }')" = "1.00 1.04 1.08 1.12 1.16 1.20 1.24 1.28 1.32 1.36 " ] ||
        fail "$how: $(column time_s part.csv | tr '\n' ' ')"
    [ "$(column state part.csv | head -n 1)" = settled ] || fail "$how: adaptation does not begin there"
done
expect 0 "" replay clip.mkv -q -ss 3.9 --stats end.csv
[ "$(column time_s end.csv | wc -l)" -le 3 ] || fail "-ss 3.9: $(column time_s end.csv)"
expect 1 "no frame in the time" replay clip.mkv -q -ss 60 --stats none.csv
expect 2 "--ss" replay clip.mkv -ss -1
expect 2 "--duration" replay clip.mkv -t 0
expect 2 "--hold: gives frames other times" replay clip.mkv -t 1 --hold 2
absent none.csv

# the sound is cut with it
if command -v ffmpeg >/dev/null && ffmpeg -v error -nostdin -i clip.mkv -f lavfi -i "sine=d=4" -c:v copy -c:a aac -shortest sound.mp4 2>said.err; then
    expect 0 "" replay sound.mp4 -q -ss 2 -t 1 -o cut.mkv
    lasts=$(ffprobe -v error -select_streams a -show_entries packet=pts_time -of csv=p=0 cut.mkv | tail -n 1)
    awk -v l="$lasts" 'BEGIN { exit !(l > 0.9 && l < 1.05) }' || fail "the sound of a second ends at $lasts"
fi

# options that do not apply to this input
"$program" $walk -n 2 -o still || fail "stills"
expect 1 "--fps: the frames of clip.mkv have times of their own (25 frames a second)" replay clip.mkv --fps 30
expect 1 "--size: the frames of clip.mkv have a size of their own" replay clip.mkv --size 10x10
expect 1 "--size: the frames of still have a size of their own" replay still --size 10x10
expect 1 "--seed: sets the path of pan:" replay still --seed 3
expect 0 "" replay still -q --fps 5 --stats still.csv
[ "$(column time_s still.csv | tail -n 1)" = 0.20000000000000001 ] || fail "--fps of stills: $(column time_s still.csv)"
expect 2 "--tau-dark: belongs to the default law" replay still --law 2 --tau-dark 1
expect 2 "--weight: is how much each new frame counts" replay still --weight 0.1

# two names of the same option
for law in 1 2 3 4; do
    "$program" $walk -n 30 --law $law -o law.y4m -y && "$program" $walk -n 30 --formula $law -o formula.y4m -y || fail "law $law"
    cmp -s law.y4m formula.y4m || fail "--law $law is not --formula $law"
done
"$program" $walk -n 30 --law seconds -o law.y4m -y && "$program" $walk -n 30 -o formula.y4m -y && cmp -s law.y4m formula.y4m ||
    fail "--law seconds is not the default"

# a sequence as other programs name it
expect 1 "a sequence is a pattern in quotes" replay 'seq.%04d.exr'
expect 1 "are read as raw:d.raw,format=RG10,size=4x4" replay d.raw,format=RG10,size=4x4

end_test
