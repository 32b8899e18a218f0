#!/bin/sh
# --explain: each reason why a frame is dark or bright, in words, on frames made for it.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil

# grey NAME LEVEL...: a folder of flat 4 x 4 PFM of these levels, each a byte of binary32: ? is 1.0, ; is 0.0029, C is 186
grey() {
    folder=$1 n=0
    shift
    mkdir "$folder"
    for bits in "$@"; do
        { printf 'PF\n4 4\n-1.0\n'; i=0; while [ $i -lt 48 ]; do printf '\0\0\200%b' "$bits"; i=$((i + 1)); done; } >"$folder/$n.pfm"
        n=$((n + 1))
    done
}
# explains WORDS ARGUMENTS...: what is on standard output
explains() {
    words=$1
    shift
    "$program" replay "$@" -q >said.out 2>said.err </dev/null || fail "$*: $(cat said.err)"
    grep -qF -- "$words" said.out || fail "$*: no '$words' in: $(cat said.out)"
}

grey steady '?' '?' '?'
grey darker '?' ';' ';'
grey lighter ';' '?' '?'
explains "frame 2 of steady/2.pfm, at 0.067 s" steady --explain 2
mkdir steered && cp steady/0.pfm "$(printf 'steered/\033[7m.pfm')"
explains "frame 0 of steered/?[7m.pfm, at 0.000 s" steered --explain 0
explains "metered  +0.00 EV, the log-average" steady --explain 2
explains "settled: where this frame alone would have it" steady --explain 2
explains "it is as it is aimed at; --ev 1 makes it twice as bright" steady --explain 2
explains "EV higher than this frame alone would have it" darker --explain 1
explains "with a time constant of 0.9 s; --tau-dark less is faster" darker --explain 1
explains "with a time constant of 5 s; --tau-light less is faster" lighter --explain 1 --tau-light 5
explains "it is as it is aimed at" darker --explain 1 --reset-each
explains "locked at the first frame's; without --lock it follows" darker --explain 1 --lock
explains "each frame counts 0.05 (--weight)" darker --explain 1 --formula 2
explains "why      --ev -2.00" steady --explain 0 --ev -2
explains "the light has become less, and an eye follows in part within a second" darker --explain 1 --law eye
{ printf 'PF\n4 4\n-1.0\n'; i=0; while [ $i -lt 48 ]; do printf '\0\0\300\177'; i=$((i + 1)); done; } >nan.pfm
explains "100 % are NaN, which counts as the floor (--floor)" nan.pfm --explain 0
explains "why      most of its pixels are NaN or infinite" nan.pfm --explain 0
explains "for its highlights" synth:candle --size 64x36 --explain 0 --highlights 8
explains "nothing can be metered" steady --explain 0 --roi 0,0,0.01,0.01

# without outputs the run ends there; with them it continues
explains "frame 0" synth:walk --size 32x18 --explain 0 --stats all.csv -n 20
[ "$(wc -l <all.csv)" = 21 ] || fail "with --stats: $(wc -l <all.csv) lines"
expect 1 "--explain 3: steady has 3 frames, which count from 0" replay steady --explain 3
expect 2 "--explain 5: frames count from 0, and -n ends the run before" replay steady --explain 5 -n 5
expect 2 "standard output" replay steady --explain 0 --stats -
expect 2 "--explain x: must be a frame's number, 0 or more" replay steady --explain x

end_test
