#!/bin/sh
# `pupil study` as a user sees it: sentences, exit codes, files complete or absent. Needs $PUPIL_PROGRAM; runs in a
# folder of its own.
set -u
. "$(dirname "$0")/../../../lib.sh"
use_pupil

"$program" study --help >help.txt || fail "--help does not exit 0"
help_fits 40 90 help.txt

expect 2 "--sizes" study spheres --sizes 10x10
for bad in "--size 0x4" "--size 64" "--size 5000x5" "--threads 999" "--threads x" "--video 5,1" "--video 1,0" "--video 1"; do
    # shellcheck disable=SC2086 # two words
    expect 2 "${bad%% *}" study spheres --out out $bad
done
expect 2 "--out" study spheres --video 1,1
expect 2 "one scene" study spheres room
expect 2 "--regression" study --regression table.csv --out out
expect 1 "table.csv" study --regression table.csv
echo "1,1,0.005,600" >table.csv
expect 1 "table.csv: line 1" study --regression table.csv
expect 1 "nosuch" study nosuch.scene
expect 1 "there/out" study spheres --size 8x8 --out there/out
[ ! -e out ] || fail "a refused study made its folder"
echo text >file
expect 1 "file" study spheres --size 8x8 --out file

# a study
if ! command -v gnuplot >/dev/null; then
    expect 1 "gnuplot" study spheres --size 8x8 --out out
    [ ! -e out ] || fail "a refused study left its folder"
    end_test
    exit
fi
expect 0 "" study spheres --size 48x40 --out out --check
[ "$(grep -c ' 0 of .* violations' said.out)" = 11 ] || fail "not eleven tests without violations: $(cat said.out)"
[ "$(wc -l <out/study.csv)" = 1281 ] || fail "study.csv has $(wc -l <out/study.csv) lines"
[ "$(grep -c '^## Case' out/study.md)" = 16 ] || fail "study.md has not sixteen tables"
[ "$(grep -c '<h2>Case' out/study.html)" = 16 ] || fail "study.html has not sixteen tables"
for case in 1 2 3 4; do
    grep -q '</svg>' "out/level-case$case.svg" || fail "no plot of case $case"
done
cp out/study.csv first.csv

# its own table is read again; --check says that it is not the original study's
expect 0 "" study --regression out/study.csv
expect 1 "" study --regression out/study.csv --check

# the original study's rounding is detected, with one thread, replacing an earlier file
expect 1 "out/study.csv: is there already; name another folder, or add -y" study spheres --size 48x40 --out out
rm out/study.csv
expect 1 "out/study.md: is there already" study spheres --size 48x40 --out out
expect 1 "" study spheres --size 48x40 --out out -y --check --float32 --threads 1
grep -q '^A3 *0 of' said.out && fail "binary32 passes A3"
grep -q '^A5 *0 of' said.out && fail "binary32 passes A5"
cmp -s first.csv out/study.csv && fail "the files are those of the first study"

# Ctrl-C: a quick end, and nothing half-written
"$program" study spheres --out stopped >said.out 2>said.err &
child=$!
sleep 1
kill -INT "$child"
wait "$child"
[ $? = 130 ] || fail "interrupted: $(cat said.err)"
[ ! -e stopped ] || fail "an interrupted study left $(ls -A stopped)"

end_test
