SUMMARY = "Camera-style auto-exposure for HDR frames"
DESCRIPTION = "A library that meters the light of each frame, adapts over time and maps the frame to a display, \
and a program that controls the exposure and the gain of cameras with it."
SECTION = "multimedia"
LICENSE = "BSD-2-Clause"
LIC_FILES_CHKSUM = "file://LICENSE;md5=52a9eff13ed63109c8ba5d1679498732"

# the tree that this recipe is in; with a release: SRC_URI instead
inherit externalsrc
EXTERNALSRC = "${THISDIR}/../.."

inherit cmake pkgconfig systemd

# The kernels are vectorised at -O3, which CMake's build type Release sets for their files.
EXTRA_OECMAKE = "-DCMAKE_BUILD_TYPE=Release -DPUPIL_PYTHON=OFF"

PACKAGECONFIG ??= "program"
PACKAGECONFIG[program] = "-DPUPIL_PROGRAM=ON,-DPUPIL_PROGRAM=OFF"
PACKAGECONFIG[media] = "-DPUPIL_MEDIA=ON,-DPUPIL_MEDIA=OFF,cjson ffmpeg libpng openexr"
PACKAGECONFIG[gpu] = "-DPUPIL_GPU=ON,-DPUPIL_GPU=OFF,virtual/egl virtual/libgles2 libsdl2"
PACKAGECONFIG[gstreamer] = "-DPUPIL_GSTREAMER=ON,-DPUPIL_GSTREAMER=OFF,gstreamer1.0 gstreamer1.0-plugins-base"
PACKAGECONFIG[libcamera] = "-DPUPIL_LIBCAMERA=ON,-DPUPIL_LIBCAMERA=OFF,libcamera"
EXTRA_OECMAKE += "${@bb.utils.contains('DISTRO_FEATURES', 'systemd', '-DPUPIL_SYSTEMD_DIR=${systemd_system_unitdir}', '-DPUPIL_SYSTEMD_DIR=', d)} \
    -DPUPIL_UDEV_DIR=${nonarch_base_libdir}/udev/rules.d"

PACKAGES =+ "${PN}-program gstreamer1.0-${PN}"
FILES:${PN}-program = "${bindir} ${datadir}/bash-completion ${nonarch_base_libdir}/udev ${systemd_system_unitdir}"
FILES:gstreamer1.0-${PN} = "${libdir}/gstreamer-1.0/*.so"
# The unit is a template: no instance is enabled by the package.
SYSTEMD_PACKAGES = "${PN}-program"
SYSTEMD_SERVICE:${PN}-program = "pupil@.service"
SYSTEMD_AUTO_ENABLE = "disable"
