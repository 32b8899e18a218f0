#!/bin/sh
# boot.sh ARCHITECTURE FOLDER SECONDS COMMAND...: boots the guest that make_guest.sh made in FOLDER, runs the command in
# it, and exits with its status; what it printed is printed. 124: it did not end in time. 125: the guest failed
# otherwise. COMMAND is an absolute path, and no word contains blanks (they are words of the kernel's command line).
#
# The guest sees the files of this machine, read-only, at the same paths; of another architecture those in $GUEST_ROOT.
# Always emulated (TCG), so that it is the same everywhere; one processor, which is faster there than two.
set -eu
architecture=$1
folder=$2
seconds=$3
shift 3
for word; do
    case $word in
    *[[:space:]\"]*)
        echo "$0: the guest's command cannot have blanks in a word: '$word'" >&2
        exit 2
        ;;
    esac
done

case $architecture in
amd64) qemu="qemu-system-x86_64 -machine q35 -cpu max" console=ttyS0 ;;
arm64) qemu="qemu-system-aarch64 -machine virt -cpu cortex-a76" console=ttyAMA0 ;;
*)
    echo "$0: no guest for $architecture: amd64 and arm64 are known" >&2
    exit 2
    ;;
esac
command -v "${qemu%% *}" >/dev/null || {
    echo "skipped: no ${qemu%% *}: the packages are listed in test.sh"
    exit 77
}

log=$folder/log.$$
trap 'rm -f "$log"' EXIT
status=0
# Unquoted on purpose.
timeout -k 5 "$seconds" $qemu -accel tcg -smp 1 -m 768 -nodefaults -no-user-config -display none -no-reboot \
    -serial stdio -kernel "$folder/vmlinuz" -initrd "$folder/initrd" \
    -virtfs "local,path=${GUEST_ROOT:-/},mount_tag=host,security_model=none,readonly=on,multidevs=remap" \
    -append "console=$console panic=-1 quiet mitigations=off -- $*" </dev/null >"$log" 2>&1 || status=$?
tr -d '\r' <"$log"
[ "$status" != 124 ] || {
    echo "$0: not done within $seconds s" >&2
    exit 124
}
status=$(tr -d '\r' <"$log" | sed -n 's/^guest: status \([0-9]*\)$/\1/p' | tail -n 1)
exit "${status:-125}"
