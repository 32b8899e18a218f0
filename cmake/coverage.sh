#!/bin/sh
# coverage.sh BUILD [FOLDER [TESTS]]: runs tests of a build made with --coverage. Without FOLDER, all quick tests, and it
# prints the share of lines that ran, a line a file, the least covered first. With a folder of the library, as lib/sensor,
# the quick and full tests whose names match TESTS (by default ^sensor[.] for lib/sensor), and it prints the branches of
# that folder's files and the lines that have one that did not run (branches.py). For branches the build is best made
# without optimisation:
#   cmake --preset coverage -B build/branches -DPUPIL_PROGRAM=OFF -DCMAKE_C_FLAGS="-O0 --coverage"
set -eu
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "$0")/.." && pwd)
folder=${2:-}
find "$build" -name '*.gcda' -exec rm -f {} +
if [ -n "$folder" ]; then
    ctest --test-dir "$build" -L '^(quick|full)$' -R "${3:-^${folder#lib/}[.]}" -j "$(nproc)" --output-on-failure
    exec python3 "$source/cmake/branches.py" "$build" "$folder" --missing
fi
ctest --test-dir "$build" -L quick -j "$(nproc)" --output-on-failure
cd "$build"
find lib drivers apps -name '*.gcda' -exec gcov -n -r -s "$source" {} + 2>/dev/null |
    awk -v FS="'" '/^File/ { file = $2 } /^Lines executed/ { sub(/^Lines executed:/, ""); print $0, file; file = "" }' |
    awk '$NF ~ /\.[ch]$/ { sub(/%/, " "); sub(/of /, ""); printf "%6.2f %% of %5d  %s\n", $1, $2, $3
             ran += $1 * $2 / 100; all += $2 }
         END { printf "%6.2f %% of %5d  together\n", 100 * ran / all, all }' | sort -n
