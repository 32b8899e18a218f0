# The libraries that the drivers and the program link. The library itself needs none. pupil_dep_MEDIA and pupil_dep_GPU
# are empty if their option is OFF.
# pupil_needs(OPTION NAME PACKAGE MODULES...): the option's target links the modules.
function(pupil_needs option name package)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(PUPIL_PC_${name} IMPORTED_TARGET QUIET ${ARGN})
  if(NOT PUPIL_PC_${name}_FOUND)
    list(JOIN ARGN ", " modules)
    message(FATAL_ERROR "PUPIL_${option}=ON, but pkg-config does not find ${modules}. "
      "On Debian: apt-get install ${package}. To do without: -DPUPIL_${option}=OFF")
  endif()
  target_link_libraries(pupil_dep_${option} INTERFACE PkgConfig::PUPIL_PC_${name})
endfunction()

# The headers of OpenGL ES; its functions are not linked, but looked up at run time.
include(CheckIncludeFile)
if(PUPIL_GPU)
  check_include_file(GLES3/gl31.h PUPIL_HAS_GL31_H)
  if(NOT PUPIL_HAS_GL31_H)
    message(FATAL_ERROR "PUPIL_GPU=ON, but the compiler does not find GLES3/gl31.h. "
      "On Debian: apt-get install libgles-dev. To do without: -DPUPIL_GPU=OFF")
  endif()
endif()

if(PUPIL_V4L2 AND PUPIL_PROGRAM)
  check_include_file(linux/videodev2.h PUPIL_HAS_VIDEODEV2_H)
  if(NOT PUPIL_HAS_VIDEODEV2_H)
    message(FATAL_ERROR "PUPIL_V4L2=ON, but the compiler does not find linux/videodev2.h. "
      "On Debian: apt-get install linux-libc-dev. To do without: -DPUPIL_V4L2=OFF")
  endif()
endif()

# C++ is for libcamera, and for tests and benchmarks with OpenCV. PUPIL_CXX: there is a compiler. Instrumented
# objects of one program must come from one family of compilers.
set(PUPIL_CXX OFF)
if(PUPIL_PROGRAM)
  include(CheckLanguage)
  check_language(CXX)
  if(CMAKE_CXX_COMPILER)
    enable_language(CXX)
    if(CMAKE_CXX_COMPILER_ID STREQUAL CMAKE_C_COMPILER_ID OR NOT (PUPIL_SANITIZE OR PUPIL_FUZZ))
      set(PUPIL_CXX ON)
    endif()
  endif()
endif()

# libcamera: pupil_dep_LIBCAMERA exists if it can be built. Without it *_absent.c is built, which reports so.
if(PUPIL_PROGRAM AND PUPIL_LIBCAMERA AND PUPIL_V4L2)
  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(PUPIL_PC_LIBCAMERA IMPORTED_TARGET QUIET libcamera)
  endif()
  if(PUPIL_PC_LIBCAMERA_FOUND AND PUPIL_CXX)
    add_library(pupil_dep_LIBCAMERA INTERFACE)
    target_link_libraries(pupil_dep_LIBCAMERA INTERFACE PkgConfig::PUPIL_PC_LIBCAMERA)
  else()
    message(STATUS "libcamera: is left out, for it or a C++ compiler is not found "
      "(on Debian: apt-get install libcamera-dev g++)")
  endif()
endif()

if(PUPIL_PROGRAM)
  add_library(pupil_dep_MEDIA INTERFACE)
  if(PUPIL_MEDIA)
    # OpenEXR's pkg-config file names its C++ libraries too; its CMake package has only the C core.
    find_package(OpenEXR 3.1 CONFIG QUIET)
    if(NOT TARGET OpenEXR::OpenEXRCore)
      message(FATAL_ERROR "PUPIL_MEDIA=ON, but CMake does not find OpenEXR 3.1 with its C core. "
        "On Debian: apt-get install libopenexr-dev. To do without: -DPUPIL_MEDIA=OFF")
    endif()
    target_link_libraries(pupil_dep_MEDIA INTERFACE OpenEXR::OpenEXRCore)
    pupil_needs(MEDIA PNG libpng-dev libpng)
    pupil_needs(MEDIA LIBAV "libavformat-dev libavcodec-dev libavutil-dev"
      libavformat>=59 libavcodec>=59 libavutil>=57)
    pupil_needs(MEDIA CJSON libcjson-dev libcjson)
    # pupil_dep_LIBRAW and pupil_dep_LCMS exist if they are installed; else stubs are built.
    find_package(PkgConfig REQUIRED) # in this scope, too
    pkg_check_modules(PUPIL_PC_LIBRAW IMPORTED_TARGET QUIET libraw_r)
    if(PUPIL_PC_LIBRAW_FOUND)
      # LibRaw links OpenMP by itself; its pkg-config file asks for it, too, and clang does not always have it.
      foreach(property INTERFACE_LINK_OPTIONS INTERFACE_LINK_LIBRARIES)
        get_target_property(flags PkgConfig::PUPIL_PC_LIBRAW ${property})
        if(flags)
          list(REMOVE_ITEM flags -fopenmp)
          set_target_properties(PkgConfig::PUPIL_PC_LIBRAW PROPERTIES ${property} "${flags}")
        endif()
      endforeach()
      add_library(pupil_dep_LIBRAW INTERFACE)
      target_link_libraries(pupil_dep_LIBRAW INTERFACE PkgConfig::PUPIL_PC_LIBRAW)
    else()
      message(STATUS "DNG: is left out, for LibRaw is not found (on Debian: apt-get install libraw-dev)")
    endif()
    pkg_check_modules(PUPIL_PC_LCMS IMPORTED_TARGET QUIET lcms2)
    if(PUPIL_PC_LCMS_FOUND)
      add_library(pupil_dep_LCMS INTERFACE)
      target_link_libraries(pupil_dep_LCMS INTERFACE PkgConfig::PUPIL_PC_LCMS)
    else()
      message(STATUS "ICC profiles are ignored, because Little CMS is not found (on Debian: apt-get install "
        "liblcms2-dev)")
    endif()
  endif()
  add_library(pupil_dep_GPU INTERFACE)
  if(PUPIL_GPU)
    pupil_needs(GPU EGL libegl-dev egl)
    pupil_needs(GPU SDL libsdl2-dev sdl2)
  endif()
  set(THREADS_PREFER_PTHREAD_FLAG ON)
  find_package(Threads REQUIRED)
  # Some of the C library's mathematics may be in a separate libm.
  find_library(PUPIL_LIBM m)
  mark_as_advanced(PUPIL_LIBM)
endif()

# The plugin is left out, with a message, if GStreamer is not installed. 1.20 has custom metas.
if(PUPIL_PROGRAM AND PUPIL_GSTREAMER)
  set(modules gstreamer-1.0>=1.20 gstreamer-video-1.0>=1.20 gstreamer-base-1.0>=1.20)
  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(PUPIL_PC_GSTREAMER IMPORTED_TARGET QUIET ${modules})
  endif()
  if(PUPIL_PC_GSTREAMER_FOUND)
    add_library(pupil_dep_GSTREAMER INTERFACE)
    target_link_libraries(pupil_dep_GSTREAMER INTERFACE PkgConfig::PUPIL_PC_GSTREAMER)
  else()
    message(STATUS "PUPIL_GSTREAMER=ON, but pkg-config does not find GStreamer 1.20: the plugin is left out "
      "(on Debian: apt-get install libgstreamer-plugins-base1.0-dev)")
  endif()
endif()

# For the tests of pupil/opencv.hpp; the header itself needs none of this.
if(PUPIL_PROGRAM AND PUPIL_TESTS AND NOT CMAKE_CROSSCOMPILING)
  if(PUPIL_CXX)
    find_package(OpenCV 4 QUIET COMPONENTS core imgproc photo imgcodecs videoio)
  endif()
  if(OpenCV_FOUND)
    set(PUPIL_TEST_OPENCV ON)
  else()
    message(STATUS "pupil/opencv.hpp is not tested: OpenCV 4 or a C++ compiler is not found "
      "(on Debian: apt-get install libopencv-dev g++)")
  endif()
endif()

# The benchmark's peers: pupil_peer_NAME exists if it is found.
if(PUPIL_PROGRAM AND PUPIL_LAB AND PUPIL_BENCH_PEERS)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(PUPIL_PEER_FFMPEG IMPORTED_TARGET QUIET libavfilter>=8 libavutil>=57)
  if(PUPIL_PEER_FFMPEG_FOUND)
    add_library(pupil_peer_ffmpeg ALIAS PkgConfig::PUPIL_PEER_FFMPEG)
  endif()
  if(PUPIL_CXX)
    find_package(OpenCV 4 QUIET COMPONENTS core photo)
    if(OpenCV_FOUND)
      add_library(pupil_peer_opencv INTERFACE)
      target_link_libraries(pupil_peer_opencv INTERFACE opencv_core opencv_photo)
    endif()
  endif()
  pkg_check_modules(PUPIL_PEER_FFTW IMPORTED_TARGET QUIET fftw3f)
  if(PUPIL_PEER_FFTW_FOUND)
    add_library(pupil_peer_fftw ALIAS PkgConfig::PUPIL_PEER_FFTW)
  endif()
  foreach(peer IN ITEMS opencv ffmpeg fftw)
    if(NOT TARGET pupil_peer_${peer})
      message(STATUS "PUPIL_BENCH_PEERS=ON, but ${peer} is not found: the benchmark does without "
        "(on Debian: apt-get install libopencv-dev libavfilter-dev libfftw3-dev g++)")
    endif()
  endforeach()
endif()
