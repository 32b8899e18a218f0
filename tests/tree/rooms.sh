#!/bin/sh
# rooms.sh [BUILD]: rooms.py's rules of which file needs which, for this tree; first, that it finds planted faults.
set -eu
cd "$(dirname "$0")/../.."
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# plant FILE INCLUDES...: a file of a small tree
plant() {
    file=$work/$1
    shift
    mkdir -p "$(dirname "$file")"
    for header in "$@"; do echo "#include \"$header\""; done >"$file"
}
# expect SENTENCE: the only fault of the small tree; empty: it has none
expect() {
    said=$(python3 tests/tree/rooms.py --root "$work" | sed '$d') || :
    [ "$said" = "${1:+rooms.py: $1}" ] || {
        echo "rooms.sh: expected '$1', and it is '$said'"
        exit 1
    }
    rm -rf "$work/lib" "$work/drivers" "$work/apps" "$work/tests" "$work/fixtures"
    plant lib/include/pupil/pupil.h
    plant lib/base/numeric.h pupil/pupil.h
    plant lib/core/core.h base/numeric.h
    plant lib/core/core.c core.h
    plant fixtures/scene.h
    plant drivers/file/still.h pupil/pupil.h
    plant drivers/file/still_private.h still.h
    plant drivers/file/still.c still_private.h
    plant drivers/synth/synth.c scene.h
    plant apps/run/run.h file/still.h
    plant tests/gles/test_gles.c core/core.h
}
expect "no includes in $work"
expect ""
plant drivers/file/video.c file/nothing.h
expect "drivers/file/video.c includes file/nothing.h, which is not in the tree"
plant lib/kernels/run.c core/core.h
expect "lib/kernels/run.c -> lib/core/core.h: lib/kernels does not see lib/core"
plant lib/core/rows.c ../../drivers/file/still.h
expect "lib/core/rows.c -> drivers/file/still.h: lib does not see drivers"
plant drivers/live/live.c core/core.h
expect "drivers/live/live.c -> lib/core/core.h: not a public header of the library"
plant drivers/live/live.c scene.h
expect "drivers/live/live.c -> fixtures/scene.h: drivers does not see fixtures"
plant drivers/live/live.c file/still_private.h
expect "drivers/live/live.c -> drivers/file/still_private.h: a private header of another folder"
plant drivers/v4l2/device.h
plant drivers/v4l2/format.h
plant apps/run/options.c v4l2/format.h
plant apps/run/run.c v4l2/device.h
expect "apps/run/run.c -> drivers/v4l2/device.h: cameras are reached through drivers/live"
plant tests/run/test_run.c file/still_private.h
expect "tests/run/test_run.c -> drivers/file/still_private.h: a private header of another folder"
plant drivers/file/sink/sink.h file/still.h
plant drivers/file/file.c file/sink/sink.h
expect "circle of folders: drivers/file - drivers/file/sink"
plant drivers/file/still.h pupil/pupil.h video.h
plant drivers/file/video.h still.h
expect "circle of files: drivers/file/still.h - drivers/file/video.h"

# Calls: two files, each of which needs the other one, in two folders
objects=$work/build/lib/CMakeFiles/pupil_objects.dir
mkdir -p "$objects/core" "$objects/base"
plant lib/base/base.c
echo 'int base(void); int core(void); int core(void) { return base(); }' | ${CC:-cc} -xc -c - -o "$objects/core/core.c.o"
echo 'int base(void); int core(void); int base(void) { return core(); }' | ${CC:-cc} -xc -c - -o "$objects/base/base.c.o"
said=$(python3 tests/tree/rooms.py --root "$work" "$work/build" | sed '$d') || :
[ "$said" = "rooms.py: circle of calls between files: lib/base/base - lib/core/core
rooms.py: circle of calls between folders: lib/base - lib/core
rooms.py: circle of calls between rooms: lib/base - lib/core" ] || {
    echo "rooms.sh: calls: $said"
    exit 1
}

exec python3 tests/tree/rooms.py "$@"
