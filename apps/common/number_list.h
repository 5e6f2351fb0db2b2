// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace pcl_slim {

/** \brief A number in plain notation: at most a given number of significant digits, no needless zeros. */
inline std::string
numberText(double value, int digits = 6)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

/** \brief Reads finite numbers separated by single commas; nothing else may separate them. */
inline bool
parseNumberList(const std::string& text, std::vector<double>& values)
{
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at || !std::isfinite(value)) return false;
    values.push_back(value);
    if (*end == '\0') return true;
    if (*end != ',') return false;
    at = end + 1;
  }
}

}  // namespace pcl_slim
