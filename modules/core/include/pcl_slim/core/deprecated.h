// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/** \brief Marks a name that the release of version major.minor removes, two minor releases after the first one that has
 * the mark: PCL_SLIM_DEPRECATED(major, minor, "use newName()"). Each use compiles with a warning that names the
 * replacement. */
#define PCL_SLIM_DEPRECATED(major, minor, remedy) \
  [[deprecated(remedy "; pcl_slim " #major "." #minor " removes this")]]
