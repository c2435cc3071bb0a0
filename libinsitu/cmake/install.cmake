# What `cmake --install` leaves: the shared library, its header, and how find_package and pkg-config find them. Included
# at the end of the CMakeLists.txt that defines the target `insitu`.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# The number in the file name is that of the binary interface, read where it is defined.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../include/insitu/insitu.h" abi_line REGEX "^#define INSITU_ABI ")
string(REGEX MATCH "[0-9]+" insitu_abi "${abi_line}")

# Hidden visibility leaves the templates of the C++ library visible; the map hides these too, and those of static
# libraries, so that nothing in a host can ever be taken for ours or the other way round.
set(insitu_map "${CMAKE_CURRENT_LIST_DIR}/insitu.map")
target_link_options(insitu PRIVATE "LINKER:--version-script=${insitu_map}")
set_target_properties(insitu PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${insitu_abi}
  LINK_DEPENDS "${insitu_map}"
  INSTALL_RPATH "$ORIGIN"  # where insitu_image is
  EXPORT_NAME insitu)
target_link_options(insitu_image PRIVATE "LINKER:--version-script=${insitu_map}")
set_target_properties(insitu_image PROPERTIES LINK_DEPENDS "${insitu_map}")

install(TARGETS insitu_image LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_SKIP)
install(TARGETS insitu EXPORT insituTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES "${CMAKE_CURRENT_LIST_DIR}/../include/insitu/insitu.h" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/insitu)

set(insitu_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/insitu")
install(EXPORT insituTargets NAMESPACE insitu:: DESTINATION ${insitu_package_dir})
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/insituConfig.cmake.in"
  "${CMAKE_CURRENT_BINARY_DIR}/insituConfig.cmake"
  INSTALL_DESTINATION ${insitu_package_dir})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/insituConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/insituConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/insituConfigVersion.cmake"
  DESTINATION ${insitu_package_dir})

# insitu.pc names its folders relative to itself, so that an installed tree can be moved.
cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_LIBDIR BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}" OUTPUT_VARIABLE pc_libdir)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_INCLUDEDIR BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}"
           OUTPUT_VARIABLE pc_includedir)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig"
           OUTPUT_VARIABLE pc_prefix)
configure_file("${CMAKE_CURRENT_LIST_DIR}/insitu.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/insitu.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/insitu.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
