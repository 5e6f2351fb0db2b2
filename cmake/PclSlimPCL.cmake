# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_import_pcl(component...)
#
# Defines pcl_slim::pcl_<component> for PCL components that are found already: the same library
# file and headers as PCL's own target pcl_<component>. PCL's targets for io, features and surface
# name every VTK module that PCL was built with, rendering and Qt among them, although the headers
# and functions used here need none. Whoever links PCL's targets has to find and load all of that;
# whoever links these loads the library and the PCL libraries below it. Used by the build and,
# installed beside the package configuration, by projects that use pcl_slim::filters.
function(pcl_slim_import_pcl)
  foreach(component IN LISTS ARGN)
    set(theirs pcl_${component})
    set(ours pcl_slim::pcl_${component})
    if(TARGET ${ours})
      continue()
    endif()
    if(NOT TARGET ${theirs})
      message(FATAL_ERROR "${ours} needs PCL's component ${component}; find_package(PCL) first")
    endif()
    get_target_property(links ${theirs} INTERFACE_LINK_LIBRARIES)
    list(FILTER links INCLUDE REGEX "^(pcl_(common|kdtree|octree|search|filters)|Boost::.*)$")
    list(REMOVE_DUPLICATES links)
    add_library(${ours} SHARED IMPORTED)
    set_target_properties(${ours} PROPERTIES INTERFACE_LINK_LIBRARIES "${links}")
    get_target_property(configurations ${theirs} IMPORTED_CONFIGURATIONS)
    set(copied IMPORTED_CONFIGURATIONS IMPORTED_LOCATION IMPORTED_IMPLIB
      INTERFACE_INCLUDE_DIRECTORIES INTERFACE_COMPILE_DEFINITIONS INTERFACE_COMPILE_OPTIONS
      INTERFACE_COMPILE_FEATURES)
    foreach(configuration IN LISTS configurations)
      list(APPEND copied IMPORTED_LOCATION_${configuration} IMPORTED_IMPLIB_${configuration})
    endforeach()
    foreach(property IN LISTS copied)
      get_target_property(value ${theirs} ${property})
      if(value)
        set_target_properties(${ours} PROPERTIES ${property} "${value}")
      endif()
    endforeach()
  endforeach()
endfunction()
