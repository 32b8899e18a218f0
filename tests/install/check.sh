#!/bin/sh
# check.sh BUILD: installs BUILD into an empty folder, moves that, and builds and runs programs against it: by
# pkg-config and by find_package, in C and in C++, with the shared and with the static library.
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/first" >"$work/log" || { cat "$work/log"; exit 1; }
mv "$work/first" "$work/moved" # the files find each other regardless of the tree's location
prefix=$work/moved

libdir=$(dirname "$(find "$prefix" -name libpupil.a)")
# A new minor version has another soname, and find_package refuses it as well.
version=$(sed -n 's/^Version: //p' "$libdir/pkgconfig/pupil.pc")
expected=libpupil.so.${version%.*}
[ -e "$libdir/$expected" ] || { echo "check.sh: no $expected is installed"; exit 1; }
soname=$(readelf -d "$libdir/libpupil.so" | sed -n 's/.*soname: \[\(.*\)\]/\1/p')
[ "$soname" = "$expected" ] || { echo "check.sh: the soname is '$soname', not $expected"; exit 1; }
needed=$(readelf -d "$libdir/libpupil.so" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -v '^libc\.' || :)
[ -z "$needed" ] || { echo "check.sh: libpupil.so needs $needed"; exit 1; }

if [ -x "$prefix/bin/pupil" ]; then
    "$prefix/bin/pupil" --version
    for file in man/man1/pupil.1 bash-completion/completions/pupil; do
        [ -s "$prefix/share/$file" ] || { echo "check.sh: share/$file is not installed"; exit 1; }
    done
fi

# The Python module finds the library that was installed with it, and is where Python looks under this prefix.
module=$(find "$prefix" -type d -name pupil_ae)
if [ -n "$module" ] && python3 -c 'import numpy' 2>/dev/null; then
    PYTHONPATH=$(dirname "$module") PYTHONDONTWRITEBYTECODE=1 python3 -c 'import sys, pupil_ae
print(pupil_ae._library.lib._name)
sys.exit(not pupil_ae._library.lib._name.startswith(sys.argv[1]))' "$(realpath "$prefix")" || exit 1
fi

PKG_CONFIG_PATH=$libdir/pkgconfig
LD_LIBRARY_PATH=$libdir
export PKG_CONFIG_PATH LD_LIBRARY_PATH
for compiler in "gcc -std=c11" "g++ -std=c++11 -xc++"; do
    # Unquoted on purpose: words.
    $compiler -Wall -Wextra -Wpedantic -Werror "$here/consumer.c" -xnone $(pkg-config --cflags --libs pupil) \
        -o "$work/a.out"
    "$work/a.out"
    $compiler "$here/consumer.c" -xnone $(pkg-config --cflags pupil) "$libdir/libpupil.a" -o "$work/a.out"
    LD_LIBRARY_PATH= "$work/a.out"
done

# The camera's controls and its loop: the archive's visible symbols have its prefix. Of libpupil the controls need only
# headers, and the loop the calls of pupil/sensor.h.
archive=$libdir/libpupil-camera.a
foreign=$(nm -g --defined-only "$archive" | awk 'NF == 3 && $3 !~ /^pupil_camera_/ { print $3 }')
[ -z "$foreign" ] || { echo "check.sh: libpupil-camera.a defines" $foreign; exit 1; }
nm -g --defined-only "$archive" | awk 'NF == 3 { print $3 }' | sort >"$work/defined"
missing=$(nm -A -g --undefined-only "$archive" | awk '$NF ~ /^pupil/ && !(/:camera_loop\.c\.o:/ && $NF ~ /^pupil_sensor_/) { print $NF }' |
    sort -u | comm -23 - "$work/defined")
[ -z "$missing" ] || { echo "check.sh: libpupil-camera.a needs" $missing; exit 1; }
for header in camera_controls camera_loop; do
    grep -ohE '\bpupil_camera_[a-z_]+\(' "$prefix/include/pupil/$header.h" | tr -d '(' | sort -u >"$work/declared"
    [ -s "$work/declared" ] || { echo "check.sh: $header.h declares nothing"; exit 1; }
    absent=$(comm -23 "$work/declared" "$work/defined")
    [ -z "$absent" ] || { echo "check.sh: $header.h declares, and libpupil-camera.a lacks," $absent; exit 1; }
    for compiler in "gcc -std=c11" "g++ -std=c++11 -xc++"; do
        echo "#include <pupil/$header.h>" >"$work/alone.c"
        $compiler -Wall -Wextra -Wpedantic -Werror $(pkg-config --cflags pupil-camera) -c "$work/alone.c" \
            -o "$work/alone.o"
    done
done
# Alone in a program, and together with the static libpupil.
cat >"$work/loop.c" <<'END'
#include <pupil/camera_loop.h>

int main(void)
{
    static pupil_camera_loop loop;
    pupil_camera_loop_retry(&loop);
    return pupil_camera_loop_frame(&loop, 0, 0);
}
END
for compiler in "gcc -std=c11" "g++ -std=c++11 -xc++"; do
    $compiler "$work/loop.c" -xnone $(pkg-config --cflags --libs pupil-camera) -o "$work/loop"
    "$work/loop"
    $compiler "$work/loop.c" -xnone $(pkg-config --cflags pupil-camera) "$archive" "$libdir/libpupil.a" -lm -pthread \
        -o "$work/loop"
    LD_LIBRARY_PATH= "$work/loop"
done

# The examples, with the commands in their own comments, and as C++.
examples=$here/../../docs/examples
for name in meter_only decoder_i420 mat_bgr mono_y10p own_camera full; do
    packages=$(sed -n "s/.*cc $name\.c .(pkg-config --cflags --libs \([a-z -]*\))\( -lm\)* -o $name\( \*\/\)*\$/\1/p" "$examples/$name.c")
    [ -n "$packages" ] || { echo "check.sh: docs/examples/$name.c does not say how it is compiled"; exit 1; }
    for compiler in "gcc -std=gnu11" "g++ -std=c++11 -xc++"; do
        $compiler -Wall -Wextra -Wpedantic -Werror "$examples/$name.c" -xnone $(pkg-config --cflags --libs $packages) \
            -lm -o "$work/$name"
    done
done
if pkg-config --exists opencv4; then
    line=$(sed -n 's/^ \*  *\(c++ opencv_still.cpp .* -o opencv_still\).*/\1/p' "$examples/opencv_still.cpp")
    [ -n "$line" ] || { echo "check.sh: opencv_still.cpp does not say how it is compiled"; exit 1; }
    cp "$examples/opencv_still.cpp" "$work"
    (cd "$work" && eval "$line")
fi
head -c 16 /dev/zero | "$work/meter_only" 4 2
"$work/own_camera"
no_camera() {
    "$1" "$work/none" 2>"$work/log" && { echo "check.sh: $1 takes a camera that is not there"; exit 1; }
    grep -qF "full: $work/none: " "$work/log" || { cat "$work/log"; exit 1; }
}
no_camera "$work/full"

cmake -G Ninja -S "$here" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER=gcc -DCMAKE_CXX_COMPILER=g++ \
    >"$work/log" && cmake --build "$work/build" >>"$work/log" || { cat "$work/log"; exit 1; }
for program in c_shared c_static cxx_shared cxx_static; do
    "$work/build/$program"
done
no_camera "$work/build/c_camera"
no_camera "$work/build/cxx_camera"
echo "installed: $(cd "$prefix" && find . -type f | sort | tr '\n' ' ')"
