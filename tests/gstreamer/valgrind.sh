#!/bin/sh
# gstreamer.valgrind: the tests of pupilae again, with every access and all that is not freed looked at. GLib keeps its
# table of words, as its own list of suppressions says.
set -eu
command -v valgrind >/dev/null || { echo "skipped: no valgrind: the packages are listed in test.sh"; exit 77; }
# Valgrind always says that the CPU has rdtscp. libhwy, which comes with libavcodec, believes it.
[ "$(uname -m)" != x86_64 ] || grep -qw rdtscp /proc/cpuinfo || { echo "skipped: this CPU has no rdtscp"; exit 76; }
suppressions=/usr/share/glib-2.0/valgrind/glib.supp
own=$(dirname "$0")/valgrind.supp
[ -e $suppressions ] || { echo "skipped: no $suppressions: libglib2.0-dev has it"; exit 77; }
for program; do
    valgrind -q --num-callers=40 --leak-check=full --show-leak-kinds=definite,indirect --errors-for-leak-kinds=definite,indirect \
        --error-exitcode=3 --suppressions=$suppressions --suppressions="$own" "$program"
done
