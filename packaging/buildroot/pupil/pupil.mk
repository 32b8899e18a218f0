################################################################################
#
# pupil
#
################################################################################

PUPIL_VERSION = 0.2.0
# the tree that this folder is in
PUPIL_SITE = $(BR2_EXTERNAL_PUPIL_PATH)/../..
PUPIL_SITE_METHOD = local
PUPIL_OVERRIDE_SRCDIR_RSYNC_EXCLUSIONS = --exclude build
PUPIL_LICENSE = BSD-2-Clause
PUPIL_LICENSE_FILES = LICENSE
PUPIL_INSTALL_STAGING = YES
PUPIL_SUPPORTS_IN_SOURCE_BUILD = NO

# The kernels are vectorised at -O3, which CMake's build type Release sets for their files.
PUPIL_CONF_OPTS = \
	-DCMAKE_BUILD_TYPE=Release \
	-DPUPIL_PYTHON=OFF \
	-DPUPIL_SHARED=$(if $(BR2_STATIC_LIBS),OFF,ON) \
	-DPUPIL_STATIC=$(if $(BR2_SHARED_LIBS),OFF,ON) \
	-DPUPIL_PROGRAM=$(if $(BR2_PACKAGE_PUPIL_PROGRAM),ON,OFF) \
	-DPUPIL_MEDIA=$(if $(BR2_PACKAGE_PUPIL_MEDIA),ON,OFF) \
	-DPUPIL_GPU=$(if $(BR2_PACKAGE_PUPIL_GPU),ON,OFF) \
	-DPUPIL_GSTREAMER=$(if $(BR2_PACKAGE_PUPIL_GSTREAMER),ON,OFF) \
	-DPUPIL_LIBCAMERA=$(if $(BR2_PACKAGE_LIBCAMERA),ON,OFF) \
	-DPUPIL_SYSTEMD_DIR=$(if $(BR2_INIT_SYSTEMD),lib/systemd/system) \
	-DPUPIL_UDEV_DIR=$(if $(BR2_PACKAGE_HAS_UDEV),lib/udev/rules.d)

PUPIL_DEPENDENCIES = host-pkgconf
ifeq ($(BR2_PACKAGE_PUPIL_MEDIA),y)
PUPIL_DEPENDENCIES += cjson ffmpeg libpng openexr $(if $(BR2_PACKAGE_LCMS2),lcms2) $(if $(BR2_PACKAGE_LIBRAW),libraw)
endif
ifeq ($(BR2_PACKAGE_PUPIL_GPU),y)
PUPIL_DEPENDENCIES += libegl libgles sdl2
endif
ifeq ($(BR2_PACKAGE_PUPIL_GSTREAMER),y)
PUPIL_DEPENDENCIES += gstreamer1 gst1-plugins-base
endif
ifeq ($(BR2_PACKAGE_PUPIL_PROGRAM)$(BR2_PACKAGE_LIBCAMERA),yy)
PUPIL_DEPENDENCIES += libcamera
endif

$(eval $(cmake-package))
