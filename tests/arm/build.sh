# build.sh: for test_instructions.sh and model.sh, which run in this folder. arm_build DIR [LIBRARY] builds into DIR,
# with the flags that the library ships with: the library for 64-bit ARM (DIR/library), count_arm and count_plugin.so.
# LIBRARY: a libpupil.a that was built with them before. It exits with 77 where a tool is missing.
arm_build() {
    into=$1 library=${2:-}
    tree=$(cd ../.. && pwd)
    for tool in aarch64-linux-gnu-gcc qemu-aarch64 cmake; do
        command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
    done
    qemu-aarch64 -help 2>&1 | grep -q -e '-plugin' || { echo "skipped: this qemu-aarch64 takes no plugins"; exit 77; }
    {
        if [ -z "$library" ]; then
            library=$into/library/lib/libpupil.a
            cmake -G Ninja -S "$tree" -B "$into/library" -DCMAKE_BUILD_TYPE=Release -DPUPIL_PROGRAM=OFF \
                -DPUPIL_INSTALL=OFF -DCMAKE_TOOLCHAIN_FILE="$tree/cmake/aarch64-linux-gnu.cmake" &&
                cmake --build "$into/library" --target pupil_static -j 2
        fi &&
            aarch64-linux-gnu-gcc -O2 -std=gnu11 -D_GNU_SOURCE -Wall -Wextra -Werror -static \
                -I"$tree/lib/include" -I"$tree/lib" \
                "$tree/tests/arm/count.c" "$library" -o "$into/count_arm" &&
            ${CC:-cc} -O2 -shared -fPIC "$tree/tests/arm/count_plugin.c" -o "$into/count_plugin.so"
    } >"$into/build.log" 2>&1 || {
        tail -n 40 "$into/build.log"
        echo "FAILED: the library, count.c or count_plugin.c does not build for 64-bit ARM"
        exit 1
    }
}

# arm_count DIR WHAT [,blocks=on]: what count_arm prints, with the numbers of instructions. The CPU is named because the
# C library chooses its memcpy by it.
arm_count() {
    qemu-aarch64 -cpu cortex-a53 -plugin "$1/count_plugin.so${3:-}" "$1/count_arm" "$2"
}
