// SPDX-License-Identifier: BSD-3-Clause
#include "stress/stress_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/array_view.h"

namespace pcl_slim_test {

pcl_slim::CloudView StressCloud::cloud() const {
  return viewOf(points, normals);
}

void StressCloud::add(double x, double y, double z, const float* normal) {
  static const float kUp[3] = {0, 0, 1};
  points.insert(points.end(), {x, y, z});
  bgr.insert(bgr.end(), {255, 255, 255});
  if (normals.empty() && points.size() > 3) return;
  if (normal == nullptr && normals.empty()) return;
  normals.insert(normals.end(), normal ? normal : kUp, (normal ? normal : kUp) + 3);
}

StressCloud StressCloud::mixed(std::mt19937_64& random, std::size_t times,
                               std::size_t nowhere) const {
  StressCloud made = *this;
  made.points.clear();
  made.normals.clear();
  made.bgr.clear();
  std::vector<std::size_t> from(nowhere, size());
  for (std::size_t i = 0; i < times * size(); ++i) from.push_back(i % size());
  std::shuffle(from.begin(), from.end(), random);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t k : from) {
    const bool real = k < size();
    for (std::size_t a = 0; a < 3; ++a) {
      made.points.push_back(real ? points[3 * k + a] : nan);
      made.bgr.push_back(real ? bgr[3 * k + a] : std::uint8_t{0});
      if (!normals.empty()) made.normals.push_back(real ? normals[3 * k + a] : 1.0f);
    }
  }
  return made;
}

double StressCloud::distance(const double p[3]) const {
  const double x = (p[0] - offset) / scale, y = (p[1] - offset) / scale,
               z = (p[2] - offset) / scale;
  const double a = 0.6 * std::cos(6 * x) * std::cos(5 * y);
  const double b = -0.5 * std::sin(6 * x) * std::sin(5 * y);
  return std::abs(z - 0.1 * std::sin(6 * x) * std::cos(5 * y)) / std::sqrt(1 + a * a + b * b);
}

StressCloud wave(std::mt19937_64& random, std::size_t count, double noise, bool normals) {
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  StressCloud cloud;
  cloud.noise = noise;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = uniform(random), y = uniform(random);
    const double a = 0.6 * std::cos(6 * x) * std::cos(5 * y);
    const double b = -0.5 * std::sin(6 * x) * std::sin(5 * y), l = std::sqrt(a * a + b * b + 1);
    const float n[3] = {static_cast<float>(-a / l), static_cast<float>(-b / l),
                        static_cast<float>(1 / l)};
    cloud.add(x, y, 0.1 * std::sin(6 * x) * std::cos(5 * y) + noise * normal(random),
              normals ? n : nullptr);
    for (std::size_t c = 0; c < 3; ++c) {
      cloud.bgr[3 * i + c] = static_cast<std::uint8_t>(40 * c + 100 + 60 * std::sin(9 * x));
    }
  }
  cloud.on_wave = count;
  cloud.must_succeed = count >= 200;
  return cloud;
}

}  // namespace pcl_slim_test
