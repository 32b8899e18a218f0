#!/bin/sh
# nested.sh BUILD TARGET CTEST_ARGUMENTS [-- CMAKE_ARGUMENTS...]: configures and builds this tree once more, with other
# settings, and runs the tests there. TARGET may be several words, "-" builds all; CTEST_ARGUMENTS "-" runs none;
# without "--" the build must exist. Runs one more test in parallel than there are jobs, because some wait for cameras
# and for time.
set -eu
build=$1 target=$2 ctest_arguments=$3
shift 3
source=$(cd "$(dirname "$0")/../.." && pwd)
log=$build.log
mkdir -p "$(dirname "$build")"
[ "$target" = - ] && target=all

quietly() {
    "$@" >"$log" 2>&1 || {
        echo "nested.sh: failed: $*"
        tail -n 60 "$log"
        exit 1
    }
}
if [ $# -gt 0 ]; then
    shift
    cd "$source" # where the presets are
    quietly cmake -G Ninja "$@" -B "$build"
    # Unquoted on purpose.
    quietly cmake --build "$build" --target $target -j "${PUPIL_JOBS:-2}"
fi
[ "$ctest_arguments" = - ] && exit
# Unquoted on purpose.
ctest --test-dir "$build" -j "$((${PUPIL_JOBS:-2} + 1))" --no-tests=error --output-on-failure $ctest_arguments
