#!/bin/sh
# in-chroot.sh ROOT FOLDER COMMAND...: runs the command as root in the Debian system that is in ROOT, where FOLDER is
# /build. Files that it writes elsewhere are in memory, and are lost when it ends. Exits with its status. CCACHE_DIR, if
# set, is /ccache.
set -eu
[ $# -ge 3 ] || { echo "usage: $0 ROOT FOLDER COMMAND..." >&2; exit 2; }
[ "$(id -u)" = 0 ] || { echo "$0: needs root" >&2; exit 1; }
root=$(cd "$1" && pwd)
folder=$(cd "$2" && pwd)
shift 2
above=$(mktemp -d)
trap 'rmdir "$above"' EXIT
trap 'exit 130' INT TERM
status=0
# The mounts belong to the new namespace, and end with it.
unshare --mount --pid --fork --kill-child sh -euc '
    above=$1 root=$2 folder=$3 ccache=$4
    shift 4
    mount -t tmpfs above "$above" -o size=90%
    mkdir "$above/upper" "$above/work" "$above/root"
    mount -t overlay overlay -o "lowerdir=$root,upperdir=$above/upper,workdir=$above/work" "$above/root"
    root=$above/root
    mkdir -p "$root/build"
    mount --bind "$folder" "$root/build"
    mount -t proc proc "$root/proc"
    mount -t sysfs -o ro sysfs "$root/sys" 2>/dev/null || :
    mount --rbind /dev "$root/dev"
    [ -z "$ccache" ] || { mkdir "$root/ccache"; mount --bind "$ccache" "$root/ccache"; }
    cp /etc/resolv.conf "$root/etc/" 2>/dev/null || :
    cd /
    exec chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive "$@"
' _ "$above" "$root" "$folder" "${CCACHE_DIR:-}" "$@" || status=$?
exit $status
