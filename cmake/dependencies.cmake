# What the drivers and the program link, each behind its option. The library itself needs nothing.
# pupil_needs(OPTION PACKAGE MODULES...) makes the target pupil_dep_OPTION, which is empty where the option is OFF.
function(pupil_needs option package)
  add_library(pupil_dep_${option} INTERFACE)
  if(NOT PUPIL_${option})
    return()
  endif()
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(PUPIL_${option}_FOUND IMPORTED_TARGET QUIET ${ARGN})
  if(NOT PUPIL_${option}_FOUND_FOUND)
    list(JOIN ARGN ", " modules)
    message(FATAL_ERROR "PUPIL_${option}=ON, but pkg-config does not find ${modules}. "
      "On Debian: apt-get install ${package}. To do without: -DPUPIL_${option}=OFF")
  endif()
  target_link_libraries(pupil_dep_${option} INTERFACE PkgConfig::PUPIL_${option}_FOUND)
endfunction()

if(PUPIL_PROGRAM)
  # OpenEXR's pkg-config file names its C++ libraries too; its CMake package has the C core alone.
  add_library(pupil_dep_EXR INTERFACE)
  if(PUPIL_EXR)
    find_package(OpenEXR 3.1 CONFIG QUIET)
    if(NOT TARGET OpenEXR::OpenEXRCore)
      message(FATAL_ERROR "PUPIL_EXR=ON, but CMake does not find OpenEXR 3.1 with its C core. "
        "On Debian: apt-get install libopenexr-dev. To do without: -DPUPIL_EXR=OFF")
    endif()
    target_link_libraries(pupil_dep_EXR INTERFACE OpenEXR::OpenEXRCore)
  endif()
  pupil_needs(PNG libpng-dev libpng)
  pupil_needs(VIDEO "libavformat-dev libavcodec-dev libavutil-dev"
    libavformat>=59 libavcodec>=59 libavutil>=57)
  pupil_needs(JSON libcjson-dev libcjson)
  set(THREADS_PREFER_PTHREAD_FLAG ON)
  find_package(Threads REQUIRED)
  # Not everything in the C library's mathematics is in the C library's own file.
  find_library(PUPIL_LIBM m)
  mark_as_advanced(PUPIL_LIBM)
endif()
