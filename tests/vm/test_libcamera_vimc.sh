#!/bin/sh
# vm.libcamera_vimc: test_libcamera_vimc.sh PROGRAM: boots the guest and runs libcamera_vimc.c there.
set -eu
. "$(dirname "$0")/amd64.sh"
[ -x /lib/systemd/systemd-udevd ] && ls /usr/lib/*/libcamera/ipa_vimc.so >/dev/null 2>&1 || {
    echo "skipped: no udevd, or no libcamera-ipa: the packages are listed in test.sh"
    exit 77
}
sh "$here/make_guest.sh" amd64 "$guest"
sh "$here/make_vimc.sh" "$guest"
in_guest "$here/libcamera_vimc_guest.sh" "$guest/vimc.ko" "$1"
