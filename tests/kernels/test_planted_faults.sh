#!/bin/sh
# What the test of levels is worth: with a fault planted in a copy of the kernels it must fail, without one pass.
set -eu
cd "$(dirname "$0")/../.."
grep -qw avx2 /proc/cpuinfo && grep -qw f16c /proc/cpuinfo || { echo "skipped: no AVX2"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# try NAME EXPECTED FILE SED_SCRIPT
try() {
    rm -rf "$work/lib"
    cp -r lib "$work/lib"
    sed -e "$4" "lib/kernels/$3" >"$work/lib/kernels/$3"
    if [ "$2" = caught ] && cmp -s "lib/kernels/$3" "$work/lib/kernels/$3"; then
        echo "$1: the line is no longer there; plant the fault elsewhere"
        status=1
        return
    fi
    ${CC:-cc} -std=gnu11 -D_GNU_SOURCE -O2 -w -ffp-contract=off -fno-math-errno -fno-trapping-math \
        -I"$work/lib/include" -I"$work/lib/core" -I"$work/lib/lamps" -I"$work/lib/kernels" -Itests \
        "$work"/lib/core/*.c "$work"/lib/lamps/*.c "$work"/lib/kernels/*.c tests/kernels/test_levels.c tests/frames.c \
        -o "$work/levels" -lm -lpthread
    if "$work/levels" >"$work/said" 2>&1; then found=missed; else found=caught; fi
    echo "$1: $found ($(tail -n 1 "$work/said" | sed 's/.*: //'))"
    [ "$found" = "$2" ] || status=1
}

try "no fault" missed vector.h ''
try "the luminance by a fused multiply-add" caught vector.h \
    's/v_add(v_add(v_mul(c->weight\[0\], r), v_mul(c->weight\[1\], g))/v_add(v_about(c->weight[0], r, v_mul(c->weight[1], g))/'
try "a clamp that lets NaN through" caught vector.h \
    's/v_min(v_max(p->l\[k\], c->floor), c->ceiling)/v_min(v_max(c->floor, p->l[k]), c->ceiling)/'
try "codes that are guessed but not settled" caught vector_store.h 's/#define UNCERTAIN .*/#define UNCERTAIN 1/'
try "two lanes changed places" caught avx2.h 's/\*r = _mm256_shuffle_ps(rg01, rg23, 0x44);/*r = _mm256_shuffle_ps(rg23, rg01, 0x44);/'
exit $status
