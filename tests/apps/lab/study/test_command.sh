#!/bin/sh
# `pupil study` as its user meets it: sentences, exit codes, files complete or absent. Needs $PUPIL_PROGRAM; runs in a
# folder of its own.
set -u
program=${PUPIL_PROGRAM:?the pupil program}
room=$(mktemp -d) || exit 1
trap 'rm -rf "$room"' EXIT
cd "$room" || exit 1
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# expect STATUS WORDS ARGUMENTS...: the exit status, and words that the one sentence must hold
expect() {
    status=$1 words=$2
    shift 2
    "$program" study "$@" >said.out 2>said.err </dev/null
    got=$?
    [ "$got" = "$status" ] || fail "pupil study $*: exit $got, expected $status: $(cat said.err)"
    [ -z "$words" ] || grep -qF -- "$words" said.err || fail "pupil study $*: no '$words' in: $(cat said.err)"
    [ "$(wc -l <said.err)" -le 1 ] || fail "pupil study $*: more than one sentence: $(cat said.err)"
}

"$program" study --help >help.txt || fail "--help does not exit 0"
[ "$(wc -l <help.txt)" -le 40 ] || fail "--help is $(wc -l <help.txt) lines"
awk 'length > 90 { exit 1 }' help.txt || fail "--help has a line over 90 characters"

expect 2 "--sizes" spheres --sizes 10x10
for bad in "--size 0x4" "--size 64" "--size 5000x5" "--threads 999" "--threads x" "--video 5,1" "--video 1,0" "--video 1"; do
    # shellcheck disable=SC2086 # two words
    expect 2 "${bad%% *}" spheres --out out $bad
done
expect 2 "--out" spheres --video 1,1
expect 2 "one scene" spheres room
expect 2 "--regression" --regression table.csv --out out
expect 1 "table.csv" --regression table.csv
echo "1,1,0.005,600" >table.csv
expect 1 "table.csv: line 1" --regression table.csv
expect 1 "nosuch" nosuch.scene
expect 1 "there/out" spheres --size 8x8 --out there/out
[ ! -e out ] || fail "a refused study made its folder"
echo text >file
expect 1 "file" spheres --size 8x8 --out file

# a study
if ! command -v gnuplot >/dev/null; then
    expect 1 "gnuplot" spheres --size 8x8 --out out
    [ ! -e out ] || fail "a refused study left its folder"
    [ "$failures" = 0 ]
    exit
fi
expect 0 "" spheres --size 48x40 --out out --check
[ "$(grep -c ' 0 of .* violate' said.out)" = 11 ] || fail "not eleven tests without violations: $(cat said.out)"
[ "$(wc -l <out/study.csv)" = 1281 ] || fail "study.csv has $(wc -l <out/study.csv) lines"
[ "$(grep -c '^## Case' out/study.md)" = 16 ] || fail "study.md has not sixteen tables"
[ "$(grep -c '<h2>Case' out/study.html)" = 16 ] || fail "study.html has not sixteen tables"
for case in 1 2 3 4; do
    grep -q '</svg>' "out/level-case$case.svg" || fail "no plot of case $case"
done
cp out/study.csv first.csv

# its own table read again; not that of the seeds, which --check says
expect 0 "" --regression out/study.csv
expect 1 "" --regression out/study.csv --check

# the seeds' rounding is found out, at one thread and in place of what was there
expect 1 "" spheres --size 48x40 --out out --check --float32 --threads 1
grep -q '^A3 *0 of' said.out && fail "binary32 passes A3"
grep -q '^A5 *0 of' said.out && fail "binary32 passes A5"
cmp -s first.csv out/study.csv && fail "the files are those of the first study"

# Ctrl-C: soon, and nothing half-written
"$program" study spheres --out stopped >said.out 2>said.err &
child=$!
sleep 1
kill -INT "$child"
wait "$child"
[ $? = 130 ] || fail "interrupted: $(cat said.err)"
[ ! -e stopped ] || fail "an interrupted study left $(ls -A stopped)"

[ "$failures" = 0 ]
