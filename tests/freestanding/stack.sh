#!/bin/sh
# stack.sh LEVELS...: the stack of every function of the library, by -fstack-usage, at these levels of optimisation: at
# most 1024 bytes in lib, and 4608 in lib/kernels, where the mapping kernels keep a buffer that stays in the first-level
# cache. Never without a bound. And how large its code is; it has no data.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# check FOLDER LIMIT NAME COMPILER...
check() {
    folder=$1 limit=$2 name=$3
    shift 3
    mkdir "$work/$folder"
    for source in lib/"$folder"/*.c; do
        "$@" -std=c11 -fno-pie -ffp-contract=off -fno-math-errno -fno-trapping-math -fstack-usage \
            -Ilib/include -Ilib -c "$source" \
            -o "$work/$folder/$(basename "$source" .c).o"
    done
    # FILE:LINE:COLUMN:FUNCTION <tab> BYTES <tab> static | dynamic | dynamic,bounded
    cat "$work/$folder"/*.su | sort -t "$(printf '\t')" -k2,2nr >"$work/all"
    awk -F '\t' -v limit="$limit" -v folder="$folder" -v name="$name" '
        { n = split($1, part, ":"); function_name = part[n] }
        NR == 1 { printf "%-24s lib/%-8s largest %5d bytes (%s), limit %d\n", name, folder, $2, function_name, limit }
        $2 > limit { printf "    %s takes %d bytes\n", $1, $2; bad = 1 }
        $3 == "dynamic" { printf "    %s: %s stack without bound\n", $1, $3; bad = 1 }
        END { exit bad || NR == 0 }' "$work/all" || status=1
}

# check_size NAME TOOL
check_size() {
    "$2" "$work"/*/*.o | awk -v name="$1" 'NR > 1 { text += $1; data += $2; bss += $3 }
        END {
            printf "%-24s code and constants %6d bytes, data %d, bss %d\n", name, text, data, bss
            exit data + bss != 0 || NR < 2
        }' || status=1
}

ran=0
for level; do
    for compiler in gcc clang aarch64-linux-gnu-gcc arm-none-eabi-gcc; do
        command -v "$compiler" >/dev/null || continue
        set -- "$compiler" "$level"
        [ "$compiler" != arm-none-eabi-gcc ] ||
            set -- "$@" -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard -ffreestanding
        rm -rf "$work"/*
        check core 1024 "$compiler $level" "$@"
        for folder in base flicker look row_gain sensor veil; do
            check "$folder" 1024 "$compiler $level" "$@"
        done
        check kernels 4608 "$compiler $level" "$@"
        case $compiler in
        *-gcc) check_size "$compiler $level" "${compiler%gcc}size" ;;
        *) check_size "$compiler $level" size ;;
        esac
        ran=$((ran + 1))
    done
done
[ $ran -gt 0 ] || { echo "skipped: no gcc, no clang"; exit 77; }
exit $status
