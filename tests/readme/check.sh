#!/bin/sh
# check.sh BUILD: README.md is right. Its first C program is compiled by the line next to it, against an install of
# BUILD, and run; every script in its commands exists and is executable; its numbers for errors are those that their
# command prints.
set -eu
build=$1
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The first block that ```c begins.
awk '/^```c$/ { inside = 1; next } /^```/ { if (inside) exit } inside' README.md >"$work/block.c"
[ -s "$work/block.c" ] || { echo "check.sh: README.md has no \`\`\`c block"; exit 1; }
# The line that compiles it: "cc NAME.c ... $(pkg-config ... pupil)", in a comment of the program or next to it.
line=$(grep -m1 -E '^[ $/*]*(cc|gcc) .*\.c.*pkg-config .*pupil' README.md | sed 's/^[ $/*]*//; s/ *\*\/ *$//')
[ -n "$line" ] || { echo "check.sh: README.md has no line that compiles its program with pkg-config"; exit 1; }
source=$(echo "$line" | grep -oE '[a-zA-Z0-9_]+\.c' | head -n 1)
program=$(echo "$line" | sed -n 's/.*-o \([a-zA-Z0-9_.]*\).*/\1/p')

cmake --install "$build" --prefix "$work/prefix" >"$work/log" || { cat "$work/log"; exit 1; }
libdir=$(dirname "$(find "$work/prefix" -name libpupil.a)")
cp "$work/block.c" "$work/$source"
echo "$line"
(
    cd "$work"
    PKG_CONFIG_PATH=$libdir/pkgconfig LD_LIBRARY_PATH=$libdir
    export PKG_CONFIG_PATH LD_LIBRARY_PATH
    eval "$line"
    "./${program:-a.out}"
    # C++ requires designated initializers in the order of the fields.
    ! command -v g++ >/dev/null || g++ -std=c++20 -x c++ -fsyntax-only "$source" $(pkg-config --cflags pupil)
) || { echo "check.sh: the program of README.md does not compile or run"; exit 1; }
echo "README.md's program of $(wc -l <"$work/block.c") lines compiles and runs"

for script in $(grep -oE '(^|[ `(])\./[a-z_]+\.sh' README.md | grep -oE '[a-z_]+\.sh' | sort -u); do
    [ -x "$script" ] || { echo "check.sh: README.md names ./$script, which is not there or cannot be run"; exit 1; }
    echo "./$script is there"
done
for script in demo.sh test.sh; do
    grep -q "\./$script" README.md || { echo "check.sh: README.md does not name ./$script"; exit 1; }
done

# If the build has the program. "2.3e-8" is "2.3e-08" in C.
if [ -x "$build/apps/pupil" ]; then
    line=$(grep -o -m1 'pupil replay synth:walk [^`]*' README.md | sed "s,--report ,&$work/,")
    error=$(sed -n 's/^- \*\*\(.*\)\*\* is the relative error.*/\1/p' README.md | sed 's/e-\(.\)$/e-0\1/')
    eval "$build/apps/$line" 2>"$work/said"
    grep -q "log-average within $error of a long-double reference; none of the display's samples differs" "$work/said" &&
        grep -q '^- \*\*0 %\*\* of the display' README.md ||
        { echo "check.sh: README.md has other numbers than: $(cat "$work/said")"; exit 1; }
    echo "README.md's errors are those that pupil replay prints"
fi
