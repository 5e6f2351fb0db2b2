// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "stress/stress_cloud.h"

namespace pcl_slim_test {

namespace {

using Random = std::mt19937_64;

double between(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

std::size_t countOf(Random& random, std::size_t low, std::size_t high) {
  return std::uniform_int_distribution<std::size_t>(low, high)(random);
}

bool coin(Random& random) {
  return random() % 2 == 0;
}

/** What most families change: a wave with or without noise and normals. */
StressCloud base(Random& random, std::size_t low = 300, std::size_t high = 1200) {
  return wave(random, countOf(random, low, high), coin(random) ? 0.0 : 0.003, coin(random));
}

void transform(StressCloud& cloud, double scale, double offset) {
  cloud.scale = scale;
  cloud.offset = offset;
  for (double& value : cloud.points) value = offset + scale * value;
}

StressCloud plain(Random& random) {
  return base(random);
}

StressCloud offsets(Random& random) {
  StressCloud cloud = base(random);
  const double size = std::pow(10.0, between(random, -3, 3));
  transform(cloud, size, (coin(random) ? 1 : -1) * size * std::pow(10.0, between(random, 0, 8)));
  return cloud;
}

StressCloud scales(Random& random) {
  StressCloud cloud = base(random);
  transform(cloud, std::pow(10.0, between(random, -30, 30)), 0);
  return cloud;
}

StressCloud repeated(Random& random) {
  const StressCloud once = base(random, 100, 300);
  const std::size_t times = countOf(random, 2, coin(random) ? 10 : 200);
  StressCloud cloud = once;
  for (std::size_t k = 1; k < times; ++k) {
    cloud.points.insert(cloud.points.end(), once.points.begin(), once.points.end());
    cloud.normals.insert(cloud.normals.end(), once.normals.begin(), once.normals.end());
    cloud.bgr.insert(cloud.bgr.end(), once.bgr.begin(), once.bgr.end());
  }
  return cloud;
}

StressCloud coplanar(Random& random) {
  StressCloud cloud;
  const bool lattice = coin(random);
  const std::size_t side = countOf(random, 12, 30);
  const double u[3] = {between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)};
  const double v[3] = {between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)};
  for (std::size_t i = 0; i < side * side; ++i) {
    const double s = lattice ? static_cast<double>(i % side) : between(random, 0, 10);
    const double t = lattice ? static_cast<double>(i / side) : between(random, 0, 10);
    cloud.add(s * u[0] + t * v[0], s * u[1] + t * v[1], s * u[2] + t * v[2]);
  }
  return cloud;
}

StressCloud collinear(Random& random) {
  StressCloud cloud;
  const std::size_t count = countOf(random, 0, 9) == 0 ? 20000 : countOf(random, 3, 900);
  const double d[3] = {between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)};
  const bool even = coin(random), normals = coin(random);
  const double wide = coin(random) ? 0 : std::pow(10.0, between(random, -9, -2));
  const float up[3] = {0, 0, 1};
  for (std::size_t i = 0; i < count; ++i) {
    const double t = even ? 0.01 * static_cast<double>(i) : between(random, 0, 10);
    const double off = wide * between(random, -1, 1);
    cloud.add(t * d[0] + off, t * d[1] - off, t * d[2], normals ? up : nullptr);
  }
  return cloud;
}

StressCloud identical(Random& random) {
  StressCloud cloud;
  const std::size_t places = countOf(random, 1, 4), count = countOf(random, 1, 400);
  for (std::size_t i = 0; i < count; ++i) cloud.add(1.0 + static_cast<double>(i % places), 2, 3);
  return cloud;
}

StressCloud solid(Random& random) {
  StressCloud cloud;
  const std::size_t side = countOf(random, 4, 11);
  const double jitter = coin(random) ? 0 : 0.3;
  for (std::size_t i = 0; i < side * side * side; ++i) {
    cloud.add(static_cast<double>(i % side) + jitter * between(random, -1, 1),
              static_cast<double>(i / side % side) + jitter * between(random, -1, 1),
              static_cast<double>(i / side / side) + jitter * between(random, -1, 1));
  }
  return cloud;
}

/** Two sheets of the wave, .1 to 2 spacings apart; normals, where there are some, opposite or
 * alike. */
StressCloud sheets(Random& random) {
  StressCloud cloud = base(random, 400, 900);
  const double apart = between(random, 0.1, 2) / std::sqrt(static_cast<double>(cloud.size()));
  const float side = coin(random) ? 1.0f : -1.0f;
  const std::size_t count = cloud.size();
  for (std::size_t i = 0; i < count; ++i) {
    float n[3] = {0, 0, 1};
    for (std::size_t a = 0; a < 3 && !cloud.normals.empty(); ++a) {
      n[a] = side * cloud.normals[3 * i + a];
    }
    cloud.add(cloud.points[3 * i] + 1e-4, cloud.points[3 * i + 1], cloud.points[3 * i + 2] + apart,
              cloud.normals.empty() ? nullptr : n);
  }
  cloud.on_wave = 0;
  return cloud;
}

/** Normals that are zero, NaN, flipped or noisy, some or all. */
StressCloud badNormals(Random& random) {
  StressCloud cloud = wave(random, countOf(random, 400, 1200), 0.002, true);
  const double share = coin(random) ? 1.0 : between(random, 0.01, 0.6);
  const std::size_t kind = random() % 4;
  const float wrong[3] = {0.0f, std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity()};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (between(random, 0, 1) > share) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      float& n = cloud.normals[3 * i + a];
      if (kind == 0) n = wrong[random() % 3 == 0 ? 2 : 0];
      if (kind == 1) n = wrong[1];
      if (kind == 2) n = coin(random) ? n : -n;
      if (kind == 3) n += static_cast<float>(between(random, -1, 1));
    }
  }
  cloud.must_succeed = false;
  cloud.on_wave = 0;
  return cloud;
}

StressCloud outliers(Random& random) {
  StressCloud cloud = base(random, 600, 1200);
  const double share = between(random, 0.01, 0.4);
  const auto count = static_cast<std::size_t>(share * static_cast<double>(cloud.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const float n[3] = {0, 0, coin(random) ? 1.0f : -1.0f};
    cloud.add(between(random, -0.5, 1.5), between(random, -0.5, 1.5), between(random, -1, 1),
              cloud.normals.empty() ? nullptr : n);
  }
  // What is between wave and outliers moves towards them, by a share of what is between points.
  cloud.error_slack = (share > 0.1 ? 0.3 : 0.1) / std::sqrt(static_cast<double>(cloud.size()));
  return cloud;
}

/** One point, or a few, at 10^2 to 10^38. */
StressCloud farPoints(Random& random) {
  StressCloud cloud = base(random, 400, 1200);
  const double far = std::pow(10.0, between(random, 2, 38));
  const std::size_t count = coin(random) ? 1 : countOf(random, 2, 5);
  for (std::size_t i = 0; i < count; ++i) {
    const double place = far * between(random, 0.5, 1);
    const std::size_t axis = random() % 3;
    cloud.add(axis == 0 ? place : 0, axis == 1 ? -place : 0, axis == 2 ? place : 0);
  }
  cloud.error_factor = 3;
  return cloud;
}

StressCloud densities(Random& random) {
  StressCloud cloud = base(random, 300, 500);
  const double width = between(random, 0.02, 0.1);
  for (std::size_t i = 0; i < 1500; ++i) {
    const double x = 0.5 + width * between(random, -1, 1), y = 0.5 + width * between(random, -1, 1);
    cloud.add(x, y, 0.1 * std::sin(6 * x) * std::cos(5 * y));
  }
  cloud.on_wave = 0;
  return cloud;
}

/** Rings of a lidar in a street: ground, and a wall. */
StressCloud rings(Random& random) {
  StressCloud cloud;
  const std::size_t beams = countOf(random, 8, 32), steps = countOf(random, 90, 360);
  for (std::size_t b = 0; b < beams; ++b) {
    const double down = 0.02 + 0.4 * static_cast<double>(b) / static_cast<double>(beams);
    for (std::size_t s = 0; s < steps; ++s) {
      const double angle = 6.283185307 * static_cast<double>(s) / static_cast<double>(steps);
      double range = 1.8 / std::sin(down);
      range = std::min(range, 6.0 / std::max(1e-3, std::abs(std::cos(angle))));
      if (range > 80) continue;
      range += 0.01 * between(random, -1, 1);
      cloud.add(range * std::cos(down) * std::cos(angle), range * std::cos(down) * std::sin(angle),
                -range * std::sin(down));
    }
  }
  return cloud;
}

StressCloud few(Random& random) {
  return wave(random, countOf(random, 0, 40), coin(random) ? 0 : 0.01, coin(random));
}

StressCloud colors(Random& random) {
  StressCloud cloud = base(random);
  const bool single = coin(random);
  for (std::uint8_t& value : cloud.bgr) value = single || coin(random) ? 255 : 0;
  cloud.max_depth = coin(random) ? 0 : 30;
  return cloud;
}

/** Cells of one point each, or all of them in one. */
StressCloud cells(Random& random) {
  StressCloud cloud = base(random, 200, 600);
  cloud.resolution = coin(random) ? 1 : 1 << 20;
  cloud.max_depth = static_cast<int>(random() % 40);
  return cloud;
}

/** Places that crowd ever closer to one another: the deepest octree there is. */
StressCloud deep(Random& random) {
  StressCloud cloud;
  const double base_length = between(random, 1.2, 3);
  for (int k = 0; k < 60; ++k) {
    for (int j = 0; j < 8; ++j) {
      const double r = std::pow(base_length, -k);
      cloud.add(r * between(random, -1, 1), r * between(random, -1, 1),
                r * r * between(random, 0, 1));
    }
  }
  return cloud;
}

StressCloud views(Random& random) {
  StressCloud cloud = base(random, 300, 900);
  cloud.camera = static_cast<StressView>(1 + random() % 4);
  if (coin(random)) transform(cloud, std::pow(10.0, between(random, -6, 6)), 0);
  return cloud;
}

}  // namespace

const std::vector<StressFamily>& stressFamilies() {
  static const std::vector<StressFamily> families = {
      {"undisturbed", plain},
      {"offset 1 to 10^8 sizes", offsets},
      {"unit 10^-30 to 10^30", scales},
      {"points repeated 2 to 200 times", repeated},
      {"coplanar, lattice or random", coplanar},
      {"collinear, or a band 10^-9 to .01 wide", collinear},
      {"one to four places, many points", identical},
      {"solid lattice", solid},
      {"two sheets .1 to 2 spacings apart", sheets},
      {"normals zero, NaN, flipped, noisy", badNormals},
      {"1 to 40 % outliers", outliers},
      {"far points, 10^2 to 10^38", farPoints},
      {"density step up to 1000:1", densities},
      {"lidar rings", rings},
      {"0 to 40 points", few},
      {"one colour, saturated colours", colors},
      {"one point a cell, all in one cell", cells},
      {"ever closer points", deep},
      {"camera grazing, inside, touching, no area", views},
  };
  return families;
}

}  // namespace pcl_slim_test
