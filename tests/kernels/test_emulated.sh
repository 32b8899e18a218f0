#!/bin/sh
# The AVX-512 level on a CPU that has none: compiled against functions in place of the instructions (SIMDe, and
# tests/kernels/emulated), it must pass the same test and give the committed digests.
set -eu
cd "$(dirname "$0")/../.."
[ "$(uname -m)" = x86_64 ] || { echo "skipped: not x86-64"; exit 76; }
echo '#include <simde/x86/avx512.h>' | ${CC:-cc} -E - >/dev/null 2>&1 || { echo "skipped: no SIMDe"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-std=gnu11 -D_GNU_SOURCE -O2 -w -ffp-contract=off -fno-math-errno -fno-trapping-math -DPUPIL_EMULATE
    -Ilib/include -Ilib -Itests"
${CC:-cc} $flags -Itests/kernels/emulated -c lib/kernels/avx512.c -o "$work/avx512.o" 2>"$work/log" ||
    { cat "$work/log"; exit 1; }
for source in $(ls lib/base/*.c lib/core/*.c lib/flicker/*.c lib/kernels/*.c lib/row_gain/*.c lib/sensor/*.c lib/veil/*.c | grep -v /avx512); do
    ${CC:-cc} $flags -c "$source" -o "$work/$(basename "$source" .c).o"
done
${CC:-cc} $flags "$work"/*.o tests/kernels/test_levels.c tests/frames.c -o "$work/levels" -lm -lpthread
"$work/levels" "$@" | tee "$work/said"
grep -q 'levels here.*AVX-512' "$work/said"
${CC:-cc} $flags "$work"/*.o tests/stream/digest*.c -o "$work/digest" -lm
sh tests/stream/digest.sh tests/stream/digests.txt "$work/digest"
