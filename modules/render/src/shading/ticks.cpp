// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/detail/ticks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

namespace pcl_slim::detail {
namespace {

constexpr std::size_t kFewest = 3, kMost = 6;
constexpr double kSlack = 1e-9;  ///< share of the range by which a tick may be outside

/** \brief m times 10^exponent, rounded once: 3 e-1 is .3, not 3 times .1. */
double timesPowerOfTen(double m, int exponent) {
  return exponent < 0 ? m / std::pow(10.0, -exponent) : m * std::pow(10.0, exponent);
}

int decadeOf(double value) {
  return static_cast<int>(std::floor(std::log10(value)));
}

/** \brief Multiples of m 10^exponent in a range. */
std::vector<double> multiplesIn(double low, double high, int m, int exponent) {
  const double step = timesPowerOfTen(m, exponent), slack = kSlack * (high - low);
  const double first = std::ceil((low - slack) / step), last = std::floor((high + slack) / step);
  std::vector<double> ticks;
  for (double k = first; k <= last; ++k) ticks.push_back(timesPowerOfTen(k * m, exponent) + 0.0);
  return ticks;
}

/** \brief The multiples of the narrowest step that has at most six in a range; where these are fewer
 * than three, of the next narrower one. */
std::vector<double> linearTicks(double low, double high) {
  std::vector<double> ticks;
  for (int exponent = decadeOf(high - low);; --exponent) {
    for (const int m : {5, 2, 1}) {
      const std::vector<double> more = multiplesIn(low, high, m, exponent);
      if (more.size() > kMost) return ticks.size() >= kFewest ? ticks : more;
      ticks = more;
    }
  }
}

/** \brief Powers of ten in a range, each times some factors. */
std::vector<double> decadesIn(double low, double high, std::initializer_list<int> factors) {
  std::vector<double> ticks;
  for (int exponent = decadeOf(low); exponent <= decadeOf(high); ++exponent) {
    for (const int m : factors) {
      const double tick = timesPowerOfTen(m, exponent);
      if (tick >= low * (1.0 - kSlack) && tick <= high * (1.0 + kSlack)) ticks.push_back(tick);
    }
  }
  return ticks;
}

/** \brief Every n-th of more ticks than fit. */
std::vector<double> thinned(const std::vector<double>& ticks) {
  const std::size_t step = (ticks.size() + kMost - 1) / kMost;
  std::vector<double> kept;
  for (std::size_t i = 0; i < ticks.size(); i += step) kept.push_back(ticks[i]);
  return kept;
}

std::vector<double> logarithmicTicks(double low, double high) {
  std::vector<double> ticks = decadesIn(low, high, {1});
  if (ticks.size() >= kFewest) return thinned(ticks);
  ticks = decadesIn(low, high, {1, 2, 5});
  if (ticks.size() > kMost) ticks = decadesIn(low, high, {1, 5});
  return ticks.size() >= kFewest ? ticks : linearTicks(low, high);
}

}  // namespace

std::vector<double> roundTicks(double low, double high, bool logarithmic) {
  if (low > high) std::swap(low, high);
  if (!std::isfinite(low) || !std::isfinite(high - low)) return {};
  if (logarithmic && !(low > 0.0)) return {};
  constexpr double kLeast = 1e-300;  // below it, powers of ten of steps are no doubles
  if (high - low < kLeast) return {low};
  constexpr double kDigits = 1e-12;  // closer ends have no round numbers between them
  if (!(high - low > kDigits * std::max(std::abs(low), std::abs(high)))) return {low};
  return logarithmic ? logarithmicTicks(low, high) : linearTicks(low, high);
}

std::string tickText(double tick) {
  constexpr double kLeastPlain = 1e-3, kLeastLarge = 1e5;
  char text[32];
  const double size = std::abs(tick);
  if (tick == 0.0 || (size >= kLeastPlain && size < kLeastLarge)) {
    std::snprintf(text, sizeof(text), "%.12g", tick);
    return text;
  }
  // The mantissa without zeros at its end, the exponent without plus and leading zeros.
  std::snprintf(text, sizeof(text), "%.11e", tick);
  const std::string all = text;
  const std::size_t e = all.find('e');
  std::string mantissa = all.substr(0, e);
  mantissa.erase(mantissa.find_last_not_of('0') + 1);
  if (mantissa.back() == '.') mantissa.pop_back();
  return mantissa + "e" + std::to_string(std::atoi(all.c_str() + e + 1));
}

}  // namespace pcl_slim::detail
