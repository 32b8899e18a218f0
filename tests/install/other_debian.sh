#!/bin/sh
# other_debian.sh SUITE: ./test.sh quick of this checkout's last commit, in a clean Debian of that release: with its
# compilers, FFmpeg, Mesa and libcamera. The Debian is gone at the end.
set -eu
suite=$1
tree=$(cd "$(dirname "$0")/../.." && pwd)
command -v mmdebstrap >/dev/null || { echo "skipped: no mmdebstrap: the packages are listed in test.sh"; exit 77; }
[ "$(id -u)" = 0 ] || { echo "skipped: a clean Debian needs root"; exit 76; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM
git clone --quiet "$tree" "$work/pupil"
TMPDIR=$work mmdebstrap --quiet --variant=minbase --include=ca-certificates,git --format=null \
    --customize-hook="copy-in $work/pupil /" \
    --customize-hook='chroot "$1" sh -c "cd /pupil && git config --global safe.directory /pupil && ./test.sh quick"' \
    "$suite" /dev/null ${DEBIAN_SOURCE:+"$DEBIAN_SOURCE"}
