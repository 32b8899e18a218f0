#!/bin/sh
# parallel.sh INPUT FRAMES RANGES OUT.mkv: pupil replay INPUT -o OUT.mkv by GNU parallel, in so many ranges of frames, on
# all processors of this machine ($PARALLEL may name others). What is complete is not made again: after a crash, run it
# once more. $PUPIL: the program; $OPTIONS: settings of pupil replay, such as "--ev -0.5"; $KIND: of the parts' videos
# (mkv; for y4m, OUT is a .nut, for Matroska takes no raw RGB).
set -eu
input=$1 frames=$2 ranges=$3 out=$4
pupil=${PUPIL:-pupil} kind=${KIND:-mkv}
work=$out.parts
mkdir -p "$work"
# "FIRST NEXT" a line; the last range goes on to the end.
i=0
while [ $i -lt "$ranges" ]; do
    last=$((frames * (i + 1) / ranges))
    [ $((i + 1)) -lt "$ranges" ] || last=
    printf '%06d %s..%s\n' $i $((frames * i / ranges)) $last
    i=$((i + 1))
done >"$work/ranges"

parallel --colsep ' ' --retries 5 --halt soon,fail=1 \
    "[ -e '$work/{1}.part' ] || '$pupil' meter '$input' --range {2} -o '$work/{1}.part' --threads 1 -q ${OPTIONS:-}" \
    :::: "$work/ranges"
"$pupil" adapt "$work"/*.part -o "$work/curves" -y
parallel --colsep ' ' --retries 5 --halt soon,fail=1 \
    "[ -e '$work/{1}.$kind' ] || '$pupil' map '$input' --curves '$work/curves' --range {2} -o '$work/{1}.$kind' --threads 1 -q" \
    :::: "$work/ranges"
for part in "$work"/*."$kind"; do
    echo "file '$(realpath "$part")'"
done >"$work/list"
ffmpeg -loglevel error -y -f concat -safe 0 -i "$work/list" -c copy "$work/joined.${out##*.}"
mv "$work/joined.${out##*.}" "$out"
