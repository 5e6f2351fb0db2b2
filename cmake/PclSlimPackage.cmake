# SPDX-License-Identifier: BSD-3-Clause
# Installs what find_package(pcl_slim COMPONENTS ...) and pkg-config read, the examples and the pages. Called
# once all libraries are known.
include(CMakePackageConfigHelpers)

# pcl_slim_write_pkg_config(file description requires libraries public others flags)
#
# Lists are written as they are linked: our libraries, those that inline functions of our headers call, and those that ours
# call, which static ones name among their own libraries.
function(pcl_slim_write_pkg_config file description requires libraries public others flags)
  list(TRANSFORM libraries PREPEND -lpcl_slim_)
  if(BUILD_SHARED_LIBS)
    set(others "")
  endif()
  list(PREPEND others ${libraries})
  list(APPEND others ${public})
  list(JOIN others " " others)
  file(RELATIVE_PATH to_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/${file}.pc CONTENT
"prefix=\${pcfiledir}/${to_prefix}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}

Name: ${file}
Description: ${description}
Version: ${PROJECT_VERSION}
Requires: ${requires}
Libs: -L\${libdir} ${others}
Cflags: -I\${includedir} ${flags}
")
  install(FILES ${PROJECT_BINARY_DIR}/${file}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT development)
endfunction()

# pcl_slim has the modules, pcl_slim_filters the classes that take PCL clouds and what reads and writes files.
# PCL's own .pc files are of no use here: they name libraries of cameras and of MPI that Debian does not
# install with PCL.
function(pcl_slim_install_pkg_config components)
  set(modules ${components})
  list(REMOVE_ITEM modules mpi io table normals filters visualization)
  list(REVERSE modules)
  set(others -ltbb -lhwy -lz -pthread)
  if(PCL_SLIM_WITH_PNG)
    list(APPEND others -lpng)
  endif()
  pcl_slim_write_pkg_config(pcl_slim "${PROJECT_DESCRIPTION}" "" "${modules}" "" "${others}" "")
  if(TARGET pcl_slim_lib_filters)
    set(others "")
    string(REPLACE " " ";" vtk "${PCL_SLIM_VTK_COMPONENTS}")
    if(vtk)
      list(APPEND vtk vtksys) # which VTK's headers call from VTK 9.3 on
    endif()
    foreach(component IN LISTS vtk)
      list(APPEND others $<TARGET_FILE:VTK::${component}>)
    endforeach()
    set(pcl common kdtree octree search filters features io)
    list(TRANSFORM pcl PREPEND -lpcl_)
    if(PCL_SLIM_WITH_LZ4)
      list(APPEND others -llz4)
    endif()
    if(PCL_SLIM_HAS_LAZ)
      list(APPEND others -llaszip)
    endif()
    # PCL's newer packages name Eigen's target in place of its folder.
    get_target_property(eigen Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
    set(flags ${PCL_INCLUDE_DIRS} ${eigen})
    list(REMOVE_DUPLICATES flags)
    list(REMOVE_ITEM flags /usr/include) # named again, it hides the compiler's own headers
    list(TRANSFORM flags PREPEND -I)
    list(JOIN flags " " flags)
    pcl_slim_write_pkg_config(pcl_slim_filters "SLIM surfaces of PCL clouds" pcl_slim "filters;normals;table;io"
      "${pcl}" "${others}" "${flags}")
  endif()
endfunction()

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
  pcl_slim_install_pkg_config("${components}")
  # The pages, 19 MB of pictures among them, are installed where their component is asked for alone.
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/modules/render/src/text/LICENSE.dejavu
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
  install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation EXCLUDE_FROM_ALL)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples
    DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation EXCLUDE_FROM_ALL PATTERN docs/site EXCLUDE)
endfunction()
