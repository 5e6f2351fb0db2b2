// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/cloud_projection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

/** Reverses a point's normal and all that depends on its sign. */
void turn(ProjectedPoint& point) {
  for (float& value : point.normal) value = -value;
  point.mean_curvature = -point.mean_curvature;
  PrincipalFrame& principal = point.principal;
  std::swap(principal.k1, principal.k2);
  std::swap(principal.direction1, principal.direction2);
  principal.k1 = -principal.k1;
  principal.k2 = -principal.k2;
  std::swap(principal.extremality1, principal.extremality2);
  principal.extremality1 = -principal.extremality1;
  principal.extremality2 = -principal.extremality2;
}

/** As a float, the largest there is where it is beyond: in clouds of 1e-25 units squared curvatures
 * are. */
float saturated(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

/** Brings curvatures to another unit of length: factor of the new ones is one of the old. */
void rescale(double factor, PrincipalFrame& principal) {
  principal.k1 = saturated(principal.k1 / factor);
  principal.k2 = saturated(principal.k2 / factor);
  principal.extremality1 = saturated(principal.extremality1 / factor / factor);
  principal.extremality2 = saturated(principal.extremality2 / factor / factor);
}

StandardErrors rescaled(double factor, const StandardErrors& errors) {
  return {saturated(errors.position * factor), errors.normal, saturated(errors.curvature / factor)};
}

Error foreignSurface(const CloudProjectionStatistics& statistics) {
  return {ErrorCode::kBadInput,
          "the surface supports " + std::to_string(statistics.moved) + " of " +
              std::to_string(statistics.points - statistics.non_finite) +
              " points: it is of another cloud or faces the other way; give this cloud's"};
}

/** What the surface should face at a store's points. */
class WantedSides {
 public:
  /** \param[in] seen what points without normals show */
  WantedSides(const PointStore& store, const SideEvidence& seen) : store_(store), seen_(seen) {
    if (seen.eye) eye_ = scaled(subtract(*seen.eye, store.origin()), 1 / store.scale());
  }

  /** Whether a surface normal at a stored point faces the wrong side. */
  bool facesAway(std::size_t i, const Vector3& position, const std::array<float, 3>& n) const {
    const Vector3 normal{n[0], n[1], n[2]};
    if (store_.hasNormals()) {
      const std::array<float, 3> own = store_.normal(i);
      return dot({own[0], own[1], own[2]}, normal) < 0;
    }
    if (seen_.eye) return dot(subtract(eye_, position), normal) < 0;
    if (!store_.hasSensors()) return false;
    // The surface faces the points' sensors as a whole; a grazing beam decides less than it does.
    const Vector3 ray = subtract(store_.sensor(i), position);
    return dot(ray, normal) < -detail::SideConstants().clear_beam * length(ray);
  }

 private:
  const PointStore& store_;
  const SideEvidence& seen_;
  Vector3 eye_{};
};

}  // namespace

Result<CloudProjection> CloudProjection::make(const CloudView& cloud, const SLIMSurface& surface,
                                              const CloudProjectionParams& params,
                                              Progress* progress, const PointStore* store) {
  std::optional<PointStore> own;
  if (store == nullptr) {
    Result<PointStore> built = PointStore::build(cloud, params.projection.threads);
    if (!built) return built.error();
    own.emplace(std::move(*built));
    settleNormals(params.viewpoint, params.projection.threads, *own);
    store = &*own;
  }
  CloudProjection made;
  made.cloud_ = cloud;
  made.params_ = params;
  made.origin_ = store->origin();
  made.scale_ = store->scale();
  made.input_statistics_ = store->statistics();
  made.stored_ = store->storeOfInput();
  if (!store->hasNormals() || store->statistics().without_normal > 0) {
    made.seen_ = findSensorEvidence(*store, params.viewpoint);
    // A surface faces the origin already where its own points show a scanner there; a piece of them
    // shows it less well.
    if (made.seen_.source == SideSource::kOrigin) made.seen_ = {};
  }
  if (Error error = made.add(*store, surface, progress)) return error;
  std::uint64_t left = store->statistics().far_away;
  if (store->statistics().without_normal > 0) {
    if (Error error = made.addRest(surface, progress, store, left)) return error;
  }
  while (left > 0) {  // strays may have strays of their own
    if (Error error = made.addRest(surface, progress, nullptr, left)) return error;
  }
  if (params.projection.planes) made.addPlanes(*store);
  CloudProjectionStatistics& statistics = made.statistics_;
  statistics.points = made.size();
  statistics.non_finite = statistics.points - statistics.moved - statistics.unsupported;
  const auto moved = static_cast<double>(std::max<std::uint64_t>(statistics.moved, 1));
  statistics.rms_displacement = std::sqrt(statistics.rms_displacement / moved);
  const auto finite = static_cast<double>(statistics.moved + statistics.unsupported);
  if (static_cast<double>(statistics.moved) < params.least_support * finite) {
    return foreignSurface(statistics);
  }
  return made;
}

CloudProjection CloudProjection::ofNothing(std::size_t points) {
  CloudProjection made;
  made.stored_.assign(points, PointStore::kSkipped);
  made.statistics_.points = made.statistics_.non_finite = points;
  return made;
}

std::array<double, 3> CloudProjection::toFirst(const PointStore& store,
                                               const std::array<double, 3>& local) const {
  std::array<double, 3> p;
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = (store.origin()[a] - origin_[a]) / scale_ + store.scale() / scale_ * local[a];
  }
  return p;
}

Error CloudProjection::add(const PointStore& store, const SLIMSurface& surface,
                           Progress* progress) {
  Projection more;
  if (Error error = projectPoints(store, surface, params_.projection, more, progress)) return error;
  const WantedSides wanted(store, seen_);
  for (std::size_t i = 0; i < store.size(); ++i)
    turned_.push_back(wanted.facesAway(i, more.position[i], more.normal[i]) ? 1 : 0);
  const std::size_t first = projection_.position.size();
  if (first == 0) {
    projection_ = std::move(more);
    measure(first);
    return {};
  }
  const double factor = store.scale() / scale_;
  for (std::size_t i = 0; i < more.position.size(); ++i) {
    projection_.position.push_back(toFirst(store, more.position[i]));
    projection_.normal.push_back(more.normal[i]);
    projection_.supported.push_back(more.supported[i]);
    projection_.inside.push_back(more.inside[i]);
    if (!more.curvature.empty()) {
      auto [mean, gaussian] = more.curvature[i];
      projection_.curvature.push_back(
          {saturated(mean / factor), saturated(gaussian / factor / factor)});
    }
    if (!more.principal.empty()) {
      rescale(factor, projection_.principal.emplace_back(more.principal[i]));
    }
    if (!more.errors.empty()) projection_.errors.push_back(rescaled(factor, more.errors[i]));
  }
  measure(first);
  return {};
}

void CloudProjection::keep(const PointStore& store) {
  const std::size_t count = projection_.position.size() + store.size();
  projection_.position.resize(count);
  projection_.normal.resize(count);
  projection_.supported.resize(count);
  projection_.inside.resize(count);
  turned_.resize(count);
  if (!projection_.curvature.empty()) projection_.curvature.resize(count);
  if (!projection_.principal.empty()) projection_.principal.resize(count);
  if (!projection_.errors.empty()) projection_.errors.resize(count);
  measure(count - store.size());
}

Error CloudProjection::addRest(const SLIMSurface& surface, Progress* progress,
                               const PointStore* frame, std::uint64_t& left) {
  std::vector<std::int32_t> indices;  // those of non-finite points too: the store skips them again
  std::vector<std::size_t> asked;
  bool known = cloud_.sensors != nullptr;  // the places that all of them were seen from
  for (std::size_t i = 0; i < size(); ++i) {
    if (stored_[i] != PointStore::kSkipped) continue;
    indices.push_back(static_cast<std::int32_t>(cloud_.inputIndex(i)));
    asked.push_back(i);
    known = known && pcl_slim::isFinite(cloud_.sensorPosition(cloud_.inputIndex(i)));
  }
  CloudView rest = cloud_;
  rest.normal = nullptr;
  if (!known) rest.sensors = nullptr;
  rest.frame_numbers = nullptr;
  rest.indices = indices.data();
  rest.num_indices = indices.size();
  const Result<PointStore> store = PointStore::build(rest, params_.projection.threads, frame);
  if (!store) return store.error();
  left = store->statistics().far_away;
  const std::vector<std::uint32_t> map = store->storeOfInput();
  const auto first = static_cast<std::uint32_t>(projection_.position.size());
  for (std::size_t j = 0; j < map.size(); ++j) {
    if (map[j] != PointStore::kSkipped) stored_[asked[j]] = first + map[j];
  }
  // Relative to these distant points the surface has no extent; they keep their position.
  constexpr double kPlace = 1e-20;
  if (surface.info.scale < kPlace * store->scale()) {
    keep(*store);
    return {};
  }
  return add(*store, surface, progress);
}

void CloudProjection::measure(std::size_t first) {
  for (std::size_t i = 0; i < size(); ++i) {
    if (!isFinite(i) || stored_[i] < first) continue;
    if (!isSupported(i)) {
      ++statistics_.unsupported;
      continue;
    }
    ++statistics_.moved;
    const auto from =
        cloud_.position(cloud_.inputIndex(i));  // the fit may have moved stored points
    const auto& to = projection_.position[stored_[i]];
    double length_sq = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double step = origin_[a] + scale_ * to[a] - from[a];
      length_sq += step * step;
    }
    statistics_.rms_displacement += length_sq;  // a sum until all points are in
    statistics_.max_displacement = std::max(statistics_.max_displacement, std::sqrt(length_sq));
  }
}

ProjectedPoint CloudProjection::unknownPoint(const std::array<double, 3>& place) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  ProjectedPoint point;
  point.position = place;
  PrincipalFrame& principal = point.principal;
  point.normal = principal.direction1 = principal.direction2 = {kNan, kNan, kNan};
  point.mean_curvature = point.gaussian_curvature = point.surface_variation = kNan;
  principal.k1 = principal.k2 = principal.extremality1 = principal.extremality2 = kNan;
  point.errors = {kNan, kNan, kNan};
  return point;
}

ProjectedPoint CloudProjection::point(std::size_t i) const {
  const std::size_t s = stored_[i];
  if (projection_.supported[s] == 0) {
    ProjectedPoint point = unknownPoint(cloud_.position(cloud_.inputIndex(i)));
    point.normal = ownNormal(i);
    if (!variation_.empty()) point.surface_variation = variation_[s];
    return point;
  }
  ProjectedPoint point;
  for (std::size_t a = 0; a < 3; ++a) {
    point.position[a] = origin_[a] + scale_ * projection_.position[s][a];
  }
  point.normal = projection_.normal[s];
  if (!variation_.empty()) point.surface_variation = variation_[s];
  if (!projection_.curvature.empty()) {
    const auto& curvature = projection_.curvature[s];
    point.mean_curvature = saturated(curvature[0] / scale_);
    point.gaussian_curvature = saturated(curvature[1] / scale_ / scale_);
  }
  if (!projection_.principal.empty()) {
    point.principal = projection_.principal[s];
    rescale(scale_, point.principal);
  }
  if (!projection_.errors.empty()) {
    point.errors = rescaled(scale_, projection_.errors[s]);
  }
  if (turned_[s] != 0) turn(point);
  return point;
}

template <typename Which>
std::vector<std::int32_t> CloudProjection::indicesOf(const Which& which) const {
  std::vector<std::int32_t> indices;
  for (std::size_t i = 0; i < size(); ++i) {
    if (which(i)) indices.push_back(static_cast<std::int32_t>(cloud_.inputIndex(i)));
  }
  return indices;
}

std::vector<std::int32_t> CloudProjection::unsupported() const {
  return indicesOf([this](std::size_t i) { return isFinite(i) && !isSupported(i); });
}

std::vector<std::int32_t> CloudProjection::outside() const {
  return indicesOf([this](std::size_t i) { return isSupported(i) && !isInside(i); });
}

}  // namespace pcl_slim
