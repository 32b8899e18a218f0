#!/bin/sh
# vm.libcamera: test_libcamera.sh SHIM TEST CAMERA EXAMPLE: boots the guest and runs libcamera.c and the example there.
set -eu
. "$(dirname "$0")/amd64.sh"
[ -x /lib/systemd/systemd-udevd ] || {
    echo "skipped: no udevd: the packages are listed in test.sh"
    exit 77
}
in_guest "$here/libcamera_guest.sh" "$@"
