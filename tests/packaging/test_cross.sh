#!/bin/sh
# packaging.cross: packages for 64-bit and 32-bit ARM are cross-built in a clean Debian, lintian has nothing against them,
# and the program and the example of pkg-config run in qemu's user mode.
set -eu
. "$(dirname "$0")/roots.sh"
for architecture in arm64 armhf; do
    [ "$(dpkg --print-architecture)" != $architecture ] || continue
    case $architecture in
    arm64) triplet=aarch64-linux-gnu qemu=qemu-aarch64 ;;
    armhf) triplet=arm-linux-gnueabihf qemu=qemu-arm ;;
    esac
    build_packages $architecture
    rm -rf "${work:?}"/*
    cp "$tree/build/deb/$architecture"/*.deb "$tree/tests/packaging/crossed.sh" "$tree"/packaging/debian/tests/* "$work/"
    rm -f "$work"/*-dbgsym*
    CCACHE_DIR= sh "$tree/packaging/in-chroot.sh" "$tree/build/deb/root-$architecture" "$work" \
        sh /build/crossed.sh $architecture $triplet $qemu
done
