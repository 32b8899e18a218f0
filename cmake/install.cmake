# Installs the library, its headers, a pkg-config file and a CMake package.
include(CMakePackageConfigHelpers)

set(pupil_installed ${pupil_libraries})
if(NOT PUPIL_STATIC)
  list(REMOVE_ITEM pupil_installed pupil_static)
endif()
install(TARGETS ${pupil_installed} EXPORT pupil
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
file(GLOB pupil_opencv_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/drivers/include/pupil/*.hpp)
install(FILES ${pupil_headers} ${pupil_opencv_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pupil)

# Both files find the tree relative to their own place, so that it can be moved.
cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_LIBDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE libdir)
cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_INCLUDEDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE includedir)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${libdir}/pkgconfig OUTPUT_VARIABLE pc_prefix)
cmake_path(RELATIVE_PATH libdir BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE pc_libdir)
cmake_path(RELATIVE_PATH includedir BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE pc_includedir)
configure_file(${PROJECT_SOURCE_DIR}/cmake/pupil.pc.in ${PROJECT_BINARY_DIR}/pupil.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/pupil.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pupil)
install(EXPORT pupil NAMESPACE pupil:: FILE pupil-targets.cmake DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pupil-config.cmake.in
  ${PROJECT_BINARY_DIR}/pupil-config.cmake INSTALL_DESTINATION ${package_dir})
# Before 1.0 a new minor version may change the interface. The soname says the same: libpupil.so.0.MINOR.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pupil-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pupil-config.cmake ${PROJECT_BINARY_DIR}/pupil-config-version.cmake
  DESTINATION ${package_dir})
