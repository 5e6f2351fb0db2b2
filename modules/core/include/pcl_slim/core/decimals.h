// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace pcl_slim {

/** \brief Decimals of coordinates and lengths in an object: they resolve 1e-5 of its diagonal,
 * wherever it is. max(0, ceil(5 - log10(diagonal))); 6 for a diagonal that is not positive or not
 * finite. \param[in] diagonal of the object's bounding box, in the unit of the text */
inline int decimalsFor(double diagonal) {
  constexpr int kDefault = 6, kMost = 300;  // as printf has it; what a double can have
  if (!(diagonal > 0.0) || !std::isfinite(diagonal)) return kDefault;
  return std::clamp(static_cast<int>(std::ceil(5.0 - std::log10(diagonal))), 0, kMost);
}

/** \brief A number with a number of decimals; never "-0.00". */
inline std::string fixedText(double value, int decimals) {
  std::string text(static_cast<std::size_t>(std::snprintf(nullptr, 0, "%.*f", decimals, value)) + 1,
                   '\0');
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  text.pop_back();
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text[0] == '-' ? text.substr(1) : text;
}

}  // namespace pcl_slim
