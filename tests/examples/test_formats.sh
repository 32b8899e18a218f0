#!/bin/sh
# test_formats.sh: the examples that read the pixels of a decoder, of OpenCV and of a mono camera: on frames with a
# known picture, without a warning in any standard of C and C++, and short. $PUPIL_EXAMPLES is the folder that they were
# built into.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
source=$(cd "$(dirname "$0")/../.." && pwd)

fail() { echo "test_formats.sh: $*"; exit 1; }
codes() { od -An -v -w"$1" -tu1 | tr -s ' ' | sed 's/^ //' | uniq -c | tr -s ' ' | tr '\n' ';'; }

# The log-average of a frame is mapped to the key, 0.18, and white is 1: light times 0.18 / average, encoded again (IEC
# 61966-2-1). Y' 126, Cb 112, Cr 144 is R'G'B' 0.6024, 0.4855, 0.3757 (BT.601, limited range): 141.9 111.8 88.1. 3 x 2
# pixels; half a frame at the end is ignored.
printf '\176\176\176\176\176\176\160\160\220\220' >"$work/i420"
head -c 5 "$work/i420" | cat "$work/i420" "$work/i420" - | "$PUPIL_EXAMPLES/decoder_i420" 3 2 >"$work/out"
got=$(codes 3 <"$work/out")
[ "$got" = " 12 142 112 88;" ] || fail "I420: $got"

# Its upper pixels are B 10 G 20 R 30, the lower ones 20 10 40. They are more than 4 stops below the key, where codes
# are not brightened further (amplification_ev): light times 16, which is 62.3 94.0 125.7 and 94.0 62.3 157.5.
got=$("$PUPIL_EXAMPLES/mat_bgr" | tr '\n' ';')
[ "$got" = "62 94 126;62 94 126;94 62 157;94 62 157;" ] || fail "BGR: $got"

# 4 x 1 pixels of the codes 265 265 565 565, of which 64 is black: 94.8 and 145.2.
printf '\102\102\215\215\125' | "$PUPIL_EXAMPLES/mono_y10p" 4 1 >"$work/out"
got=$(codes 3 <"$work/out")
[ "$got" = " 2 95 95 95; 2 145 145 145;" ] || fail "Y10P: $got"

for program in decoder_i420 mono_y10p; do
    for arguments in "" "4" "0 4" "4 99999" "four 4" "-4 4"; do
        # unquoted on purpose
        "$PUPIL_EXAMPLES/$program" $arguments </dev/null >"$work/out" 2>"$work/err" && fail "$program takes '$arguments'"
        grep -q '^width and height' "$work/err" && grep -q "^usage: $program WIDTH HEIGHT" "$work/err" || fail "$program, '$arguments': $(cat "$work/err")"
    done
done

for name in decoder_i420 mat_bgr mono_y10p; do
    file=$source/docs/examples/$name.c
    [ "$(wc -l <"$file")" -le 25 ] || fail "$name.c is longer than 25 lines"
    for compiler in "gcc -std=c11" "clang -std=c11" "gcc -std=c17" \
        "g++ -xc++ -std=c++11" "g++ -xc++ -std=c++14" "g++ -xc++ -std=c++17" "g++ -xc++ -std=c++20" \
        "clang++ -xc++ -std=c++11" "clang++ -xc++ -std=c++14" "clang++ -xc++ -std=c++17" "clang++ -xc++ -std=c++20"; do
        command -v "${compiler%% *}" >/dev/null || continue
        $compiler -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only -I"$source/lib/include" "$file" ||
            fail "$name.c with $compiler"
    done
done
echo "ok"
