#!/bin/sh
# vimc_guest.sh VIMC.KO PROGRAM...: in the guest of vm.vimc. vivid loads the kernel modules that vimc needs.
set -e
modprobe -d "$MODULES" vivid n_devs=0 2>/dev/null || modprobe -d "$MODULES" vivid n_devs=1 node_types=0x1
insmod "$1"
shift
exec "$@"
