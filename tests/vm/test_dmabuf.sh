#!/bin/sh
# vm.dmabuf: test_dmabuf.sh PROGRAM: boots the guest and runs dmabuf.c there.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
guest=$here/../../build/vm/amd64
[ "$(uname -m)" = x86_64 ] || {
    echo "skipped: the program is of this machine, and there is a guest for amd64 alone so far"
    exit 77
}
ls /usr/lib/*/dri/swrast_dri.so >/dev/null 2>&1 || {
    echo "skipped: no OpenGL ES in software (libgl1-mesa-dri): the packages are listed in test.sh"
    exit 77
}
sh "$here/make_guest.sh" amd64 "$guest"
sh "$here/boot.sh" amd64 "$guest" 600 "$here/dmabuf_guest.sh" "$1"
