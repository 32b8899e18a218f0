#!/bin/sh
# pupil run on raw frames in coloured light: the picture is grey or not, as requested; recorded frames keep the balance
# that they were shown with. Needs $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera

# shown NAME ARGUMENTS...: the last of 60 frames of a grey scene in reddish light, as "Y Cb Cr" of its last pixel
shown() {
    name=$1
    shift
    "$program" fake:format=RG10 fake:flat=512 fake:colour=1.2,0.6,0.9 "$@" -n 60 -o "$name.y4m" -q -y >said.out 2>said.err ||
        fail "$name: $(cat said.err)"
    # a YUV4MPEG2 file of C444 ends with the last frame's three planes
    for plane in 3 2 1; do
        tail -c $((64 * 48 * (plane - 1) + 1)) "$name.y4m" | head -c 1 | od -A n -t u1
    done | tr -s ' \n' ' '
}

# grey is Cb and Cr of 128; red is a larger Cr
for balance in "" "--white-balance auto" "--white-balance 1,2,1.33333"; do
    # unquoted on purpose
    got=$(shown grey $balance)
    case $got in
    *" 128 128 ") ;;
    *) fail "'$balance' shows $got" ;;
    esac
done
for balance in "--white-balance off" "--white-balance 1,1,1"; do
    set -- $(shown red $balance)
    [ "$3" -gt 135 ] || fail "'$balance' shows $*, which is not red"
done
set -- $(shown matrix --white-balance off --matrix 0,0,1,0,0,1,0,0,1)
[ "$2 $3" = "128 128" ] || fail "a matrix that makes all of blue: $*"
set -- $(shown black --mode digital --white-balance 1,2,1.33333 --black-level 1022)
[ "$*" = "16 128 128" ] || fail "all is below black: $*"

# BT.2020 is more saturated in BT.709; a replay of its recording has the same statistics
wide() {
    "$program" fake:format=NV12 fake:bt2020 fake:flat=120 fake:colour=1.2,0.8,0.8 --mode digital "$@" -y -n 20 -o wide.y4m \
        --stats wide.csv -q >said.out 2>said.err || fail "BT.2020, $*: $(cat said.err)"
    tail -c 1 wide.y4m | od -A n -t u1
}
kept=$(wide --output-primaries input) converted=$(wide --record wide)
[ "$converted" -gt "$kept" ] || fail "Cr of BT.2020 is $kept as it is, and $converted in BT.709"
grep -q '"primaries":[[:space:]]*"bt2020"' wide/recording.json || fail "a recording does not say BT.2020"
if [ -n "${PUPIL_PROGRAM:-}" ]; then
    "$PUPIL_PROGRAM" replay wide --stats replay.csv -q -y -o replay.y4m 2>said.err || fail "BT.2020: $(cat said.err)"
    cut -d, -f3-6 wide.csv >wide.cut
    cut -d, -f3-6 replay.csv >replay.cut
    cmp -s wide.cut replay.cut || fail "a recording of BT.2020 replays to other statistics"
    rm -f replay.csv
fi

for mode in digital sensor both; do
    "$program" fake:real fake:format=BG12 fake:colour=0.7,1,0.5 fake:light=3@20 --mode $mode -n 60 --record "$mode" \
        --stats "$mode.csv" -q -y >said.out 2>said.err || fail "$mode: $(cat said.err)"
    [ "$(grep -c '"balance":\[' "$mode/frames.jsonl")" = 59 ] || fail "$mode: the frames have no balance of their own"
    [ -n "${PUPIL_PROGRAM:-}" ] || continue
    "$PUPIL_PROGRAM" replay "$mode" --stats replay.csv -q -y 2>said.err || fail "$mode: $(cat said.err)"
    for file in "$mode" replay; do # what was metered and adapted to; what is shown of mode sensor is the camera's own
        cut -d, -f1,3-6,9-11,14-16 "$file.csv" | tr -d '\r' >"$file.cut"
    done
    cmp -s "$mode.cut" replay.cut || fail "$mode: a recording replays to other statistics"
    rm -f replay.csv
done

# no effect with this format: a sentence, and nothing is written
for given in "--white-balance 2,1,2" "--matrix 1,0,0,0,1,0,0,0,1" "--black-level 64"; do
    # shellcheck disable=SC2086 # words
    call 1 "" fake:format=YUYV $given -n 5 -o useless.y4m -q -y
    grep -qF -- "(${given%% *}" said.err || grep -qF -- "and ${given%% *}" said.err || fail "$given of YUYV: $(cat said.err)"
    [ ! -e useless.y4m ] || fail "$given of YUYV: an output is there"
done
"$program" fake:format=GREY --black-level 16 -n 5 -q >said.out 2>said.err || fail "a black level of grey: $(cat said.err)"

# refused WORDS ARGUMENTS...: usage, a sentence, and nothing is written
refused() {
    words=$1
    shift
    "$program" fake:format=RG10 "$@" -n 3 -o refused.y4m >said.out 2>said.err && fail "$* is taken"
    grep -qF -- "$words" said.err || fail "$*: $(cat said.err)"
    [ ! -e refused.y4m ] || fail "$* leaves a file"
}
refused "--white-balance warm: must be auto, off, or factors" --white-balance warm
refused "--matrix 1,2: must be auto, off, or 9 numbers" --matrix 1,2
refused "--black-level x: must be auto, off, or the code" --black-level x
refused "black must be at least 1 below the format's largest code" --black-level 1023

end_test
