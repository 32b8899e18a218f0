#!/bin/sh
# For test_damaged_*.sh: $each damaged clips of each of H.264, HEVC, VP9, AV1, decoded by ffmpeg, which prints libav's
# complaints, and by pupil. Each clip with a complaint must be named, and its damage counted; undamaged clips must give
# all of their frames without a message.
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg

# make FILE ENCODER...: 50 frames
make() {
    to=$1
    shift
    ffmpeg -v error -nostdin -f lavfi -i testsrc2=s=160x96:r=25:d=2 -pix_fmt yuv420p -c:v "$@" "$to" 2>said.err &&
        [ -s "$to" ]
}
make h264.mkv libx264 -g 25 -x264-params slices=2 && make hevc.mp4 libx265 -x265-params log-level=none:keyint=25 &&
    make vp9.webm libvpx-vp9 -deadline realtime -cpu-used 8 && make av1.mkv libsvtav1 -preset 12 2>said.err ||
    skip "this ffmpeg has not all of libx264, libx265, libvpx-vp9, libsvtav1: $(cat said.err)"

# damage FILE SEED COUNT: so many bytes of the middle three quarters
damage() {
    awk -v size="$(wc -c <"$1")" -v seed="$2" -v count="$3" 'BEGIN {
        srand(seed)
        while (count--) print int(size / 8 + rand() * size * 3 / 4), sprintf("%03o", 1 + int(rand() * 255))
    }' | while read -r at value; do
        # shellcheck disable=SC2059 # an octal escape
        printf "\\$value" | dd of="$1" bs=1 seek="$at" conv=notrunc status=none
    done
}

complained=0 noticed=0 counted=0
for clip in h264.mkv hevc.mp4 vp9.webm av1.mkv; do
    expect 0 "" replay $clip -q --stats whole.csv
    [ "$(wc -l <whole.csv)" = 51 ] || fail "$clip: $(($(wc -l <whole.csv) - 1)) of 50 frames"
    [ ! -s said.err ] || fail "$clip is whole: $(cat said.err)"
    rm -f whole.csv
    seed=0
    while [ $seed -lt "$each" ]; do
        seed=$((seed + 1))
        bad=$seed-$clip
        cp $clip "$bad" && damage "$bad" $seed $((8 + 2 * seed))
        # The remarks of its muxer are not about the clip.
        complaint=$(ffmpeg -v error -nostdin -threads 1 -i "$bad" -map 0:v -f null - 2>&1 | grep -v '^\[null' | head -n 1)
        got=0
        "$program" replay "$bad" -q --keep-going --stats got.csv 2>said.err </dev/null || got=$?
        [ $got = 0 ] || noticed=$((noticed + 1))
        if [ -n "$complaint" ]; then
            complained=$((complained + 1))
            [ $got = 3 ] || [ $got = 1 ] || fail "$bad: silent (exit $got), where libav says $complaint"
            grep -qF "$bad: " said.err || fail "$bad is not named: $(cat said.err)"
        fi
        if [ $got = 3 ]; then
            # A damaged container may hide any number of frames behind one sentence.
            skipped=$(grep -c '; skipped$' said.err)
            frames=$(($(wc -l <got.csv) - 1))
            [ "$skipped" -gt 0 ] && [ "$frames" -gt 0 ] && [ "$frames" -lt 50 ] || fail "$bad: $frames frames and $skipped skipped, of 50"
            counted=$((counted + skipped))
            got=0
            "$program" replay "$bad" -q --stats none.csv 2>said.err </dev/null || got=$?
            [ $got = 1 ] || fail "$bad: without --keep-going exit $got"
            [ ! -e none.csv ] || fail "$bad: an output of a run that failed"
        fi
        rm -f "$bad" got.csv
    done
done
echo "libav complains of $complained of $((4 * each)) damaged clips, pupil of $noticed; $counted frames skipped"
[ $complained -ge $((2 * each)) ] || fail "too few complaints"
end_test
