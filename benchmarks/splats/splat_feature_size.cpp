// SPDX-License-Identifier: BSD-3-Clause
// splat_feature_size: cells divided by the local feature size beside cells divided by their
// normals, at one count (future work of the colour splat paper).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "scan/cloud_file.h"

namespace {

using namespace pcl_slim;

constexpr double kNear = 3;  ///< spacings within which noise would pass for a small ball

struct Points {
  std::vector<Vector3> at, normal;
  std::vector<std::uint64_t> key;  ///< Morton codes, ascending
  std::vector<double> feature;     ///< distance to the medial axis
  double diagonal = 1;
};

/** Centres of the largest balls that touch each point from either side and contain no other: where the
 * medial axis is. Then each point's distance to the nearest of them, its local feature size.
 * O(points^2). */
void findFeatureSizes(double spacing, Points& points) {
  const std::size_t n = points.at.size();
  std::vector<Vector3> axis(2 * n);
  parallelFor(n, 0, 64, [&](std::size_t i, int) {
    double radius[2] = {2 * points.diagonal, 2 * points.diagonal};
    for (const Vector3& q : points.at) {
      const Vector3 d = subtract(q, points.at[i]);
      const double square = dot(d, d), height = dot(d, points.normal[i]);
      if (square < kNear * kNear * spacing * spacing || height == 0) continue;
      double& least = radius[height > 0 ? 0 : 1];
      least = std::min(least, 0.5 * square / std::abs(height));
    }
    for (const int side : {0, 1}) {
      axis[2 * i + static_cast<std::size_t>(side)] =
          along(points.at[i], side == 0 ? radius[0] : -radius[1], points.normal[i]);
    }
  });
  points.feature.resize(n);
  parallelFor(n, 0, 64, [&](std::size_t i, int) {
    double least = std::numeric_limits<double>::max();
    for (const Vector3& m : axis) {
      const Vector3 d = subtract(m, points.at[i]);
      least = std::min(least, dot(d, d));
    }
    points.feature[i] = std::sqrt(least);
  });
}

/** What a disc for the points [begin, end) would be. */
struct Disc {
  Vector3 center{}, normal{};
  double radius = 0, deviation = 0, least_feature = 0;
};

Disc discOf(const Points& points, std::size_t begin, std::size_t end) {
  Disc disc;
  disc.least_feature = std::numeric_limits<double>::max();
  const auto n = static_cast<double>(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    disc.center = along(disc.center, 1 / n, points.at[i]);
    disc.normal = along(disc.normal, 1 / n, points.normal[i]);
    disc.least_feature = std::min(disc.least_feature, points.feature[i]);
  }
  disc.deviation = std::sqrt(std::max(0.0, 1 - dot(disc.normal, disc.normal)));
  disc.normal = normalized(disc.normal);
  for (std::size_t i = begin; i < end; ++i) {
    disc.radius = std::max(disc.radius, length(subtract(points.at[i], disc.center)));
  }
  return disc;
}

/** What the discs are off their points. */
struct Score {
  std::size_t count = 0;
  double distance = 0, angle = 0, area = 0;
  std::vector<double> angles;
};

using Divides = std::function<bool(const Disc&)>;

void divide(const Points& points, std::size_t begin, std::size_t end, int shift,
            const Divides& divides, Score& score) {
  const Disc disc = discOf(points, begin, end);
  if (shift > 0 && (shift > 51 || (end - begin > 4 && divides(disc)))) {
    for (std::size_t at = begin; at < end;) {
      std::size_t next = at + 1;
      while (next < end && points.key[next] >> (shift - 3) == points.key[at] >> (shift - 3)) ++next;
      divide(points, at, next, shift - 3, divides, score);
      at = next;
    }
    return;
  }
  ++score.count;
  score.area += M_PI * disc.radius * disc.radius;
  for (std::size_t i = begin; i < end; ++i) {
    const double height = dot(subtract(points.at[i], disc.center), disc.normal);
    score.distance += height * height;
    const double cosine = std::clamp(dot(points.normal[i], disc.normal), -1.0, 1.0);
    score.angles.push_back(std::acos(cosine) * 180 / M_PI);
    score.angle += score.angles.back() * score.angles.back();
  }
}

/** Divides with the tolerance that gives so many discs, and prints the row. */
void printRow(const char* name, const Points& points, std::size_t wanted,
              const std::function<bool(const Disc&, double)>& divides) {
  double low = -14, high = 4;
  Score score;
  for (int step = 0; step < 24; ++step) {
    const double tolerance = std::exp2(0.5 * (low + high));
    score = {};
    divide(
        points, 0, points.at.size(), 63, [&](const Disc& d) { return divides(d, tolerance); },
        score);
    (score.count > wanted ? low : high) = 0.5 * (low + high);
  }
  const auto n = static_cast<double>(points.at.size());
  std::sort(score.angles.begin(), score.angles.end());
  std::printf("| %s | %zu | %.2e | %.2f | %.2f | %.3f |\n", name, score.count,
              std::sqrt(score.distance / n) / points.diagonal, std::sqrt(score.angle / n),
              score.angles[score.angles.size() * 19 / 20],
              score.area / (points.diagonal * points.diagonal));
}

Error study(const std::string& input, double share) {
  auto file = loadCloudFile(input);
  if (!file) return file.error();
  if (file->normal_source == NormalSource::kNothing) {
    if (Error error = estimateNormals(16, {}, 0, *file)) return error;
  }
  const auto store = PointStore::build(file->view());
  if (!store) return store.error();
  Points points;
  points.diagonal = store->diagonal();
  for (std::size_t i = 0; i < store->size(); ++i) {
    points.at.push_back(store->position(i));
    const auto n = store->normal(i);
    points.normal.push_back({n[0], n[1], n[2]});
    points.key.push_back(store->keys()[i]);
  }
  const double spacing = points.diagonal * std::sqrt(0.5 / static_cast<double>(points.at.size()));
  findFeatureSizes(spacing, points);
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(points.at.size()));
  std::printf(
      "%s: %zu points\n\n| cells divided by | discs | RMS distance / L | normals, RMS, degrees "
      "| 95th percentile | area of discs / L^2 |\n|---|---|---|---|---|---|\n",
      input.c_str(), points.at.size());
  printRow("radius alone", points, wanted, [](const Disc& d, double t) { return d.radius > t; });
  printRow("deviation of normals", points, wanted,
           [](const Disc& d, double t) { return d.deviation > t; });
  printRow("radius / feature size", points, wanted,
           [](const Disc& d, double t) { return d.radius > t * d.least_feature; });
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  std::string input;
  double share = 0.05;
  OptionTable options("splat_feature_size", "1",
                      "Discs of cells that are divided by radius, by normals and by feature size.");
  options.positional("IN", &input, "a cloud of less than some 100,000 points");
  options.number("share", &share, 1e-3, 1, "discs wanted, share of the points");
  if (const auto status = options.parse(argc, argv)) return *status;
  if (const Error error = study(input, share)) {
    std::fprintf(stderr, "splat_feature_size: %s\n", error.message.c_str());
    return kExitFailed;
  }
  return kExitDone;
}
