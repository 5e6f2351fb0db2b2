# SPDX-License-Identifier: BSD-3-Clause
# Installs what find_package(pcl_slim COMPONENTS ...) reads. Called once all libraries are known.
include(CMakePackageConfigHelpers)

function(pcl_slim_install_package)
  get_property(components GLOBAL PROPERTY PCL_SLIM_COMPONENTS)
  set(PCL_SLIM_INSTALLED_COMPONENTS "${components}")
  set(PCL_SLIM_STATIC TRUE)
  if(BUILD_SHARED_LIBS)
    set(PCL_SLIM_STATIC FALSE)
  endif()
  foreach(part PNG VTP)
    set(PCL_SLIM_USES_${part} FALSE)
    if(PCL_SLIM_WITH_${part})
      set(PCL_SLIM_USES_${part} TRUE)
    endif()
  endforeach()
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcl_slim)
  configure_package_config_file(
    ${PROJECT_SOURCE_DIR}/cmake/pcl_slim-config.cmake.in
    ${PROJECT_BINARY_DIR}/pcl_slim-config.cmake
    INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
  # Before 1.0 a minor version may change interfaces.
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcl_slim-config-version.cmake
    COMPATIBILITY SameMinorVersion)
  install(FILES
    ${PROJECT_BINARY_DIR}/pcl_slim-config.cmake
    ${PROJECT_BINARY_DIR}/pcl_slim-config-version.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindHWY.cmake
    ${PROJECT_SOURCE_DIR}/cmake/PclSlimPCL.cmake
    DESTINATION ${package_dir} COMPONENT development)
  install(FILES ${PROJECT_SOURCE_DIR}/package.xml
    DESTINATION ${CMAKE_INSTALL_DATADIR}/pcl_slim COMPONENT development)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pcl_slim COMPONENT development)
endfunction()
