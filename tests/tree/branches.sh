#!/bin/sh
# branches.sh BUILD lib|drivers: builds for coverage in BUILD, runs tests of the rooms below, and fails unless each way
# of each branch in these rooms ran, except those of branches.txt, and as many ran as that file says.
set -eu
build=$1
mkdir -p "$build"
case $2 in
lib)
    rooms="lib/base lib/core lib/flicker lib/kernels lib/look lib/sensor"
    tests='^((core|look|flicker|sensor|stream|veil)[.]|kernels[.](levels|pieces|scalar)$|row_gain[.]map$)'
    without='^$'
    targets="tests/core/all tests/look/all tests/flicker/all tests/sensor/all tests/stream/all tests/veil/all
        test_kernels_levels test_kernels_pieces test_kernels_scalar test_row_gain_map"
    labels='^quick$'
    not_labels='^sweep$' # nothing that other tests do not reach, and takes minutes without optimisation
    flags=
    options="-DPUPIL_PROGRAM=OFF -DPUPIL_GPU=OFF -DPUPIL_MEDIA=OFF -DPUPIL_PYTHON=OFF"
    ;;
drivers)
    rooms="drivers drivers/colour drivers/egl drivers/file drivers/gstreamer drivers/libcamera drivers/live drivers/raw
        drivers/synth drivers/v4l2 drivers/window"
    tests='^(drivers|gstreamer[.]|gles[.](context|external|window|egl14)$)'
    targets="tests/drivers/all tests/gstreamer/all test_gles_context test_gles_external test_gles_window test_gles_egl14"
    labels='^(quick|full)$'
    not_labels='^$'
    without='_images$|valgrind' # of all pixels, and in valgrind: minutes without optimisation
    # Branches of GLib's and GStreamer's macros do not count.
    flags="-DG_DISABLE_CAST_CHECKS -DG_DISABLE_CHECKS -DG_DISABLE_ASSERT -DGST_LEVEL_MAX=GST_LEVEL_NONE"
    options="-DPUPIL_PYTHON=OFF"
    ;;
esac
coverage="-O0 --coverage -fprofile-update=atomic $flags"
# shellcheck disable=SC2086 # a list
cmake --preset coverage -B "$build" $options -DCMAKE_C_FLAGS="$coverage" -DCMAKE_CXX_FLAGS="$coverage" \
    >"$build.log" 2>&1 || { cat "$build.log"; exit 1; }
# shellcheck disable=SC2086 # a list
cmake --build "$build" -j "$(nproc)" --target $targets >>"$build.log" 2>&1 || { tail -40 "$build.log"; exit 1; }
find "$build" -name '*.gcda' -exec rm -f {} +
ctest --test-dir "$build" -L "$labels" -LE "$not_labels" -R "$tests" -E "$without" -j "$(nproc)" >>"$build.log" 2>&1 ||
    { tail -40 "$build.log"; exit 1; }
# shellcheck disable=SC2086 # a list
exec python3 cmake/branches.py --unreached tests/tree/branches.txt "$build" $rooms
