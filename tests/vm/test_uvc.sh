#!/bin/sh
# vm.uvc: test_uvc.sh TEST CAMERA NODE: boots the guest and runs uvc.c and the program there, with the camera.
set -eu
. "$(dirname "$0")/amd64.sh"
in_guest "$here/uvc_guest.sh" "$@" "$PUPIL_PROGRAM"
