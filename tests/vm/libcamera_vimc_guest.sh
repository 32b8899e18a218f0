#!/bin/sh
# libcamera_vimc_guest.sh VIMC.KO PROGRAM...: in the guest of vm.libcamera_vimc. vivid loads the kernel modules that
# vimc needs. libcamera finds cameras that udevd has announced.
set -e
/lib/systemd/systemd-udevd --daemon 2>/dev/null
modprobe -d "$MODULES" vivid n_devs=0 2>/dev/null || modprobe -d "$MODULES" vivid n_devs=1 node_types=0x1
insmod "$1"
shift
SYSTEMD_IGNORE_CHROOT=1 udevadm settle -t 20
exec "$@"
