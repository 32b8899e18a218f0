#!/bin/sh
# test.sh [quick|long]: on a bare Debian 12, installs what the tests need, builds, and runs tests. The last lines are
# ctest's. On two processors:
#   test.sh        the tests labelled quick and full, which CI runs: 25 minutes at most, with installing and building
#   test.sh quick  those labelled quick: 90 s if installed and built before; also on Debian 13
#   test.sh long   every test
# tests/CMakeLists.txt says what the labels mean.
set -eu
cd "$(dirname "$0")"
. cmake/packages.sh

# All that the tests need is installed below, so none may be skipped (tests/run_test.sh); with quick, tests may be.
export PUPIL_TESTS_REQUIRE=1
packages_of_long_tests='gcc-i686-linux-gnu builds for 32-bit x86
libc6-dev-i386-cross the C library for 32-bit x86
gcc-arm-linux-gnueabihf builds for 32-bit ARM
libc6-dev-armhf-cross the C library for 32-bit ARM
gcc-s390x-linux-gnu builds for s390x
libc6-dev-s390x-cross the C library for s390x
gcc-riscv64-linux-gnu builds for 64-bit RISC-V
libc6-dev-riscv64-cross the C library for 64-bit RISC-V
parallel runs ranges of frames side by side
snakemake does so, too
slurmctld is a cluster of one machine
slurmd runs its tasks
slurm-client submits them
munge signs what they send
mmdebstrap makes clean Debians, in which packages are built and tried
chromium opens the page
chromium-driver types, drags and looks there
python3-selenium tells it what to do'
more=
case ${1:-full} in
full) selection="-L ^(quick|full)$" ;;
quick) selection="-L ^quick$" && unset PUPIL_TESTS_REQUIRE ;;
long) selection= && more=$packages_of_long_tests ;;
*)
    echo "usage: $0 [quick|long]" >&2
    exit 2
    ;;
esac

install_missing "$packages_of_the_program
libclang-rt-dev what clang links for sanitizers and libFuzzer
clang-format checks the style
git lists the files whose style is checked
gcc-aarch64-linux-gnu builds for 64-bit ARM
libc6-dev-arm64-cross the C library for 64-bit ARM
qemu-user runs what was built for 64-bit ARM, and counts its instructions
libsimde-dev stands in for instructions that this CPU may not have
gcc-arm-none-eabi builds for Cortex-M7
qemu-system-arm runs what was built for Cortex-M7, and boots 64-bit ARM
qemu-system-x86 boots the virtual machine of tests/vm
cpio packs what it boots from
kmod finds the drivers that it needs
udev announces cameras there, as libcamera needs it
libcamera-ipa has what libcamera needs of the simulated sensor there
strace tells which system calls a program makes there
xz-utils unpacks its kernel
make builds a driver that Debian does not ship
abigail-tools compares the library's interface with that of the last release
libelf1 goes with what builds it
glslang-tools checks the shaders
ffmpeg makes clips of all kinds, and judges them
xvfb is the screen that windows open on
xdotool types their keys
imagemagick takes and reads pictures of that screen
musl-tools builds with musl in place of glibc
$packages_of_integrations
$packages_of_the_page
nodejs runs the digests and the page's readers as WebAssembly
$more"

echo "== building into build/dev; the output goes to build/test.log"
{ cmake --preset dev && cmake --build --preset dev; } >build/test.log 2>&1 </dev/null || {
    tail -n 40 build/test.log >&2
    echo "$0: the build failed; all of its output is in build/test.log" >&2
    exit 1
}

echo "== testing"
# One more than there are processors, because some tests wait for cameras or time. $selection is split on purpose.
exec ctest --test-dir build/dev --output-on-failure -j "$(($(nproc) + 1))" $selection </dev/null
