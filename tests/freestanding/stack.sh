#!/bin/sh
# stack.sh NAME FOLDER [SIZE]: the stack of every function of the library, as reported by the compiler (-fstack-usage),
# in FOLDER/core, FOLDER/kernels and so on: at most 1024 bytes, and 4608 in kernels, where mapping has a buffer that
# fits into the first-level cache. Never unbounded. With the tool SIZE: how large the code is, and that there is no
# data.
set -eu
name=$1 folder=$2 size=${3-}
usage=$(mktemp)
trap 'rm -f "$usage"' EXIT
status=0
for room in base core flicker kernels look row_gain sensor veil; do
    limit=1024
    [ $room != kernels ] || limit=4608
    # FILE:LINE:COLUMN:FUNCTION <tab> BYTES <tab> static | dynamic | dynamic,bounded
    cat "$folder/$room"/*.su | sort -t "$(printf '\t')" -k2,2nr >"$usage"
    awk -F '\t' -v limit="$limit" -v room="$room" -v name="$name" '
        { n = split($1, part, ":"); function_name = part[n] }
        NR == 1 { printf "%-24s lib/%-8s largest %5d bytes (%s), limit %d\n", name, room, $2, function_name, limit }
        $2 > limit { printf "    %s takes %d bytes\n", $1, $2; bad = 1 }
        $3 == "dynamic" { printf "    %s: %s stack without bound\n", $1, $3; bad = 1 }
        END { exit bad || NR == 0 }' "$usage" || status=1
done
[ -n "$size" ] || exit $status
"$size" "$folder"/*/*.o* | awk -v name="$name" 'NR > 1 { text += $1; data += $2; bss += $3 }
    END {
        printf "%-24s code and constants %6d bytes, data %d, bss %d\n", name, text, data, bss
        exit data + bss != 0 || NR < 2
    }' || status=1
exit $status
