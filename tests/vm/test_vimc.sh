#!/bin/sh
# vm.vimc: test_vimc.sh PROGRAM: boots the guest and runs vimc.c there.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
guest=$here/../../build/vm/amd64
[ "$(uname -m)" = x86_64 ] || {
    echo "skipped: the program is of this machine, and there is a guest for amd64 alone"
    exit 77
}
sh "$here/make_guest.sh" amd64 "$guest"
sh "$here/make_vimc.sh" "$guest"
sh "$here/boot.sh" amd64 "$guest" 300 "$here/vimc_guest.sh" "$guest/vimc.ko" "$1"
