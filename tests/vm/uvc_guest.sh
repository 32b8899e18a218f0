#!/bin/sh
# uvc_guest.sh TEST CAMERA PUPIL: in the guest. A USB port that has its far end in user space.
set -e
modprobe -d "$MODULES" vhci-hcd
modprobe -d "$MODULES" uvcvideo
"$1" "$2"
