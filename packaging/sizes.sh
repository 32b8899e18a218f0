#!/bin/sh
# sizes.sh BUILD: the size of the library and the program by option, as a table: each is built in BUILD (Release), installed
# and stripped.
set -eu
[ $# = 1 ] || { echo "usage: $0 BUILD" >&2; exit 2; }
tree=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
build=$(cd "$1" && pwd)

# kb FILE: its size in kB; "-" if it is absent
kb() {
    [ -f "$1" ] || { echo -; return; }
    echo $((($(stat -L -c %s "$1") + 500) / 1000))
}
# row WORDS PRESET OPTIONS...
row() {
    words=$1 preset=$2
    shift 2
    rm -rf "$build/made" "$build/root"
    {
        cmake -S "$tree" --preset "$preset" -B "$build/made" -DCMAKE_INSTALL_PREFIX=/usr -DPUPIL_TESTS=OFF -DPUPIL_PYTHON=OFF -DPUPIL_GSTREAMER=OFF "$@" &&
            cmake --build "$build/made" -j "$(nproc)" && DESTDIR=$build/root cmake --install "$build/made" --strip
    } >"$build/log" 2>&1 || { tail -n 20 "$build/log" >&2; exit 1; }
    libraries=$(find "$build/root" -name 'libpupil.so*' -type f | head -n 1)
    program=$(find "$build/root" -path '*/bin/pupil' | head -n 1)
    needs=-
    [ -z "$program" ] || needs=$(readelf -d "$program" | grep -c NEEDED)
    echo "| $words | $(kb "$libraries") | $(kb "$program") | $needs |"
}
echo "| options | libpupil.so, kB | pupil, kB | libraries that it names |"
echo "|---|--:|--:|--:|"
row "default" release
row "\`-DPUPIL_GPU=OFF\`" release -DPUPIL_GPU=OFF
row "\`-DPUPIL_MEDIA=OFF\`" release -DPUPIL_MEDIA=OFF
row "\`-DPUPIL_LIBCAMERA=OFF\`" release -DPUPIL_LIBCAMERA=OFF
row "all three: V4L2 cameras, PFM and Radiance files" release -DPUPIL_GPU=OFF -DPUPIL_MEDIA=OFF -DPUPIL_LIBCAMERA=OFF
row "\`-DPUPIL_PROGRAM=OFF -DPUPIL_GPU=OFF\`: the library alone" release -DPUPIL_PROGRAM=OFF -DPUPIL_GPU=OFF
row "AArch64, \`--preset arm64\`: the library alone" arm64
