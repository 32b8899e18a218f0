#!/bin/sh
# check.sh: every public header compiles alone, included twice, as C11 and as C++11 to C++20, with each installed
# compiler.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
checked=0
for header in lib/include/pupil/*.h drivers/include/pupil/*.h; do
    name=pupil/$(basename "$header")
    printf '#include "%s"\n#include "%s"\n' "$name" "$name" | tee "$work/alone.c" >"$work/alone.cpp"
    for compiler in gcc clang; do
        command -v "$compiler" >/dev/null || continue
        "$compiler" -std=c11 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror \
            -Ilib/include -Idrivers/include -c "$work/alone.c" -o "$work/alone.o"
        checked=$((checked + 1))
    done
    for compiler in g++ clang++; do
        command -v "$compiler" >/dev/null || continue
        for standard in 11 14 17 20; do
            "$compiler" -std=c++$standard -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror \
                -Ilib/include -Idrivers/include -fsyntax-only "$work/alone.cpp"
            checked=$((checked + 1))
        done
    done
done
[ $checked -gt 0 ] || { echo "check.sh: no compiler found"; exit 1; }
echo "$checked compilations of $(ls lib/include/pupil/*.h drivers/include/pupil/*.h | wc -l) headers"
