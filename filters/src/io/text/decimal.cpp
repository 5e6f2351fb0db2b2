// SPDX-License-Identifier: BSD-3-Clause
#include "io/text/decimal.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace pcl_slim {

namespace {

constexpr int kMostDecimals = 40;  ///< a float with more has them all or is zero

/** Half a unit of the last decimal. */
double
halfUnit(int decimals)
{
  static const auto table = [] {
    struct {
      double of[kMostDecimals + 1];
    } made{};
    for (int k = 0; k <= kMostDecimals; ++k) made.of[k] = 0.5 * std::pow(10.0, -k);
    return made;
  }();
  return table.of[std::clamp(decimals, 0, kMostDecimals)];
}

/** Digits behind the point, less the exponent. */
int
decimalsOf(const char* begin, const char* end)
{
  const char* point = std::find(begin, end, '.');
  const char* power = std::find_if(begin, end, [](char c) { return c == 'e' || c == 'E'; });
  const auto digits = point < power ? static_cast<int>(power - point) - 1 : 0;
  if (power == end) return digits;
  int exponent = 0;
  const char* from = power + 1;
  if (from != end && *from == '+') ++from;
  std::from_chars(from, end, exponent);
  return digits - std::clamp(exponent, -400, 400);
}

}  // namespace

bool
parseDecimal(const char* begin, const char* end, double& value, bool& in_float)
{
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code == std::errc::result_out_of_range) {  // beyond doubles: infinite, or zero
    if (stop != end) return false;
    value = decimalsOf(begin, end) > 0 ? 0.0 : std::numeric_limits<double>::infinity();
    return true;
  }
  if (code != std::errc() || stop != end || begin == end) return false;
  if (!in_float || !std::isfinite(value)) return true;
  const auto narrow = static_cast<float>(value);
  in_float = std::abs(narrow - value) < halfUnit(decimalsOf(begin, end));
  return true;
}

}  // namespace pcl_slim
