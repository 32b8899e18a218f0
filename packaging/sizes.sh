#!/bin/sh
# sizes.sh [TOOLCHAIN.cmake]: builds the library and the program with one option changed at a time, in a folder of its own, and
# prints a table of their sizes on disk in KiB, stripped. Of a cross build (cmake/aarch64-linux-gnu.cmake) the library alone.
set -eu
tree=$(cd "$(dirname "$0")/.." && pwd)
toolchain=${1:+-DCMAKE_TOOLCHAIN_FILE=$(realpath "$1")}
strip=strip
if [ -n "$toolchain" ]; then
    strip=$(sed -n 's/.*CMAKE_C_COMPILER \(.*\)gcc.*/\1/p' "$1")strip
    command -v "$strip" >/dev/null || { echo "$0: no $strip" >&2; exit 1; }
fi
work=$tree/build/sizes # always the same, for compilers' caches
mkdir -p "$work"
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

# kib FILE: stripped; "-" where it is not built
kib() {
    [ -e "$1" ] || { echo -; return; }
    "$strip" -o "$work/stripped" "$1"
    stat -c %s "$work/stripped" | awk '{ printf "%.0f", $1 / 1024 }'
}
# row NAME ARGUMENTS...: of CMake
row() {
    name=$1
    shift
    rm -rf "$work/build"
    { cmake -G Ninja -S "$tree" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DPUPIL_PYTHON=OFF -DPUPIL_GSTREAMER=OFF \
        $toolchain "$@" ${toolchain:+-DPUPIL_PROGRAM=OFF -DPUPIL_MEDIA=OFF} &&
        cmake --build "$work/build" --target pupil_shared && { [ -n "$toolchain" ] || case "$*" in *PROGRAM=OFF*) ;; *) cmake --build "$work/build" --target pupil ;; esac; }
    } >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; echo "$0: $name: the build failed" >&2; exit 1; }
    echo "| $name | $(kib "$work/build/lib/libpupil.so") | $(kib "$work/build/apps/pupil") |"
}
echo "| options | library, KiB | program, KiB |"
echo "|---|--:|--:|"
row "the defaults" -DPUPIL_GPU=ON
row "\`PUPIL_LAB=ON\`" -DPUPIL_LAB=ON
row "\`PUPIL_LIBCAMERA=OFF\`" -DPUPIL_LIBCAMERA=OFF
row "\`PUPIL_MEDIA=OFF\`" -DPUPIL_MEDIA=OFF
row "\`PUPIL_GPU=OFF\`" -DPUPIL_GPU=OFF
row "\`PUPIL_V4L2=OFF\`" -DPUPIL_V4L2=OFF
row "\`PUPIL_MEDIA=OFF\`, \`PUPIL_GPU=OFF\`, \`PUPIL_LIBCAMERA=OFF\`" -DPUPIL_MEDIA=OFF -DPUPIL_GPU=OFF -DPUPIL_LIBCAMERA=OFF
row "\`PUPIL_LEVELS=scalar\`" -DPUPIL_LEVELS=scalar
row "\`CMAKE_BUILD_TYPE=MinSizeRel\`" -DCMAKE_BUILD_TYPE=MinSizeRel
row "\`PUPIL_PROGRAM=OFF\`, \`PUPIL_GPU=OFF\`, \`MinSizeRel\`" -DPUPIL_PROGRAM=OFF -DPUPIL_GPU=OFF -DPUPIL_MEDIA=OFF \
    -DCMAKE_BUILD_TYPE=MinSizeRel
