#!/bin/sh
# The levels of AVX-512 and of WebAssembly on a CPU that has none: compiled against functions in place of the instructions
# (SIMDe, and tests/kernels/emulated), each must pass the same test and give the committed digests.
set -eu
cd "$(dirname "$0")/../.."
[ "$(uname -m)" = x86_64 ] || { echo "skipped: not x86-64"; exit 76; }
echo '#include <simde/x86/avx512.h>' | ${CC:-cc} -E - >/dev/null 2>&1 || { echo "skipped: no SIMDe"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-std=gnu11 -D_GNU_SOURCE -O2 -w -ffp-contract=off -fno-math-errno -fno-trapping-math -Ilib/include -Ilib -Itests"
avx512=8 wasm128=16 # 1 << pupil_level
for level in avx512 wasm128; do
    ${CC:-cc} $flags -DPUPIL_WASM128 -DPUPIL_EMULATE=$((avx512 | wasm128))u -Itests/kernels/emulated -c lib/kernels/$level.c -o "$work/$level.o" 2>"$work/log" ||
        { cat "$work/log"; exit 1; }
done
for source in $(ls lib/base/*.c lib/core/*.c lib/flicker/*.c lib/kernels/*.c lib/row_gain/*.c lib/sensor/*.c lib/veil/*.c | grep -Ev '/(avx512|wasm128|level)\.c'); do
    ${CC:-cc} $flags -c "$source" -o "$work/$(basename "$source" .c).o"
done
${CC:-cc} $flags -DPUPIL_WASM128 -DPUPIL_EMULATE=$((avx512 | wasm128))u "$work"/*.o lib/kernels/level.c \
    tests/kernels/test_levels.c tests/frames.c -o "$work/levels" -lm -lpthread
"$work/levels" "$@" | tee "$work/said"
grep -q 'levels here.*AVX-512.*wasm128' "$work/said"
for level in $avx512 $wasm128; do
    ${CC:-cc} $flags -DPUPIL_WASM128 -DPUPIL_EMULATE=${level}u "$work"/*.o lib/kernels/level.c tests/stream/digest*.c \
        -o "$work/digest" -lm
    sh tests/stream/digest.sh tests/stream/digests.txt "$work/digest"
done
