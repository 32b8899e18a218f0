#!/bin/sh
# vm.vimc: test_vimc.sh PROGRAM: boots the guest and runs vimc.c there.
set -eu
. "$(dirname "$0")/amd64.sh"
sh "$here/make_guest.sh" amd64 "$guest"
sh "$here/make_vimc.sh" "$guest"
in_guest "$here/vimc_guest.sh" "$guest/vimc.ko" "$1"
