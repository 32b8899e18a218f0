#!/bin/sh
# pupil meter, adapt and map: the pictures and levels of one pupil replay, regardless of how an input is split: in 1, 2,
# 7 and 64 ranges, of a video, of stills, and of floats in an odd unit. Parts that are missing, duplicate, foreign or
# damaged are named. Needs $PUPIL_PROGRAM.
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg python3

# levels FILE: the columns of --stats that do not depend on the picture or on the clock.
levels() {
    python3 - "$1" <<'END'
import json, sys
keys = ("frame name time_s dt_s metered_ev adapted_ev scale white p01_ev p50_ev p99_ev key black_share clipped_share bad_share "
        "held_back_ev state reason").split()
for line in open(sys.argv[1]):
    record = json.loads(line)
    print([record[k] for k in keys])
END
}

# frames FILE...: the contents of Y4M files after their headers
frames() {
    for one in "$@"; do
        tail -n +2 "$one"
    done
}

# split NAME FRAMES RANGES ARGUMENTS...: splits the input into so many ranges; its options follow
split() {
    name=$1 total=$2 ranges=$3
    shift 3
    rm -rf parts
    mkdir parts
    i=0
    while [ $i -lt "$ranges" ]; do
        range=$((total * i / ranges))..
        [ $i = $((ranges - 1)) ] || range=$range$((total * (i + 1) / ranges))
        # An empty range is no range: more workers than frames have nothing to do.
        case $range in
        *..) : ;;
        *) [ "${range%%..*}" != "${range##*..}" ] || { i=$((i + 1)) && continue; } ;;
        esac
        call 0 "" meter "$@" --range "$range" -o "parts/$(printf %02d $i).part" -q
        echo "$range" >"parts/$(printf %02d $i).range"
        i=$((i + 1))
    done
    # In reverse order.
    call 0 "" adapt $(ls -r parts/*.part) -o parts/curves --stats parts/levels.jsonl -q
    for range in parts/*.range; do
        call 0 "" map $inputs --curves parts/curves --range "$(cat "$range")" -o "${range%.range}.y4m" -q $map_options
    done
    levels parts/levels.jsonl >parts/levels
    cmp -s parts/levels "$name.levels" || fail "$name in $ranges: other levels"
    frames parts/*.y4m | cmp -s - "$name.frames" || fail "$name in $ranges: other pictures"
}

# whole NAME ARGUMENTS...: the result of one replay
whole() {
    name=$1
    shift
    call 0 "" replay "$@" -o "$name.y4m" --stats "$name.jsonl" -q -y
    levels "$name.jsonl" >"$name.levels"
    frames "$name.y4m" >"$name.frames"
}

# A part is black, which counts for the level, as in all codes.
ffmpeg -loglevel error -f lavfi -i "testsrc2=size=96x54:rate=30:duration=1.5,hue=s=0.2,
    eq=contrast=0.6:brightness='if(between(t,0.5,1),0.25,0.05)':eval=frame,drawbox=0:0:96:14:black:fill" -pix_fmt yuv420p -c:v ffv1 clip.mkv
python3 - <<'END'
import struct
for n in range(20):
    light = 3e5 * (8 if 6 <= n < 15 else 1) # cd/m2 or so: an odd unit
    pixels = b"".join(struct.pack("<3f", *(light * (0.1 + ((x * 7 + y * 3 + n) % 50) / 25 * c) for c in (1, 0.8, 0.5)))
                      for y in range(24) for x in range(32))
    open("still_%02d.pfm" % n, "wb").write(b"PF\n32 24\n-1.0\n" + (b"\0" * len(pixels) if n < 3 else pixels))
END

inputs=clip.mkv map_options=
whole clip clip.mkv
for ranges in 1 2 7 64; do
    split clip 45 $ranges clip.mkv
done

whole stills still_*.pfm --fps 12 --tau-light 0.1
inputs=$(echo still_*.pfm) map_options="--fps 12"
for ranges in 2 7; do
    split stills 20 $ranges still_*.pfm --fps 12 --tau-light 0.1
done

# Pictures of which the data window of OpenEXR has a part, each another one.
ffmpeg -loglevel error -i clip.mkv -frames:v 8 -pix_fmt gbrpf32le part_%02d.exr
python3 - part_*.exr <<'END'
import struct, sys
for n, name in enumerate(sys.argv[1:]):
    exr = open(name, "rb").read()
    at = exr.index(b"displayWindow\0box2i\0") + 24
    open(name, "wb").write(exr[:at] + struct.pack("<4i", -12 * n, -54, 191 - 12 * n, 53) + exr[at + 16:])
END
whole parts part_*.exr --fps 12
inputs=$(echo part_*.exr) map_options="--fps 12"
split parts 8 3 part_*.exr --fps 12

# Settings that affect metering and the statistics.
for options in "--metering spot --formula 2" "--white none --highlights 0" "--tone adjust --fused" "--eye 100"; do
    whole other clip.mkv $options
    inputs=clip.mkv map_options=
    split other 45 3 clip.mkv $options
done

# Again with other settings, from the same parts.
whole again clip.mkv --tau-light 2 --ev -0.5
split clip 45 2 clip.mkv
call 0 "" adapt parts/*.part -o again.curves --tau-light 2 --ev -0.5 --stats again.parts.jsonl -q
levels again.parts.jsonl | cmp -s - again.levels || fail "other settings: other levels"
call 0 "" map clip.mkv --curves again.curves -o again.parts.y4m -q
frames again.parts.y4m | cmp -s - again.frames || fail "other settings: other pictures"

# A video whose frames come at odd times, and whose pixels are not square.
ffmpeg -loglevel error -i clip.mkv -vf "select='not(mod(n,4))+gt(n,30)',setsar=4/3" -fps_mode vfr -c:v ffv1 odd.mkv
whole odd odd.mkv
frames_there=$(wc -l <odd.jsonl)
inputs=odd.mkv map_options=
split odd "$frames_there" 1 odd.mkv
[ "$(grep -ao FRAME odd.y4m | wc -l)" -gt "$frames_there" ] || fail "no frame of odd.mkv is held"
[ "$(head -n 1 parts/00.y4m)" = "$(head -n 1 odd.y4m)" ] || fail "another header: $(head -n 1 parts/00.y4m)"
head -n 1 odd.y4m | grep -q A4:3 || fail "pixels of $(head -n 1 odd.y4m)"

# --- errors are named ---
call 0 "" meter clip.mkv --range 0..15 -o a.part -q
call 0 "" meter clip.mkv --range 15..30 -o b.part -q
call 0 "" meter clip.mkv --range 30.. -o c.part -q
call 0 "" meter clip.mkv --range 500..600 -o beyond.part -q
call 0 "" adapt a.part b.part c.part beyond.part -o curves -q
expect 1 "frames 15 to 29 are missing" adapt a.part c.part -o x -q
expect 1 "frames from 30 on are missing" adapt b.part a.part -o x -q
expect 1 "begins at frame 15, which another part has, too" adapt a.part b.part b.part c.part -o x -q
call 0 "" meter again.y4m --range 15..30 -o foreign.part -q
expect 1 "foreign.part: belongs to another input (again.y4m" adapt a.part foreign.part c.part -o x -q
call 0 "" meter clip.mkv --range 15..30 --metering spot -o spot.part -q
expect 1 "spot.part: was metered with other settings than a.part" adapt a.part spot.part c.part -o x -q
expect 1 "metering cannot be changed here" adapt a.part b.part c.part --metering spot -o x -q
expect 1 "curves: has the curves of pupil adapt, where" adapt curves -o x -q
expect 1 "a.part: has the statistics of pupil meter, where" map clip.mkv --curves a.part -o x.mkv -q
expect 1 "curves: has the curves of clip.mkv" map again.y4m --curves curves -o x.mkv -q
expect 1 "has no frame in --range: it ends at 45" map clip.mkv --curves curves --range 45.. -o x.mkv -q
expect 1 "clip.mkv: is not a file of pupil meter" adapt clip.mkv -o x -q
head -c 9000 b.part >short.part
expect 1 "short.part: is damaged" adapt a.part short.part c.part -o x -q
python3 -c 'b = bytearray(open("b.part", "rb").read()); b[-200] ^= 4; open("flipped.part", "wb").write(b)'
expect 1 "flipped.part: is damaged" adapt a.part flipped.part c.part -o x -q
# Also in the header; and in curves, before any of them is used.
for at in 48 704 780; do
    python3 -c "b = bytearray(open('b.part', 'rb').read()); b[$at] ^= 1; open('flipped.part', 'wb').write(b)"
    expect 1 "flipped.part: is damaged" adapt a.part flipped.part c.part -o x -q
done
python3 -c 'b = bytearray(open("curves", "rb").read()); b[1054] ^= 1; open("flipped.curves", "wb").write(b)'
expect 1 "flipped.curves: is damaged" map clip.mkv --curves flipped.curves --range 0..15 -o x.mkv -q
call 0 "" meter clip.mkv --range 15..30 --ev -2 -o darker.part -q
expect 1 "darker.part: was metered with other settings than a.part" adapt a.part darker.part c.part -o x -q

# An input is identified by its contents, not by its folder.
mkdir -p elsewhere
cp clip.mkv elsewhere/
call 0 "" map elsewhere/clip.mkv --curves curves --range 0..15 -o elsewhere.y4m -q
ffmpeg -loglevel error -y -i clip.mkv -vf negate -c:v ffv1 elsewhere/clip.mkv
expect 1 "curves" map elsewhere/clip.mkv --curves curves --range 0..15 -o x.mkv -q
call 0 "" meter elsewhere/clip.mkv --range 15..30 -o changed.part -q
expect 1 "changed.part: elsewhere/clip.mkv had" adapt a.part changed.part c.part -o x -q
cp still_05.pfm still_05.kept
call 0 "" meter still_*.pfm -o stills.part -q
call 0 "" adapt stills.part -o stills.curves -q
cp still_12.pfm still_05.pfm
expect 1 "frame 5, still_05.pfm, is not the picture that was metered" map still_*.pfm --curves stills.curves -o x.mkv -q
mv still_05.kept still_05.pfm

# No output replaces its own input.
cp clip.mkv own.mkv
expect 2 "own.mkv: is also an input" meter own.mkv -o own.mkv -q -y
expect 2 "a.part: is also an input" adapt a.part b.part c.part -o a.part -q -y
expect 2 "curves: is also an input" map clip.mkv --curves curves -o ./curves -q -y
expect 2 "x.jsonl: named for two outputs" adapt a.part b.part c.part -o x.jsonl --stats x.jsonl -q
expect 2 "files, not standard output" meter clip.mkv -o - -q
mkfifo pipe
expect 2 "pipe: a pipe cannot be read in parts" meter pipe -o x -q
expect 1 "pipe: is not a regular file" adapt pipe -o x -q
expect 1 "pipe: is not a regular file" map clip.mkv --curves pipe -o x.mkv -q
cmp -s own.mkv clip.mkv || fail "the input was changed"
expect 2 "A..B, frames from A on" meter clip.mkv --range 7..3 -o x -q
expect 2 "-: standard input cannot be read in parts" meter - -o x -q
expect 1 "a.part" meter clip.mkv -o a.part -q
absent x x.mkv x.jsonl

# Killed in the middle: nothing is unfinished, and the worker's range is run again.
"$program" meter clip.mkv --range 15..30 -o killed.part -q &
running=$!
kill -9 $running 2>/dev/null
wait $running 2>/dev/null
running=
call 0 "" meter clip.mkv --range 15..30 -o killed.part -y -q
cmp -s killed.part b.part || fail "metered again: another part"
absent
end_test
