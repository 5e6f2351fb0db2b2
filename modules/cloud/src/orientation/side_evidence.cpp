// SPDX-License-Identifier: BSD-3-Clause
// What is known of the side of a surface (docs/sides.md, "Which side is out").
#include "pcl_slim/cloud/side_evidence.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

/** Area of the points about a place, and the cosine of the beam and their normal. */
struct PlaceArea {
  double area = 0;  ///< 0: they are along a line
  double cosine = 0;
};

PlaceArea areaAbout(const PointStore& store, const std::vector<std::uint32_t>& near,
                    const Vector3& beam) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t j : near) {
    const Vector3 p = store.position(j);
    mean += Eigen::Map<const Eigen::Vector3d>(p.data());
  }
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t j : near) {
    const Vector3 p = store.position(j);
    const Eigen::Vector3d d = Eigen::Map<const Eigen::Vector3d>(p.data()) - mean;
    covariance += d * d.transpose();
  }
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return {};
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance / largest);
  const Eigen::Vector3d& spread = solver.eigenvalues();
  constexpr double kLine = 1e-6;  // variance across a line of points [along it]
  if (!(spread[1] > kLine * spread[2])) return {};
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return {largest * std::sqrt(spread[1] * spread[2]),
          std::abs(normal.dot(Eigen::Map<const Eigen::Vector3d>(beam.data())))};
}

/** Median absolute deviation from the median. */
double spreadOf(std::vector<double> values) {
  const double middle = median(values);
  for (double& value : values) value = std::abs(value - middle);
  return median(std::move(values));
}

/** Logarithms of the areas about places of a cloud, and of what a scanner makes them follow. */
class ScannedPlaces {
 public:
  ScannedPlaces(const PointStore& store, const Vector3& eye)
      // Rings of a lidar are far apart: neighbours are sought among some of the points.
      : store_(store),
        eye_(eye),
        search_(store, std::max<std::size_t>(1, store.size() / kLooked)) {}

  void add(std::size_t i) {
    const Vector3 beam = subtract(eye_, store_.position(i));
    const double range = length(beam);
    search_.nearestSet(i, kAround, near_);
    if (!(range > 0) || near_.size() < kAround) return;
    const PlaceArea found = areaAbout(store_, near_, scaled(beam, 1 / range));
    if (!(found.area > 0)) return;
    areas_.push_back(std::log(found.area));
    followed_.push_back(2 * std::log(range) - std::log(std::max(kGrazing, found.cosine)));
  }

  /** Spread of the areas that a scanner's solid angles leave over that of the areas; 1: too few
   * places, or too much alike for the angles to show. */
  double ratio() const {
    if (areas_.size() < kLeastPlaces || spreadOf(followed_) < kLeastChange) return 1;
    std::vector<double> left(areas_);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= followed_[k];
    const double spread = spreadOf(areas_);
    return spread > 0 ? spreadOf(std::move(left)) / spread : HUGE_VAL;
  }

 private:
  static constexpr std::size_t kLooked = 16384, kAround = 64, kLeastPlaces = 32;
  static constexpr double kGrazing = 0.05;     // least cosine: a plane fit does not show it better
  static constexpr double kLeastChange = 0.1;  // spread of log(r^2 / cos)

  const PointStore& store_;
  Vector3 eye_;
  NeighborSearch search_;
  std::vector<std::uint32_t> near_;
  std::vector<double> areas_, followed_;
};

}  // namespace

double scannerSpread(const PointStore& store, const std::array<double, 3>& eye) {
  constexpr std::size_t kPlaces = 512;
  constexpr std::size_t kFirst = 4;            // every fourth place comes first ...
  constexpr double kClear = 0.5, kNone = 1.3;  // ... and suffices below and above these ratios
  const Vector3 from = scaled(subtract(eye, store.origin()), 1 / store.scale());
  ScannedPlaces scanned(store, from);
  const std::size_t places = std::min(kPlaces, store.size());
  for (std::size_t k = 0; k < places; k += kFirst) scanned.add(k * store.size() / places);
  const double first = scanned.ratio();
  if (first < kClear || first > kNone) return first;
  for (std::size_t k = 0; k < places; ++k) {
    if (k % kFirst != 0) scanned.add(k * store.size() / places);
  }
  return scanned.ratio();
}

SideEvidence findSensorEvidence(const PointStore& store,
                                const std::optional<std::array<double, 3>>& viewpoint) {
  if (viewpoint) return {SideSource::kViewpoint, viewpoint};
  if (store.hasSensors()) return {SideSource::kSensors, {}};
  if (store.sensor()) return {SideSource::kViewpoint, store.sensor()};
  constexpr std::array<double, 3> kOrigin{};
  if (scannerSpread(store, kOrigin) <= kMostScannerSpread) return {SideSource::kOrigin, kOrigin};
  return {};
}

SideEvidence findSideEvidence(const PointStore& store,
                              const std::optional<std::array<double, 3>>& viewpoint) {
  if (store.hasNormals()) return {SideSource::kNormals, {}};
  return findSensorEvidence(store, viewpoint);
}

const char* nameOf(SideSource source) {
  switch (source) {
    case SideSource::kNormals: return "normals";
    case SideSource::kSensors: return "sensors";
    case SideSource::kViewpoint: return "viewpoint";
    case SideSource::kOrigin: return "origin";
    case SideSource::kThinParts: return "thin_parts";
    case SideSource::kOutward: return "outward";
    default: return "none";
  }
}

std::vector<std::string> sideNotes(SideSource source, const NormalAgreement& normals,
                                   const std::string& remedy) {
  std::vector<std::string> notes;
  if (normals.contradicts()) {
    char text[120];
    std::snprintf(text, sizeof(text), "normals of %.1f %% of the neighbours are opposed: %s",
                  100 * normals.opposed,
                  normals.hasAxes() ? "used without their signs"
                                    : "not used, as they have no axes in common either");
    notes.emplace_back(text);
  }
  if (source == SideSource::kOutward || source == SideSource::kThinParts)
    notes.push_back("sides: outward (no sensor known; " + remedy +
                    " if it was scanned from inside)");
  if (source == SideSource::kOrigin)
    notes.push_back("sides: towards the origin, as the points' spacing shows a scanner there (" +
                    remedy + " if it was elsewhere)");
  return notes;
}

}  // namespace pcl_slim
