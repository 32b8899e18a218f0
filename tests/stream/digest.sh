#!/bin/sh
# digest.sh EXPECTED COMMAND...: runs the digest program and compares what it prints with the committed lines.
set -eu
expected=$1
shift
actual=$(mktemp)
trap 'rm -f "$actual"' EXIT
"$@" >"$actual" || {
    echo "digest.sh: $* failed after these lines:"
    tail -n 3 "$actual"
    exit 1
}
if ! diff "$expected" "$actual" >"$actual.diff"; then
    echo "digest.sh: other bits than $expected ($(grep -c '^>' "$actual.diff") lines of $(wc -l <"$expected")):"
    head -n 20 "$actual.diff"
    rm -f "$actual.diff"
    exit 1
fi
rm -f "$actual.diff"
echo "$(wc -l <"$actual") digests, all as committed"
