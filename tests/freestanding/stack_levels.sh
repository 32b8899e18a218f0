#!/bin/sh
# stack_levels.sh LEVELS...: stack.sh for the library from each compiler at these optimisation levels.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0 ran=0
for level; do
    for compiler in gcc clang aarch64-linux-gnu-gcc arm-none-eabi-gcc; do
        command -v "$compiler" >/dev/null || continue
        case $compiler in
        *-gcc) size=${compiler%gcc}size ;;
        *) size=size ;;
        esac
        set -- "$compiler" "$level"
        [ "$compiler" != arm-none-eabi-gcc ] ||
            set -- "$@" -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard -ffreestanding
        rm -rf "$work"/*
        for room in base core flicker kernels look row_gain sensor veil; do
            mkdir "$work/$room"
            for source in lib/$room/*.c; do
                "$@" -std=c11 -fno-pie -ffp-contract=off -fno-math-errno -fno-trapping-math -fstack-usage \
                    -Ilib/include -Ilib -c "$source" -o "$work/$room/$(basename "$source" .c).o"
            done
        done
        sh tests/freestanding/stack.sh "$compiler $level" "$work" "$size" || status=1
        ran=$((ran + 1))
    done
done
[ $ran -gt 0 ] || { echo "skipped: no gcc, no clang"; exit 77; }
exit $status
