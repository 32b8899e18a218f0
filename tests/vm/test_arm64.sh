#!/bin/sh
# vm.arm64: builds the drivers, the program and capture.c for 64-bit ARM, statically and only with the C library, boots
# Debian's arm64 kernel, and runs them there on vivid.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
tree=$here/../..
guest=$tree/build/vm/arm64
for tool in aarch64-linux-gnu-gcc cmake ninja; do
    command -v $tool >/dev/null || {
        echo "skipped: no $tool: the packages are listed in test.sh"
        exit 77
    }
done
sh "$here/make_guest.sh" arm64 "$guest"

build=$guest/build
off=$(for part in INSTALL MEDIA GPU SHARED LAB; do echo "-DPUPIL_$part=OFF"; done)
{
    # Unquoted on purpose.
    cmake -G Ninja -S "$tree" -B "$build" -DCMAKE_BUILD_TYPE=Release $off -DPUPIL_WERROR=OFF \
        -DCMAKE_EXE_LINKER_FLAGS=-static -DCMAKE_TOOLCHAIN_FILE="$tree/cmake/aarch64-linux-gnu.cmake" &&
        cmake --build "$build" --target pupil -j 2 &&
        aarch64-linux-gnu-gcc -O2 -std=gnu11 -D_GNU_SOURCE -Wall -Wextra -Werror -static -pthread \
            -I"$tree/tests" -I"$tree/lib/include" -I"$tree/drivers" -I"$tree/drivers/include" \
            "$here/capture.c" "$here/node.c" "$here/vgem.c" "$build/drivers/libpupil_drivers.a" \
            "$build/drivers/v4l2/controls/libpupil-camera.a" "$build/lib/libpupil.a" -lm -o "$guest/capture"
} >"$guest/build.log" 2>&1 || {
    tail -n 40 "$guest/build.log"
    echo "FAILED: the drivers, the program or capture.c does not build for 64-bit ARM"
    exit 1
}

# All files of the guest.
root=$guest/root
rm -rf "$root"
mkdir -p "$root/dev" "$root/proc" "$root/sys" "$root/run" "$root/bin" "$root/lib"
cp "$guest/busybox" "$guest/capture" "$build/apps/pupil" "$here/capture_guest.sh" "$here/arm64_guest.sh" "$root/bin"
for tool in sh cat cut grep head sleep tail wc; do
    ln -s busybox "$root/bin/$tool"
done
ln -s /run/modules/lib/modules "$root/lib/modules"
GUEST_ROOT=$root sh "$here/boot.sh" arm64 "$guest" 300 /bin/arm64_guest.sh
