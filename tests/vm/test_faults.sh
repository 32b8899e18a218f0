#!/bin/sh
# vm.faults: test_faults.sh PROGRAM: boots the guest and runs faults.c there.
set -eu
. "$(dirname "$0")/amd64.sh"
in_guest "$here/capture_guest.sh" "$1"
