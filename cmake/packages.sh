# packages.sh: for demo.sh and test.sh. install_missing LINES: each line is a Debian package and what it is for; those
# that dpkg does not know as installed are named and installed.
install_missing() {
    # Before a long installation: what the build writes.
    mkdir -p build && [ -w build ] || {
        echo "$0: $(pwd)/build cannot be written: use a copy of the sources that is yours" >&2
        exit 1
    }
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null || {
        echo "$0: this is not a Debian: install what docs/dependencies.md lists, then run the commands at the end of $0" >&2
        exit 1
    }
    missing=$(echo "$1" | while read -r package reason; do
        [ -n "$package" ] || continue
        status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || :)
        [ "$status" = installed ] || echo "$package $reason"
    done)
    [ -n "$missing" ] || return 0
    echo "== installing what is missing"
    echo "$missing" | sed 's/ /: /; s/^/   /'
    packages=$(echo "$missing" | sed 's/ .*//')
    as_root=env
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null || {
            echo "$0: packages are missing, and there is no sudo; as root:" >&2
            # Words, on purpose.
            echo "    apt-get update && apt-get install -y --no-install-recommends" $packages >&2
            exit 1
        }
        as_root="sudo env"
    fi
    apt_log=build/apt.log
    $as_root DEBIAN_FRONTEND=noninteractive apt-get update -qq </dev/null >"$apt_log" 2>&1 ||
        apt_failed "apt-get update failed: is this machine online, and /etc/apt/sources.list right?"
    # apt-get update ends well where no server was reached, too.
    grep -q '^W: Failed to fetch' "$apt_log" && offline="; a package server was not reached" || offline=
    $as_root DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends $packages </dev/null \
        >>"$apt_log" 2>&1 || apt_failed "apt-get install failed$offline"
}

# apt_failed SENTENCE
apt_failed() {
    tail -n 30 "$apt_log" >&2
    echo "$0: $1; the whole output is in $(pwd)/$apt_log" >&2
    exit 1
}

# What the program is built with and from; docs/dependencies.md has licences and the options that do without.
packages_of_the_program='
gcc the C compiler
libc6-dev the C library
cmake writes the build files
ninja-build runs the build
pkg-config finds the libraries
libopenexr-dev reads EXR
libpng-dev reads and writes PNG
libavformat-dev reads and writes video files, recordings among them
libavcodec-dev decodes and encodes video
libavutil-dev goes with the two above
libraw-dev reads DNG and the raw files of cameras
liblcms2-dev reads the ICC profiles of pictures
libcjson-dev writes statistics as JSON, and what a recording says of its frames
libegl-dev makes contexts of OpenGL ES without a window
libgles-dev the headers of OpenGL ES
libcamera-dev the cameras of libcamera
g++ compiles the file that calls libcamera
libsdl2-dev opens the window of --view
libegl1 finds the driver of OpenGL ES
libgles2 OpenGL ES itself
libgl1-mesa-dri its drivers, and one for the CPU
gnuplot-nox draws the plots
python3 builds the module pupil_ae
libgstreamer-plugins-base1.0-dev is what the GStreamer plugin is built with
'

# What makes the page, pupil.html.
packages_of_the_page='
clang makes WebAssembly of the core; for tests the second compiler, sanitizers and fuzzers
lld links it
llvm puts its objects together; for tests it names functions in what a sanitizer reports
'

# What the examples and tests of pupil/opencv.hpp, pupil_ae and the GStreamer plugin need; those who use them have it.
packages_of_integrations='
python3-numpy has the arrays of the module pupil_ae
python3-opencv reads video for its example
libopencv-dev is what pupil/opencv.hpp is compiled with
gstreamer1.0-tools has gst-launch-1.0 and gst-inspect-1.0
gstreamer1.0-plugins-base has the elements around pupilae in tests
gstreamer1.0-plugins-good has v4l2src and pngenc
gstreamer1.0-plugins-ugly has x264enc
valgrind looks for memory that the plugin does not free
'
