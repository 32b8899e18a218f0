#!/bin/sh
# check.sh BUILD: installs BUILD into an empty folder, moves that, and builds and runs programs against what lies there:
# by pkg-config and by find_package, in C and in C++, with the shared and with the static library.
set -eu
build=$1
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/first" >"$work/log" || { cat "$work/log"; exit 1; }
mv "$work/first" "$work/moved" # the files find each other wherever the tree lies
prefix=$work/moved

libdir=$(dirname "$(find "$prefix" -name libpupil.a)")
[ -e "$libdir/libpupil.so.0" ] || { echo "check.sh: no libpupil.so.0 is installed"; exit 1; }
soname=$(readelf -d "$libdir/libpupil.so" | sed -n 's/.*soname: \[\(.*\)\]/\1/p')
[ "$soname" = libpupil.so.0 ] || { echo "check.sh: the soname is '$soname', not libpupil.so.0"; exit 1; }
needed=$(readelf -d "$libdir/libpupil.so" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -v '^libc\.' || :)
[ -z "$needed" ] || { echo "check.sh: libpupil.so needs $needed"; exit 1; }

if [ -x "$prefix/bin/pupil" ]; then
    "$prefix/bin/pupil" --version
    [ -s "$prefix/share/man/man1/pupil.1" ] || { echo "check.sh: no man page is installed"; exit 1; }
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

cmake -G Ninja -S "$here" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER=gcc -DCMAKE_CXX_COMPILER=g++ \
    >"$work/log" && cmake --build "$work/build" >>"$work/log" || { cat "$work/log"; exit 1; }
for program in c_shared c_static cxx_shared cxx_static; do
    "$work/build/$program"
done
echo "installed: $(cd "$prefix" && find . -type f | sort | tr '\n' ' ')"
