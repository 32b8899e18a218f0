#!/bin/sh
# floats.sh: flags that would change the library's bits are refused at compile time, with a sentence that says which
# would be right (lib/base/exact.h); those that it is built with are accepted.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
lib=$here/../../lib
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# compiles COMPILER FLAGS...
compiles() {
    "$@" -I"$lib" -I"$lib/include" -c "$lib/base/numeric.c" -o "$work/object" 2>"$work/said"
}
accepted() {
    compiles "$@" || { echo "floats.sh: refused: $*: $(grep error "$work/said" | head -n 1)"; status=1; }
}
# refused WORDS COMPILER FLAGS...
refused() {
    words=$1
    shift
    if compiles "$@"; then
        echo "floats.sh: not refused: $*"
        status=1
    elif ! grep 'error: .*pupil: ' "$work/said" | grep -qF -- "$words"; then
        echo "floats.sh: no '$words' for $*: $(head -n 3 "$work/said")"
        status=1
    fi
}

for compiler in gcc clang; do
    command -v "$compiler" >/dev/null || continue
    accepted "$compiler" -std=c11 -O2
    accepted "$compiler" -std=c11 -O3
    refused "Compile without it" "$compiler" -std=c11 -O2 -ffast-math
    refused "Compile without it" "$compiler" -std=c11 -Ofast
    refused "Compile without it" "$compiler" -std=c11 -O2 -ffinite-math-only
done
refused "Compile without it" gcc -std=c11 -O2 -fassociative-math -fno-signed-zeros -fno-trapping-math
refused "Compile without it" gcc -std=c11 -O2 -freciprocal-math
if [ "$(uname -m)" = x86_64 ]; then
    refused "-mfpmath=sse" gcc -std=c11 -O2 -mfpmath=387
    accepted gcc -std=c11 -O2 -mfma
    refused "-ffp-contract=off" gcc -std=gnu11 -O2 -mfma
    accepted gcc -std=gnu11 -O2 -mfma -ffp-contract=off -DPUPIL_NO_CONTRACTION
fi
if command -v i686-linux-gnu-gcc >/dev/null; then
    refused "-mfpmath=sse" i686-linux-gnu-gcc -std=c11 -O2
    accepted i686-linux-gnu-gcc -std=c11 -O2 -msse2 -mfpmath=sse
fi
if command -v s390x-linux-gnu-gcc >/dev/null; then
    refused "-fexcess-precision=fast" s390x-linux-gnu-gcc -std=c11 -O2
    accepted s390x-linux-gnu-gcc -std=c11 -O2 -fexcess-precision=fast
fi
[ $status = 0 ] && echo "flags that change bits are refused, others are not"
exit $status
