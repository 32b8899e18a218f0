#!/bin/sh
# test_standards.sh: pupil/opencv.hpp and the examples in C++ compile without a warning in each standard.
set -eu
source=$(cd "$(dirname "$0")/../.." && pwd)
include=$(find /usr/include/opencv4 /usr/local/include/opencv4 -maxdepth 0 2>/dev/null | head -n 1)
count=0
for compiler in g++ clang++; do
    command -v $compiler >/dev/null || continue
    for one in 11:opencv_video 14:opencv_still 17:opencv_video 20:opencv_still; do
        $compiler -std=c++${one%:*} -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Werror \
            -I"$source/lib/include" -I"$source/drivers/include" -isystem "$include" -fsyntax-only \
            "$source/docs/examples/${one#*:}.cpp" || { echo "$compiler, $one"; exit 1; }
        count=$((count + 1))
    done
done
[ $count -gt 0 ] || { echo "no compiler"; exit 1; }
echo "$count compilations"
