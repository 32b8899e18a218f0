#!/bin/sh
# Checks the test of levels: with a fault planted in a copy of the kernels it must fail, without one pass.
set -eu
cd "$(dirname "$0")/../.."
grep -qw avx2 /proc/cpuinfo && grep -qw f16c /proc/cpuinfo || { echo "skipped: no AVX2"; exit 76; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# compile FOLDER OBJECTS SOURCES...: with the library that is in FOLDER
compile() {
    lib=$1 objects=$2
    shift 2
    mkdir -p "$objects"
    for source; do
        ${CC:-cc} -std=gnu11 -D_GNU_SOURCE -O2 -w -ffp-contract=off -fno-math-errno -fno-trapping-math -I"$lib/include" \
            -I"$lib" -Itests -c "$source" -o "$objects/$(basename "$source" .c).o"
    done
}

# Only the vector levels include the headers with planted faults; everything else, and a level that this CPU cannot run,
# is compiled once.
with=avx2
! grep -qw avx512f /proc/cpuinfo || with="avx2 avx512"
compile lib "$work/same" lib/base/*.c lib/core/*.c lib/flicker/*.c lib/kernels/*.c lib/row_gain/*.c lib/sensor/*.c lib/veil/*.c tests/kernels/test_levels.c tests/frames.c

# try NAME EXPECTED FILE SED_SCRIPT
try() {
    rm -rf "$work/lib" "$work/planted"
    cp -r lib "$work/lib"
    sed -e "$4" "lib/kernels/$3" >"$work/lib/kernels/$3"
    if [ "$2" = caught ] && cmp -s "lib/kernels/$3" "$work/lib/kernels/$3"; then
        echo "$1: the line is no longer there; plant the fault elsewhere"
        status=1
        return
    fi
    cp -r "$work/same" "$work/planted"
    for level in $with; do
        compile "$work/lib" "$work/planted" "$work/lib/kernels/$level.c"
    done
    ${CC:-cc} "$work"/planted/*.o -o "$work/levels" -lm -lpthread
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
try "denormals lost from light" caught vector_formats.h 's/pupil_pixel_bytes(job->out_pixel) <= 4/1/'
try "pixels skipped after those that are not bounded" caught vector_formats.h \
    's/            return i + PUPIL_LANES;/            return i + 2 * PUPIL_LANES;/'
exit $status
