#!/bin/sh
# test_sweep.sh ARGUMENTS OF sweep.py...: an interrupted sweep continues where it stopped.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
kept=$work/kept

# sweep STATUS OPTIONS...: of one command's allocations
sweep() {
    expected=$1
    shift
    status=0
    "$@" >"$work/log" 2>&1 || status=$?
    case $status in 76 | 77) cat "$work/log" && exit $status ;; esac
    [ "$status" = "$expected" ] || { echo "exit $status, not $expected: $*" && cat "$work/log" && exit 1; }
}
fail() { echo "test_sweep.sh: $1" && cat "$work/log" && exit 1; }

set -- sh "$here/sweep.sh" "$@" --case sim --call malloc --jobs 1 --kept "$kept"
sweep 3 "$@" --seconds 0
[ ! -s "$kept" ] || fail "a call was failed without any time"
sweep 3 "$@" --seconds 1.5
first=$(wc -l <"$kept")
# Ctrl-C during the first call
"$@" >"$work/log" 2>&1 &
running=$!
tries=0
while [ "$(wc -l <"$kept")" = "$first" ] && [ $tries -lt 600 ]; do sleep 0.1; tries=$((tries + 1)); done
kill -TERM $running
status=0
wait $running || status=$?
[ "$status" = 3 ] && grep -q "not all were swept" "$work/log" || fail "ended: exit $status"
some=$(wc -l <"$kept")
printf '["sim", "mall' >>"$kept" # an incomplete line
sweep 0 "$@"
all=$(wc -l <"$kept")
[ "$some" -gt "$first" ] && [ "$all" -gt "$some" ] || fail "$first, $some, then $all verdicts"
grep -q "^$all calls failed, 0 faults" "$work/log" || fail "the sum is not $all"
[ "$(cut -d, -f3 "$kept" | sort | uniq -d)" = "" ] || fail "a call was swept twice"
# earlier results are kept
sed -i '3s/"refused"\|null/"a fault"/' "$kept"
sweep 1 "$@"
[ "$(wc -l <"$kept")" = "$all" ] && grep -q "FAILED: malloc .*: a fault" "$work/log" || fail "a fault is forgotten"
echo "$first, then $some, then all $all verdicts"
