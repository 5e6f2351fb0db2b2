// SPDX-License-Identifier: BSD-3-Clause
#include "splats/methods.h"

#include <cmath>
#include <cstdlib>

namespace pcl_slim::measure {
namespace {

constexpr double kCloseEnough = 0.003;  ///< of the count wanted
constexpr int kSteps = 18;

double missBy(std::size_t count, std::size_t wanted) {
  return std::abs(std::log(static_cast<double>(count) / static_cast<double>(wanted)));
}

/** Bisects over exponents in [low, high]; more splats towards high. */
template <typename ParamsAt>
SplatParams bisect(const ColoredScan& scan, std::size_t wanted, double low, double high,
                   const ParamsAt& paramsAt) {
  SplatParams best = paramsAt(low);
  double least = missBy(splatsOf(scan, best).size(), wanted);
  for (int step = 0; step < kSteps && least > kCloseEnough; ++step) {
    const double middle = 0.5 * (low + high);
    const SplatParams params = paramsAt(middle);
    const std::size_t count = splatsOf(scan, params).size();
    if (missBy(count, wanted) < least) {
      least = missBy(count, wanted);
      best = params;
    }
    (count < wanted ? low : high) = middle;
  }
  return best;
}

}  // namespace

std::vector<Method> comparedMethods() {
  std::vector<Method> methods;
  const auto add = [&](const char* name, Method::Solve solve) -> SplatParams& {
    methods.push_back({name, {}, solve});
    return methods.back().params;
  };
  add("uniform", Method::Solve::kGrid).max_depth = 0;
  SplatParams& slanted = add("uniform, gradient", Method::Solve::kGrid);
  slanted.max_depth = 0;
  slanted.color = SplatColor::kGradient;
  add("geometry only", Method::Solve::kTolerances).color_error = 1.0;
  add("geometry and colour", Method::Solve::kTolerances);
  add("budget", Method::Solve::kBudget);
  add("budget, gradient", Method::Solve::kBudget).color = SplatColor::kGradient;
  add("paper", Method::Solve::kTolerances).paper_mode = true;
  return methods;
}

SplatParams solvedFor(const ColoredScan& scan, const Method& method, std::size_t wanted) {
  SplatParams params = method.params;
  switch (method.solve) {
    case Method::Solve::kBudget: params.max_splats = wanted; return params;
    case Method::Solve::kGrid:
      return bisect(scan, wanted, 1.0, 16.0, [&](double exponent) {
        params.initial_resolution = static_cast<int>(std::lround(std::exp2(exponent)));
        return params;
      });
    case Method::Solve::kTolerances: break;
  }
  const SplatParams start = method.params;
  return bisect(scan, wanted, -4.0, 8.0, [&](double exponent) {
    params.geometric_error = start.geometric_error * std::exp2(-exponent);
    // From 1 on colour is ignored, which is another method.
    if (start.color_error < 1.0) {
      params.color_error = std::min(0.999, start.color_error * std::exp2(-exponent));
    }
    return params;
  });
}

}  // namespace pcl_slim::measure
