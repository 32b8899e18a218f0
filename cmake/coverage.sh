#!/bin/sh
# coverage.sh BUILD: runs the quick tests of a build made with --coverage and prints the share of lines that ran, a line
# a file, the least covered first.
set -eu
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "$0")/.." && pwd)
find "$build" -name '*.gcda' -exec rm -f {} +
ctest --test-dir "$build" -L quick -j "$(nproc)" --output-on-failure
cd "$build"
find lib drivers apps -name '*.gcda' -exec gcov -n -r -s "$source" {} + 2>/dev/null |
    awk -v FS="'" '/^File/ { file = $2 } /^Lines executed/ { sub(/^Lines executed:/, ""); print $0, file; file = "" }' |
    awk '$NF ~ /\.[ch]$/ { sub(/%/, " "); sub(/of /, ""); printf "%6.2f %% of %5d  %s\n", $1, $2, $3
             ran += $1 * $2 / 100; all += $2 }
         END { printf "%6.2f %% of %5d  together\n", 100 * ran / all, all }' | sort -n
