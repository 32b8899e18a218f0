#!/bin/sh
# pupil bench gles: what it prints at a small size, that its errors are within the limits of gpu.md, what is refused,
# Ctrl-C. Times are not checked. Needs an OpenGL ES driver; software is enough.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil
"$program" bench gles --size 64x32 --rounds 2 --frames 2 --json >lines.txt 2>said.err ||
    { grep -q "^pupil bench" said.err && skip "$(cat said.err)"; }
[ ! -s said.err ] || fail "on stderr: $(cat said.err)"
for format in rgba32f rgba16f nv12 bayer10; do
    for part in copy upload meter map frame; do
        grep "\"part\":\"$part\",\"format\":\"$format\",\"width\":64,\"height\":32," lines.txt >line.txt ||
            fail "no $part of $format: $(cat lines.txt)"
        grep -q '"gpu_ms":[0-9.]*,"gpu_ratio_copy":[0-9.]*' line.txt || fail "no time: $(cat line.txt)"
        [ $part = upload ] || grep -q '"cpu_ms":[0-9.]*,"cpu_ratio_memcpy":[0-9.]*,"ratio_cpu":[0-9.]*' line.txt ||
            fail "no time of the CPU: $(cat line.txt)"
    done
done
grep -q 'nan\|inf' lines.txt && fail "a number that is none: $(cat lines.txt)"
# mapping and metering agree with the CPU: within 1e-5, one code, one sample of 10,000 (of 6144: none)
[ "$(grep -c '"log_average_error":' lines.txt)" = 8 ] && [ "$(grep -c '"code_max":' lines.txt)" = 8 ] ||
    fail "errors are missing: $(cat lines.txt)"
sed -n 's/.*"log_average_error":\([^,}]*\).*/\1/p' lines.txt | awk '!($1 < 1e-5) { exit 1 }' || fail "log-averages"
sed -n 's/.*"code_max":\([^,]*\),"off_by_one":\([^}]*\)}.*/\1 \2/p' lines.txt |
    awk '!($1 <= 1 && $2 <= 1e-4) { exit 1 }' || fail "pictures: $(cat lines.txt)"

"$program" bench gles --size 32x16 --rounds 1 --frames 5 --format rgb8 >table.txt 2>said.err || fail "$(cat said.err)"
[ "$(grep -c '^rgb8 ' table.txt)" -ge 5 ] || fail "no rows: $(cat table.txt)"
if grep -qE '"renderer":"(llvmpipe|softpipe)' lines.txt; then
    grep -q "^no GPU: this is .*, a software renderer$" table.txt || fail "no warning: $(cat table.txt)"
    grep -q '"software":true' lines.txt || fail "no warning: $(cat lines.txt)"
fi
"$program" bench gles --size 32x16 --rounds 1 --format rgba16f --gles-version 3.0 --json >old.txt || fail "ES 3.0"
grep -q '"gles_version":3.0' old.txt || fail "not ES 3.0: $(cat old.txt)"
grep -q '"part":"histogram"' old.txt || fail "no histogram in ES 3.0: $(cat old.txt)"

"$program" bench gles --help >help.txt
[ "$(wc -l <help.txt)" -le 24 ] || fail "--help is $(wc -l <help.txt) lines"
expect 2 "rgb10a2 i444-16" bench gles --format moon
expect 2 "--size" bench gles --size 0x5
expect 2 "--size" bench gles --size 66x33
expect 2 "--frames" bench gles --frames 0
expect 2 "--rounds" bench gles --rounds -1
expect 2 "3.0 or 3.1" bench gles --gles-version 2.0
expect 2 "--format" bench gles rgba8
expect 2 "" bench gles --nothing

"$program" bench gles --rounds 10000 --size 64x32 >cut.txt 2>cut.err &
pid=$!
sleep 1
kill -INT $pid
status=0
wait $pid || status=$?
[ "$status" = 130 ] || fail "interrupted: exit $status: $(cat cut.err)"
echo "bench gles: all as expected"
end_test
