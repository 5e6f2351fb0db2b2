// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// CMakeLists.txt reads the version from here.
#define PCL_SLIM_VERSION_MAJOR 0
#define PCL_SLIM_VERSION_MINOR 1
#define PCL_SLIM_VERSION_PATCH 0
#define PCL_SLIM_VERSION "0.1.0"

/** \brief One number to compare with, as in `#if PCL_SLIM_VERSION_NUMBER >= 100` for 0.1.0. */
#define PCL_SLIM_VERSION_NUMBER \
  (PCL_SLIM_VERSION_MAJOR * 10000 + PCL_SLIM_VERSION_MINOR * 100 + PCL_SLIM_VERSION_PATCH)
