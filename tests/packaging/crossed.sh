#!/bin/sh
# crossed.sh ARCHITECTURE TRIPLET QEMU: in the Debian that built them (test_cross.sh): packages of another architecture
# are installed and work in qemu's user mode.
set -eu
architecture=$1 triplet=$2 qemu=$3
cd /build
apt-get -qq update
apt-get -qq install -y --no-install-recommends qemu-user ffmpeg ./pupil_*.deb ./libpupil*.deb >install.log 2>&1 ||
    { tail -n 20 install.log; exit 1; }
file=$(readelf -h /usr/bin/pupil | sed -n 's/ *Machine: *//p')
echo "$architecture: /usr/bin/pupil is for $file"
export RUN="$qemu" CC="$triplet-gcc" PKG_CONFIG_LIBDIR="/usr/lib/$triplet/pkgconfig:/usr/share/pkgconfig"
for test in program library; do
    AUTOPKGTEST_TMP=$(mktemp -d)
    export AUTOPKGTEST_TMP
    sh /build/$test >$test.log 2>&1 || { echo "$test:"; tail -n 20 $test.log; exit 1; }
    echo "$architecture: $test: $(tail -n 1 $test.log)"
done
