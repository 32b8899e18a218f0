#!/bin/sh
# libcamera_guest.sh SHIM TEST CAMERA EXAMPLE: in the guest of vm.libcamera: libcamera.c, then
# docs/examples/libcamera_loop.cpp. libcamera finds cameras that udevd has announced.
set -eu
modprobe -d "$MODULES" vhci-hcd
modprobe -d "$MODULES" uvcvideo
/lib/systemd/systemd-udevd --daemon 2>/dev/null
echo '\_SB_.PCI0.XHCI' >/run/firmware_node
export LD_PRELOAD="$1"
"$2" "$3"
"$3" display slow &
sleep 5
timeout 60 "$4" >/run/example.txt
tail -n 3 /run/example.txt
[ "$(wc -l </run/example.txt)" -ge 20 ] && tail -n 1 /run/example.txt | grep -q '^converged '
