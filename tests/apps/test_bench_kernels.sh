#!/bin/sh
# pupil bench kernels: what it prints, that every level has the same errors, what is refused, Ctrl-C.
set -eu
program=${PUPIL_PROGRAM:?}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "FAILED: $*"; exit 1; }
# expect STATUS WORDS ARGUMENTS...: the exit status, and words of the one sentence on stderr.
expect() {
    wanted=$1 words=$2
    shift 2
    status=0
    "$program" bench kernels "$@" >said.out 2>said.err </dev/null || status=$?
    [ "$status" = "$wanted" ] || fail "bench kernels $*: exit $status, expected $wanted: $(cat said.err)"
    grep -qF -- "$words" said.err || fail "bench kernels $*: said '$(cat said.err)', expected '$words'"
}

for format in rgba32f rgb32f rgba16f rgba16 rgb16 rgba8 rgb8; do
    "$program" bench kernels --format $format --size 67x33 --rounds 3 --warm --json >lines.txt 2>noise.txt
    [ ! -s noise.txt ] || fail "on stderr: $(cat noise.txt)"
    for kernel in meter map fused exact default; do
        grep -q "\"kernel\":\"$kernel\",\"level\":\"scalar\",\"format\":\"$format\"" lines.txt || fail "no $kernel: $(cat lines.txt)"
    done
    # the bits are the same on every level, and so the errors are: one set of figures, and small
    errors=$(grep -o '"error_ev":.*' lines.txt | sort -u)
    [ "$(echo "$errors" | wc -l)" = 1 ] || fail "levels differ in error: $errors"
    echo "$format: $errors"
    echo "$errors" | sed 's/"[a-z_]*"://g; s/}//' | awk -F, '{ exit !($1 < 1e-7 && $2 <= 1 && $3 < 1e-4 && $4 < 1e-7 && $5 <= 1 && $6 < 1e-4) }' ||
        fail "too large an error: $errors"
done
"$program" bench kernels --format rgba32f --size 64x64 --rounds 3 --threads 2 >table.txt
grep -q "64x64, 2 threads, cold" table.txt || fail "no headline: $(cat table.txt)"
[ "$(grep -c "^rgba32f" table.txt)" -ge 5 ] || fail "no rows: $(cat table.txt)"
"$program" bench kernels --format rgba32f --size 64x64 --rounds 3 | grep -q "^rgba32f *plain-fast" || fail "no plain loop"

expect 2 "--format" --format rgba64f
expect 2 "--size" --size 0x5
expect 2 "--size" --size 99999x5
expect 2 "--rounds" --rounds 0
expect 2 "--threads" --threads -1
expect 2 "--format" meter
expect 2 "" --nothing

"$program" bench kernels --rounds 10000 >cut.txt 2>cut.err &
pid=$!
sleep 1
kill -INT $pid
status=0
wait $pid || status=$?
[ "$status" = 130 ] || fail "interrupted: exit $status"
