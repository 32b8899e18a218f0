#!/bin/sh
# packaging.cross.ARCHITECTURE: test_cross.sh ARCHITECTURE TRIPLET QEMU: packages of another architecture are
# cross-built in a clean Debian, lintian reports nothing, and the program and the pkg-config example run in qemu's user
# mode.
set -eu
. "$(dirname "$0")/roots.sh"
architecture=$1
[ "$(dpkg --print-architecture)" != "$architecture" ] || { echo "skipped: this machine is $architecture"; exit 76; }
build_packages "$architecture"
cp "$tree/build/deb/$architecture"/*.deb "$tree/tests/packaging/crossed.sh" "$tree"/packaging/debian/tests/* "$work/"
rm -f "$work"/*-dbgsym*
CCACHE_DIR= sh "$tree/packaging/in-chroot.sh" "$tree/build/deb/root-$architecture" "$work" sh /build/crossed.sh "$@"
