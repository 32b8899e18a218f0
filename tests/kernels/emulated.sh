#!/bin/sh
# emulated.sh LEVEL: avx512 or wasm128 on a CPU that does not have it: compiled against functions in place of the
# instructions (SIMDe, and tests/kernels/emulated), it must pass the same test and give the committed digests.
set -eu
cd "$(dirname "$0")/../.."
[ "$(uname -m)" = x86_64 ] || { echo "skipped: not x86-64"; exit 76; }
echo '#include <simde/x86/avx512.h>' | ${CC:-cc} -E - >/dev/null 2>&1 || { echo "skipped: no SIMDe"; exit 77; }
level=$1
case $level in
avx512) number=8 name=AVX-512 ;; # 1 << pupil_level
wasm128) number=16 name=wasm128 ;;
*)
    echo "usage: $0 avx512|wasm128" >&2
    exit 2
    ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-std=gnu11 -D_GNU_SOURCE -O2 -w -ffp-contract=off -fno-math-errno -fno-trapping-math -Ilib/include -Ilib -Itests"
emulate="-DPUPIL_EMULATE=${number}u"
[ "$level" != wasm128 ] || emulate="$emulate -DPUPIL_WASM128"
${CC:-cc} $flags $emulate -Itests/kernels/emulated -c lib/kernels/$level.c -o "$work/$level.o" 2>"$work/log" ||
    { cat "$work/log"; exit 1; }
for source in $(ls lib/base/*.c lib/core/*.c lib/flicker/*.c lib/kernels/*.c lib/row_gain/*.c lib/sensor/*.c lib/veil/*.c |
    grep -Ev "/($level|level)\.c"); do
    ${CC:-cc} $flags -c "$source" -o "$work/$(basename "$source" .c).o"
done
${CC:-cc} $flags $emulate "$work"/*.o lib/kernels/level.c tests/kernels/test_levels.c tests/frames.c -o "$work/levels" -lm -lpthread
"$work/levels" | tee "$work/said"
grep -q "levels here.*$name" "$work/said"
${CC:-cc} $flags $emulate "$work"/*.o lib/kernels/level.c tests/stream/digest*.c -o "$work/digest" -lm
sh tests/stream/digest.sh tests/stream/digests.txt "$work/digest"
