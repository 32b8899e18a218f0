#!/bin/sh
# vm.run: test_run.sh NODE: boots the guest and runs the program on vivid there.
set -eu
. "$(dirname "$0")/amd64.sh"
in_guest "$here/capture_guest.sh" "$here/run_guest.sh" "$1" "$PUPIL_PROGRAM"
