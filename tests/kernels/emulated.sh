#!/bin/sh
# emulated.sh LEVEL LIBRARY [missing]: avx512 or wasm128 on any x86 CPU: compiled with functions instead of the
# instructions (SIMDe, and tests/kernels/emulated), it must pass the same test and give the committed digests. LIBRARY
# is libpupil.a, for everything outside the level. With "missing" only on a CPU without AVX-512: where there is AVX-512,
# kernels.levels and stream.digest run the level itself.
set -eu
cd "$(dirname "$0")/../.."
[ "$(uname -m)" = x86_64 ] || { echo "skipped: not x86-64"; exit 76; }
echo '#include <simde/x86/avx512.h>' | ${CC:-cc} -E - >/dev/null 2>&1 || { echo "skipped: no SIMDe"; exit 77; }
level=$1 library=$2
if [ "${3:-}" = missing ] && grep -qw avx512dq /proc/cpuinfo && grep -qw avx512bw /proc/cpuinfo; then
    echo "skipped: this CPU has AVX-512"
    exit 76
fi
case $level in
avx512) number=8 name=AVX-512 ;; # 1 << pupil_level
wasm128) number=16 name=wasm128 ;;
*)
    echo "usage: $0 avx512|wasm128 LIBRARY [missing]" >&2
    exit 2
    ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Most of the time goes to compiling the level: with -O1 and, for the levels of x86, with the instructions of AVX2 where
# this CPU has them. For wasm128 SIMDe would include its own immintrin.h, which is replaced here.
flags="-std=gnu11 -D_GNU_SOURCE -O1 -w -ffp-contract=off -fno-math-errno -fno-trapping-math -Ilib/include -Ilib -Itests"
[ "$level" = wasm128 ] || ! grep -qw avx2 /proc/cpuinfo || flags="$flags -mavx2"
emulate="-DPUPIL_EMULATE=${number}u"
[ "$level" != wasm128 ] || emulate="$emulate -DPUPIL_WASM128"
${CC:-cc} $flags $emulate -Itests/kernels/emulated -c lib/kernels/$level.c -o "$work/$level.o" 2>"$work/log" ||
    { cat "$work/log"; exit 1; }
# build NAME SOURCES...
build() {
    program=$1
    shift
    ${CC:-cc} $flags $emulate "$work/$level.o" lib/kernels/level.c "$@" "$library" -o "$work/$program" -lm -lpthread
}
build levels tests/kernels/test_levels.c tests/frames.c
"$work/levels" | tee "$work/said"
grep -q "levels here.*$name" "$work/said"
build digest tests/stream/digest*.c
sh tests/stream/digest.sh tests/stream/digests.txt "$work/digest"
