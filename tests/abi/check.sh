#!/bin/sh
# check.sh: the ABI of the public headers is that of abi.txt, and the objects have room to grow (fill.c). check.sh
# --update: writes abi.txt. Before the first release of a soname (libpupil.so.0.MINOR) anything may change. Afterwards
# lines may only be added: fields at the end of a struct that begins with size_bytes, enumerators, functions. The sizes
# of these structs and enumerators in _COUNT grow with them. Everything else needs another soname.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
lib=$here/../../lib
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
case $(uname -m) in
x86_64 | aarch64) ;;
*) echo "skipped: abi.txt is that of 64-bit machines"; exit 77 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 "$here/abi.py" "$lib/include" >"$work/abi.txt"
if [ "${1:-}" = --update ]; then
    cp "$work/abi.txt" "$here/abi.txt"
elif ! diff -u "$here/abi.txt" "$work/abi.txt"; then
    echo "check.sh: the ABI is not that of tests/abi/abi.txt."
    echo "tests/abi/check.sh --update writes that file; its head says when one may."
    exit 1
fi
echo "$(grep -c '^[a-z_]*: [0-9]* bytes' "$work/abi.txt") structs and objects, $(wc -l <"$work/abi.txt") lines"
gles=
echo '#include <GLES3/gl31.h>' | cc -E - >"$work/log" 2>&1 && gles=-DWITH_GLES
cc -std=c11 $gles -I"$lib/include" -I"$lib" "$here/fill.c" -o "$work/fill"
"$work/fill" || { echo "check.sh: less than an eighth of an object is left"; exit 1; }
