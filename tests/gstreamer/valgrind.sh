#!/bin/sh
# gstreamer.valgrind: the tests of pupilae again, with a check of every access and every leak. GLib keeps its string
# table, as its own suppressions say.
set -eu
command -v valgrind >/dev/null || { echo "skipped: no valgrind: the packages are listed in test.sh"; exit 77; }
# Valgrind always reports that the CPU has rdtscp, and libhwy, which comes with libavcodec, relies on it.
[ "$(uname -m)" != x86_64 ] || grep -qw rdtscp /proc/cpuinfo || { echo "skipped: this CPU has no rdtscp"; exit 76; }
suppressions=/usr/share/glib-2.0/valgrind/glib.supp
own=$(dirname "$0")/valgrind.supp
[ -e $suppressions ] || { echo "skipped: no $suppressions: libglib2.0-dev has it"; exit 77; }
for program; do
    valgrind -q --num-callers=40 --leak-check=full --show-leak-kinds=definite,indirect --errors-for-leak-kinds=definite,indirect \
        --error-exitcode=3 --suppressions=$suppressions --suppressions="$own" "$program"
done
