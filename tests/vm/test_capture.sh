#!/bin/sh
# vm.capture: test_capture.sh PROGRAM: boots the guest and runs capture.c there.
set -eu
. "$(dirname "$0")/amd64.sh"
in_guest "$here/capture_guest.sh" "$1"
