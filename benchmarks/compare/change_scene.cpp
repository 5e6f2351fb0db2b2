// SPDX-License-Identifier: BSD-3-Clause
#include "compare/change_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "support/lab/bench.h"

namespace pcl_slim::change {

namespace {

/** Share of the depth at a distance from the middle [radius]. */
double profile(double s) {
  if (s <= Dent::kCore) return 1;
  if (s >= 1) return 0;
  return 0.5 + 0.5 * std::cos(3.14159265358979323846 * (s - Dent::kCore) / (1 - Dent::kCore));
}

}  // namespace

CloudView Scan::view() const {
  CloudView made;
  made.xyz = points.data();
  made.scalar = CloudView::Scalar::kDouble;
  made.xyz_stride = sizeof(Vector3);
  made.size = points.size();
  return made;
}

Scan scanOf(measure::Shape shape, std::size_t count, double noise, std::uint64_t seed,
            const Dent& dent) {
  const measure::Scene scene = measure::makeScene(shape, count, 0, 0, seed);
  Scan scan;
  scan.diagonal = scene.diagonal;
  std::mt19937_64 random(seed ^ 0x5bd1e995u);
  std::normal_distribution<double> gauss(0, noise * scene.diagonal);
  std::vector<Vector3> exact(count);
  for (std::size_t i = 0; i < count; ++i) {
    exact[i] = {scene.points[3 * i], scene.points[3 * i + 1], scene.points[3 * i + 2]};
  }
  const auto middle =
      *std::min_element(exact.begin(), exact.end(), [&](const auto& a, const auto& b) {
        return length(subtract(a, dent.near)) < length(subtract(b, dent.near));
      });
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 normal = {scene.normals[3 * i], scene.normals[3 * i + 1],
                            scene.normals[3 * i + 2]};
    const double off = length(subtract(exact[i], middle));
    const double change = dent.depth > 0 ? -dent.depth * profile(off / dent.radius) : 0.0;
    Vector3 p = along(exact[i], change, normal);
    for (double& x : p) x += gauss(random);
    scan.points.push_back(p);
    scan.normals.push_back(normal);
    scan.change.push_back(change);
    scan.rim.push_back(shape == measure::Shape::kRelief &&
                       std::max(std::abs(exact[i][0]), std::abs(exact[i][1])) > 0.95);
  }
  return scan;
}

Score scoreOf(const Scan& scan, const std::vector<std::size_t>& chosen, const Estimate& estimate,
              double threshold) {
  Score score;
  double count = 0, known = 0, core = 0, volume = 0, true_volume = 0, greatest = 0;
  std::vector<double> detections;
  for (const double change : scan.change) greatest = std::max(greatest, std::abs(change));
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const std::size_t i = chosen[k];
    if (scan.rim[i]) continue;
    ++count;
    const double truth = scan.change[i], found = estimate.distance[k];
    if (!std::isfinite(found)) continue;
    ++known;
    const double detection = estimate.detection.empty() ? threshold : estimate.detection[k];
    detections.push_back(detection);
    score.rms += (found - truth) * (found - truth);
    score.within += std::abs(found - truth) <= detection;
    if (truth == 0) continue;
    volume += found;
    true_volume += truth;
    if (std::abs(truth) < greatest) continue;
    ++core;
    score.detected += std::abs(found) > detection;
  }
  score.rms = std::sqrt(score.rms / known);
  score.within /= known;
  score.detected /= core;
  score.volume = volume / true_volume;
  score.known = known / count;
  score.detection = measure::median(std::move(detections));
  return score;
}

}  // namespace pcl_slim::change
