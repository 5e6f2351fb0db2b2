// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

namespace pcl_slim {

/** \brief A number as people write it: so many significant digits at most, no needless zeros. */
inline std::string
numberText(double value, int digits = 6)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

}  // namespace pcl_slim
