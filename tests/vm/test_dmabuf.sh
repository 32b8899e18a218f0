#!/bin/sh
# vm.dmabuf: test_dmabuf.sh PROGRAM: boots the guest and runs dmabuf.c there.
set -eu
. "$(dirname "$0")/amd64.sh"
ls /usr/lib/*/dri/swrast_dri.so >/dev/null 2>&1 || {
    echo "skipped: no OpenGL ES in software (libgl1-mesa-dri): the packages are listed in test.sh"
    exit 77
}
in_guest "$here/dmabuf_guest.sh" "$1"
