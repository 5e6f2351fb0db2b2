// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Steps": points that were rounded in one direction are on parallel planes.
#include "noise/step_axis.h"

#include <algorithm>
#include <vector>

#include "noise/patch_noise.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kPatch = 20;  ///< nearest points among which a terrace is looked for

/** Points of one plane: those of a small patch that are on a common plane with its sample. */
struct Terrace {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< 0: none
  std::vector<Eigen::Vector3d> points;               ///< local positions
};

/** The plane through a patch's sample and two of its points that contains most of the others. */
Eigen::Vector3d
fullestPlane(const Patch& patch, double resolution, std::size_t& most)
{
  constexpr double kLeastSine = 0.3;
  Eigen::Vector3d fullest = Eigen::Vector3d::Zero();
  most = 0;
  const std::size_t n = patch.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d p = patch.points.at(i), q = patch.points.at(j);
      const Eigen::Vector3d normal = p.cross(q);
      if (!(normal.norm() > kLeastSine * p.norm() * q.norm())) continue;
      const Eigen::Vector3d unit = normal.normalized();
      std::size_t count = 0;
      for (std::size_t l = 0; l < n; ++l)
        count += std::abs(unit.dot(patch.points.at(l))) < resolution;
      if (count <= most) continue;
      most = count;
      fullest = unit;
    }
  }
  return fullest;
}

Terrace
terraceAt(const PointStore& store, NeighborSearch& search, std::size_t sample,
          const StepConstants& constants)
{
  thread_local Patch patch;
  const double resolution = constants.resolution * store.diagonal();
  patchAbout(store, search, sample, kPatch, patch);
  Terrace terrace;
  std::size_t count = 0;
  const Eigen::Vector3d normal = fullestPlane(patch, resolution, count);
  if (count < constants.terrace) return terrace;
  terrace.normal = normal;
  const Vector3 at = store.position(sample);
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    const Eigen::Vector3d p = patch.points.at(i);
    if (std::abs(normal.dot(p)) < resolution)
      terrace.points.emplace_back(p + Eigen::Vector3d(at[0], at[1], at[2]));
  }
  return terrace;
}

/** Those of a direction that most terraces have. */
std::vector<Terrace>
mostParallel(const std::vector<Terrace>& terraces, double sine)
{
  std::size_t most = 0, best = 0;
  const auto areParallel = [&](std::size_t i, std::size_t j) {
    return terraces[i].normal.cross(terraces[j].normal).norm() < sine;
  };
  for (std::size_t i = 0; i < terraces.size(); ++i) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < terraces.size(); ++j) count += areParallel(i, j);
    if (count <= most) continue;
    most = count;
    best = i;
  }
  std::vector<Terrace> parallel;
  for (std::size_t j = 0; j < terraces.size(); ++j) {
    if (areParallel(best, j)) parallel.push_back(terraces[j]);
  }
  return parallel;
}

Eigen::Vector3d
meanNormal(const std::vector<Terrace>& parallel)
{
  const Eigen::Vector3d& first = parallel.front().normal;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Terrace& terrace : parallel)
    sum += terrace.normal.dot(first) < 0 ? -terrace.normal : terrace.normal;
  return sum.normalized();
}

/** The direction in which points of one level scatter least. Terraces whose places along an axis differ by
 * no more than a tolerance are of one level. */
Eigen::Vector3d
commonNormal(std::vector<Terrace> terraces, const Eigen::Vector3d& axis, double same)
{
  const auto place = [&](const Terrace& terrace) { return axis.dot(terrace.points.front()); };
  std::sort(terraces.begin(), terraces.end(),
            [&](const Terrace& a, const Terrace& b) { return place(a) < place(b); });
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t first = 0, end = 0; first < terraces.size(); first = end) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (end = first; end < terraces.size(); ++end) {
      if (end > first && place(terraces[end]) - place(terraces[end - 1]) > same) break;
      for (const Eigen::Vector3d& p : terraces[end].points) sum += p;
      count += static_cast<double>(terraces[end].points.size());
    }
    for (std::size_t t = first; t < end; ++t) {
      for (const Eigen::Vector3d& p : terraces[t].points) {
        const Eigen::Vector3d from_mean = p - sum / count;
        scatter += from_mean * from_mean.transpose();
      }
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  return axes.eigenvectors().col(0);
}

}  // namespace

std::optional<Eigen::Vector3d>
findStepAxis(const PointStore& store, const StepConstants& constants, int threads)
{
  std::vector<Terrace> terraces(std::min(constants.places, store.size()));
  const auto least =
      static_cast<std::size_t>(constants.least_terraces * static_cast<double>(terraces.size()));
  sampleStore(store, terraces.size(), 1, threads,
              [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
                terraces[s] = terraceAt(store, search, sample, constants);
                return 0.0;
              });
  terraces.erase(std::remove_if(terraces.begin(), terraces.end(),
                                [](const Terrace& terrace) { return terrace.points.empty(); }),
                 terraces.end());
  if (terraces.empty() || terraces.size() < least) return {};
  const std::vector<Terrace> parallel = mostParallel(terraces, constants.parallel);
  if (parallel.size() < least) return {};
  // Points of a level that are far apart give the axis more exactly than a small terrace does.
  Eigen::Vector3d axis = meanNormal(parallel);
  for (const double same : {30.0, 3.0})
    axis = commonNormal(parallel, axis, same * constants.resolution * store.diagonal());
  return axis;
}

}  // namespace pcl_slim::detail
