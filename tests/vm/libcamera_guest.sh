#!/bin/sh
# libcamera_guest.sh SHIM TEST CAMERA: in the guest of vm.libcamera. libcamera finds cameras that udevd has announced.
set -eu
modprobe -d "$MODULES" vhci-hcd
modprobe -d "$MODULES" uvcvideo
/lib/systemd/systemd-udevd --daemon 2>/dev/null
echo '\_SB_.PCI0.XHCI' >/run/firmware_node
export LD_PRELOAD="$1"
shift
exec "$@"
