#!/bin/sh
# packaging.debian: packages of this tree are built in a clean Debian, lintian reports nothing, and in another clean
# Debian they are installed, work, and leave nothing when purged.
set -eu
. "$(dirname "$0")/roots.sh"
build_packages "$(dpkg --print-architecture)"
clean_root
folder=$tree/build/deb/$(dpkg --print-architecture)
cp "$folder"/*.deb "$folder"/*.dsc "$folder"/*.tar.xz "$tree/tests/packaging/installed.sh" "$work/"
rm -f "$work"/*-dbgsym*
cp "$tree/packaging/debian/tests/control" "$work/debian-tests-control"
CCACHE_DIR= sh "$tree/packaging/in-chroot.sh" "$clean" "$work" sh /build/installed.sh
[ ! -s "$folder/lintian.txt" ] || { echo "lintian:"; cat "$folder/lintian.txt"; }
echo "$(cd "$folder" && ls -- *.deb | grep -v dbgsym)"
