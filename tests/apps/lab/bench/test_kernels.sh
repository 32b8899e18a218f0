#!/bin/sh
# pupil bench kernels: what it prints, that every level has the same errors, peers, worst case, plot, what is refused,
# Ctrl-C. Times are not checked.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
# fields FILE NAME...: every line of the file has every field.
fields() {
    file=$1
    shift
    [ -s "$file" ] || fail "no lines: $file"
    for field; do
        [ "$(grep -c "\"$field\":" "$file")" = "$(wc -l <"$file")" ] || fail "a line without $field: $(cat "$file")"
    done
}
# measure FORMAT SIZE ERROR_EV OFF ARGUMENTS...: every kernel has its line, and every line its fields. The bits are the
# same on every CPU level, so there is one set of errors, none above ERROR_EV (stops), one code, OFF (share).
measure() {
    format=$1 size=$2 error_ev=$3 off=$4
    shift 4
    "$program" bench kernels --format $format --size $size --rounds 2 --warm --json "$@" >lines.txt 2>noise.txt
    [ ! -s noise.txt ] || fail "on stderr: $(cat noise.txt)"
    for kernel in meter map fused exact config-default fused+white; do
        grep -q "\"kernel\":\"$kernel\",\"level\":\"scalar\",\"format\":\"$format\"" lines.txt || fail "no $kernel: $(cat lines.txt)"
    done
    fields lines.txt kernel level format out width height threads cold ns_per_px bytes_per_px ratio_read ratio_memcpy \
        error_ev error_code_max off_by_one hard_error_ev hard_error_code_max hard_off_by_one
    errors=$(grep -o '"error_ev":.*' lines.txt | sort -u)
    [ "$(echo "$errors" | wc -l)" = 1 ] || fail "levels differ in error: $errors"
    echo "$format $*: $errors"
    echo "$errors" | sed 's/"[a-z_]*"://g; s/}//' | awk -F, -v ev=$error_ev -v off=$off \
        '{ exit !($1 < ev && $2 <= 1 && $3 < off && $4 < ev && $5 <= 1 && $6 < off) }' ||
        fail "too large an error: $errors"
}
# mapped_to NAME: every kernel that maps says so.
mapped_to() {
    [ "$(grep -vc '"kernel":"meter"' lines.txt)" = "$(grep -c "\"out\":\"$1\"" lines.txt)" ] ||
        fail "not to $1: $(cat lines.txt)"
}
# has_bytes NUMBER: of a pixel, all planes.
has_bytes() {
    grep -q "\"bytes_per_px\":$1," lines.txt || fail "not $1 bytes a pixel: $(head -n 1 lines.txt)"
}

for format in rgba32f rgba16f rgb16 rgb8 grey12; do
    measure $format 67x33 1e-7 1e-4
    mapped_to rgba8
done
# light is interpolated between codes, within 7e-6 of the curve (coding.h): 1e-4 stops at light 0.1, the easy frame's
# mean
for format in yuyv nv12; do
    measure $format 67x33 1e-4 2e-3
done
for format in bayer8 bayer14 bayer10p; do
    measure $format 68x34 1e-6 1e-4
done
# light is interpolated between points without an error in the mean (make_tables.py); 2e-7 comes from so few pixels
measure p010 67x33 2e-7 2e-3 --light pq
measure i420-10 67x33 2e-7 2e-3 --light hlg
measure i444-16 67x33 2e-7 2e-3 --light pq
measure bayer14 68x34 1e-6 1e-4 --out half
mapped_to half
measure nv12 68x34 1e-4 2e-3 --out nv12 --threads 3
mapped_to nv12
has_bytes 1.5
measure bayer10p 68x34 1e-6 1e-4 --out nv12 --threads 3
has_bytes 1.25
for out in i420 rgb16f; do
    measure rgba32f 67x33 1e-7 1e-4 --out $out
    mapped_to $out
done
# of all formats, those that can be mapped to this output
"$program" bench kernels --out half --size 16x8 --rounds 1 --json >lines.txt
[ "$(grep -o '"format":"[a-z0-9]*"' lines.txt | sort -u | wc -l)" = 7 ] || fail "not the mosaics: $(cat lines.txt)"
"$program" bench kernels --format rgba32f --size 64x64 --rounds 3 --threads 2 >table.txt
grep -q "64x64, 2 threads, cold" table.txt || fail "no headline: $(cat table.txt)"
[ "$(grep -c "^rgba32f" table.txt)" -ge 5 ] || fail "no rows: $(cat table.txt)"

# other programs: each is measured, or the reason is given
"$program" bench kernels --peers --size 64x64 --rounds 2 --json >peers.txt 2>said.err
fields peers.txt kernel level format out width height threads cold ns_per_px bytes_per_px ratio_read ratio_memcpy \
    mean_code ratio_fused_scalar ratio_exact_scalar
for kernel in fused exact plain plain-fast; do
    grep -q "\"kernel\":\"$kernel\"" peers.txt || fail "no $kernel: $(cat peers.txt)"
done
for peer in opencv ffmpeg ffmpeg-min libplacebo; do
    grep -q "\"kernel\":\"$peer\"" peers.txt || grep -q "^pupil bench: $peer: .*[a-z]" said.err ||
        fail "neither $peer nor why: $(cat said.err)"
    # each one measured has a picture that is neither black nor white
    grep "\"kernel\":\"$peer\"" peers.txt | sed 's/.*"mean_code":\([^,]*\),.*/\1/' |
        awk '!($1 > 10 && $1 < 245) { exit 1 }' || fail "$peer has no picture: $(cat peers.txt)"
done
# pupil's picture and the plain loop's are the same, except for pupil's gamut handling
grep -E '"kernel":"(fused|plain)"' peers.txt | sed 's/.*"mean_code":\([^,]*\),.*/\1/' |
    awk 'NR == 1 { low = high = $1 } { low = $1 < low ? $1 : low; high = $1 > high ? $1 : high }
        END { exit !(high - low < 1) }' || fail "pictures differ: $(cat peers.txt)"
"$program" bench kernels --peers --size 64x64 --rounds 2 2>/dev/null | grep -q "^plain-fast " || fail "no plain loop"

"$program" bench kernels --worst --size 64x64 --rounds 20 --json >worst.txt
fields worst.txt frame kernel level format out width height threads frames median_us p99_us p999_us max_us \
    ratio_p999_median ratio_ordinary
"$program" bench kernels --worst --size 64x64 --rounds 20 --threads 2 >worst_table.txt
for frame in ordinary hard dark denormal nan-inf saturated default default-s fresh read; do
    grep -q "\"frame\":\"$frame\"" worst.txt || fail "no $frame: $(cat worst.txt)"
    grep -q "^$frame " worst_table.txt || fail "no $frame: $(cat worst_table.txt)"
done
# times rise from median to maximum
sed 's/.*"median_us":\([^,]*\),"p99_us":\([^,]*\),"p999_us":\([^,]*\),"max_us":\([^,]*\),.*/\1 \2 \3 \4/' worst.txt |
    awk '!($1 > 0 && $1 <= $2 && $2 <= $3 && $3 <= $4) { exit 1 }' || fail "not in order: $(cat worst.txt)"

# row correction gains: every format has its line; its frames have a wave that is found and removed
"$program" bench kernels --row-gains --size 64x64 --rounds 1 --warm --json >lamps.txt 2>noise.txt
[ ! -s noise.txt ] || fail "on stderr: $(cat noise.txt)"
fields lamps.txt level format out width height threads cold strength meter_ns_per_px map_ns_per_px frame_ns_per_px \
    of_rows_us map_gains_ns_per_px ratio_meter ratio_map ratio_all
[ "$(wc -l <lamps.txt)" = 35 ] || fail "not the 35 formats: $(cat lamps.txt)"
sed 's/.*"strength":\([^,]*\),.*/\1/' lamps.txt | awk '!($1 > 0.9) { exit 1 }' || fail "no gains: $(cat lamps.txt)"
"$program" bench kernels --row-gains --size 128x64 --rounds 2 --threads 3 --format bayer10p --out half >lamps.txt
grep -q "^bayer10p " lamps.txt || fail "no row: $(cat lamps.txt)"

if command -v gnuplot >/dev/null; then
    for kind in svg png; do
        "$program" bench kernels --plot plot.$kind --size 256x256 --rounds 2 --warm >choices.txt 2>noise.txt
        [ ! -s noise.txt ] || fail "on stderr: $(cat noise.txt)"
        [ -s plot.$kind ] || fail "no plot.$kind"
        expect 1 "plot.$kind: is there already; -y replaces it" bench kernels --plot plot.$kind
    done
    for name in "every row" "1/2 of the rows" "1/4 of the rows" "1/8 of the rows" "1/2 of the rows, striped" \
        "1/4 of the rows, striped" "1/8 of the rows, striped" fused exact "map alone" cells \
        "fused+white" "white, every pixel" "config default" "to NV12, fused+white" "half size" "quartic + cells" "8192-byte table" "104 segments" cubic quartic; do
        grep -q "^$name  " choices.txt || fail "not measured: $name: $(cat choices.txt)"
        grep -qF ">$name<" plot.svg || fail "not named: $name"
    done
    # encoders called exact are exact; approximations are off, by one code at most
    awk '/^(cells|quartic \+ cells) / && !($(NF - 1) == 0 && $NF == 0) { exit 1 }
        /^(8192|104|cubic|quartic  )/ && !($(NF - 1) > 0 && $NF == 1) { exit 1 }' choices.txt ||
        fail "errors of the encoders: $(cat choices.txt)"
    # by luma, codes are off by less than one on average; exact mapping is off by at most one, in one of a thousand
    awk '/^luma|^to NV12, luma/ { seen++; wrong += !($(NF - 1) > 0.01 && $(NF - 1) < 1) }
        !/luma/ && /(NV12|10-bit mosaic), a whole frame/ { seen++; wrong += !($(NF - 1) < 0.001 && $NF <= 1) }
        END { exit wrong || seen != 9 }' choices.txt || fail "frames of cameras: $(cat choices.txt)"
    # fewer rows give larger errors, above all with stripes; but some of each are in every frame (a fixed choice: 3.5
    # off)
    awk '/^every row/ { ok = $(NF - 1) == 0 }
        /^1.8 of the rows  / { natural = $(NF - 1) }
        /^1.8 of the rows, striped/ { exit !(ok && natural > 0 && $(NF - 1) > natural && $(NF - 1) < 3) }' choices.txt ||
        fail "stripes: $(cat choices.txt)"
    expect 1 "no/such.svg" bench kernels --plot no/such.svg
    expect 1 "plot.gif" bench kernels --plot plot.gif
fi

expect 2 "one at a time" bench kernels --peers --worst
expect 2 "take rgba32f" bench kernels --worst --format rgb8
expect 2 "one thread" bench kernels --peers --threads 2
expect 2 "--json" bench kernels --plot a.svg --json
expect 2 "rgb8 yuyv nv12" bench kernels --format rgba64f
expect 2 "--format" bench kernels --format rgb9
expect 2 "rgba8 rgb8 bgrx8 bgr8 nv12 half" bench kernels --out yuyv
expect 2 "--light" bench kernels --format rgb8 --light pq
expect 2 "not a mosaic" bench kernels --out half --format rgb8
expect 2 "rgba8" bench kernels --out nv12 --worst
expect 2 "multiple of 4" bench kernels --size 66x34 --format bayer10p
expect 2 "even height" bench kernels --size 68x33
expect 2 "at least 64x64" bench kernels --row-gains --size 64x62
expect 2 "one at a time" bench kernels --row-gains --worst
expect 2 "--size" bench kernels --size 0x5
expect 2 "--size" bench kernels --size 99999x5
expect 2 "--rounds" bench kernels --rounds 0
expect 2 "--threads" bench kernels --threads -1
expect 2 "--format" bench kernels meter
expect 2 "" bench kernels --nothing

"$program" bench kernels --rounds 10000 >cut.txt 2>cut.err &
pid=$!
sleep 1
kill -INT $pid
status=0
wait $pid || status=$?
[ "$status" = 130 ] || fail "interrupted: exit $status"
end_test
