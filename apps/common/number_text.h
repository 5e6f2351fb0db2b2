// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

namespace pcl_slim {

/** \brief A number as people write it: six significant digits at most, no needless zeros. */
inline std::string
numberText(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

}  // namespace pcl_slim
