# SPDX-License-Identifier: BSD-3-Clause
# Finds Google Highway and defines hwy::hwy: from its CMake package where the distribution ships
# one (Debian 12), from pkg-config otherwise. Used by the build and, installed beside the package
# configuration, by projects that link the static libraries.
find_package(hwy CONFIG QUIET)
if(hwy_FOUND)
  set(HWY_VERSION ${hwy_VERSION})
elseif(NOT TARGET hwy::hwy)
  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(PC_HWY QUIET IMPORTED_TARGET libhwy)
  endif()
  if(PC_HWY_FOUND)
    set(HWY_VERSION ${PC_HWY_VERSION})
    add_library(hwy::hwy INTERFACE IMPORTED)
    set_target_properties(hwy::hwy PROPERTIES INTERFACE_LINK_LIBRARIES PkgConfig::PC_HWY)
  endif()
endif()

set(HWY_TARGET "")
if(TARGET hwy::hwy)
  set(HWY_TARGET hwy::hwy)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(HWY
  REQUIRED_VARS HWY_TARGET
  VERSION_VAR HWY_VERSION
  REASON_FAILURE_MESSAGE "install Google Highway ${HWY_FIND_VERSION} or later (libhwy-dev of Debian 12 and Ubuntu 24.04 on)")
