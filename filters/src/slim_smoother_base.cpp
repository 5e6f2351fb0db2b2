// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_smoother_base.h"

#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/scalar_type.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"
#include "upsampling.h"

namespace pcl_slim {

namespace {

using namespace detail;

// Variance of a fit's value at its centre, in units of sigma^2 / (points in the ball), for points
// spread evenly: 4.17 for MovingLeastSquares (weight exp(-d^2/r^2) within r, order 2), 8.36 up to
// degree 3 and 16.1 at degree 4 for ours (weight (1 - d^2/R^2)^4). Equal at R^2 / r^2 = 8.36 / 4.17
// and 16.1 / 4.17.
constexpr double kRadiiOfCubic = 1.42;
constexpr double kRadiiOfQuartic = 1.97;
constexpr double kPlaceReach =
    0.5;  ///< of a ball's radius: half of it around the foot is surely covered

Error needsPositive(const char* what) {
  return {ErrorCode::kBadArgument, std::string(what) + " must be a positive number; set it"};
}

bool isPositive(double value) {
  return value > 0 && std::isfinite(value);
}

}  // namespace

double SLIMSmootherBase::getSqrGaussParam() const {
  return sqr_gauss_param_ > 0 ? sqr_gauss_param_ : search_radius_ * search_radius_;
}

void SLIMSmootherBase::warnUnused() {
  std::string setters;
  const auto name = [&](bool called, const char* setter) {
    if (called) setters += (setters.empty() ? "" : ", ") + std::string(setter);
  };
  name(sqr_gauss_param_ != 0, "setSqrGaussParam");
  name(cache_results_, "setCacheMLSResults");
  name(projection_method_ != pcl::MLSResult::SIMPLE, "setProjectionMethod");
  if (!setters.empty()) warn("no effect here, unlike in MovingLeastSquares: " + setters);
}

Error SLIMSmootherBase::checkSmoother(bool has_distinct) const {
  if (!(search_radius_ >= 0) || !std::isfinite(search_radius_))
    return {ErrorCode::kBadArgument, "the search radius must not be negative (0: none)"};
  switch (upsampling_) {
    case NONE: return {};
    case DISTINCT_CLOUD:
      if (has_distinct) return {};
      return {ErrorCode::kBadInput, "no distinct cloud is set; call setDistinctCloud()"};
    case SAMPLE_LOCAL_PLANE:
      if (!isPositive(upsampling_radius_)) return needsPositive("the upsampling radius");
      if (!isPositive(upsampling_step_)) return needsPositive("the upsampling step");
      if (upsampling_radius_ <= 1000 * upsampling_step_) return {};
      return {ErrorCode::kBadArgument, "the upsampling step is too small for its radius; raise it"};
    case RANDOM_UNIFORM_DENSITY:
      if (search_radius_ == 0) return needsPositive("the search radius, which density is told in,");
      return point_density_ > 0 ? Error() : needsPositive("the point density");
    case VOXEL_GRID_DILATION:
      if (!isPositive(voxel_size_)) return needsPositive("the voxel size");
      if (dilations_ >= 0 && dilations_ <= 1000) return {};
      return {ErrorCode::kBadArgument, "the dilation iterations must be 0 to 1000"};
  }
  return {ErrorCode::kBadArgument, "the upsampling method is none of the five; name one"};
}

std::vector<SLIMSmootherBase::CommonBytes> SLIMSmootherBase::commonFields(
    const std::vector<pcl::PCLPointField>& from, const std::vector<pcl::PCLPointField>& to) {
  const auto isColor = [](const std::string& name) { return name == "rgb" || name == "rgba"; };
  std::vector<CommonBytes> copies;
  for (const pcl::PCLPointField& a : from) {
    for (const pcl::PCLPointField& b : to) {
      const bool same = a.name == b.name && a.datatype == b.datatype && a.count == b.count;
      if (!same && !(isColor(a.name) && isColor(b.name))) continue;
      const CommonBytes field{a.offset, b.offset, scalarSize(a.datatype) * a.count};
      CommonBytes* last = copies.empty() ? nullptr : &copies.back();
      const bool adjoins =
          last && last->from + last->count == field.from && last->to + last->count == field.to;
      if (adjoins)
        last->count += field.count;
      else
        copies.push_back(field);
    }
  }
  return copies;
}

void SLIMSmootherBase::complain() const {
  if (error_ && error_.code != ErrorCode::kCancelled)
    PCL_ERROR("[pcl_slim::SLIMProjectionSmoother::process] %s\n", error_.message.c_str());
  if (!error_) printWarning("SLIMProjectionSmoother::process");
}

ProjectionParams SLIMSmootherBase::requestedBy(const Target& target) const {
  ProjectionParams requested;
  if (!compute_normals_) return requested;
  const bool curvature = target.curvature != kNoField && curvature_ != kSurfaceVariation;
  requested.curvature = curvature || target.hasCurvatures();
  requested.planes = target.normal != kNoField || target.curvature != kNoField;
  requested.variation = target.curvature != kNoField && curvature_ == kSurfaceVariation;
  return requested;
}

bool SLIMSmootherBase::smooth(const CloudView& points, const ProjectionParams& requested,
                              CloudProjection& projection) {
  FitParams fit = params_;
  const double radii = *fit.resolved().degree < 4 ? kRadiiOfCubic : kRadiiOfQuartic;
  fit.least_radius = unlessZero(std::max(fit.least_radius.value_or(0), radii * search_radius_));
  return project(points, points, fit, requested, projection);
}

/** Points to project onto the surface in addition to the input's own. */
struct SLIMSmootherBase::Candidates {
  std::vector<double> xyz;
  std::vector<float> normals;  ///< of the input points they belong to; zero where there is none
  std::vector<std::uint32_t> source;  ///< the input point of each, an index into the view's points

  void add(std::size_t from, const std::array<double, 3>& place);
  void keep(const CloudProjection& projection);
  void addAround(const CloudProjection& own, std::size_t from,
                 const std::vector<std::array<double, 2>>& steps);
};

void SLIMSmootherBase::Candidates::add(std::size_t from, const std::array<double, 3>& place) {
  source.push_back(static_cast<std::uint32_t>(from));
  xyz.insert(xyz.end(), place.begin(), place.end());
}

/** Moves candidates to their projection, and drops those without support. */
void SLIMSmootherBase::Candidates::keep(const CloudProjection& projection) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (!projection.isSupported(i)) continue;
    const Position p = projection.point(i).position;
    for (std::size_t a = 0; a < 3; ++a) {
      xyz[3 * kept + a] = p[a];
      normals[3 * kept + a] = normals[3 * i + a];
    }
    source[kept++] = source[i];
  }
  source.resize(kept);
  xyz.resize(3 * kept);
  normals.resize(3 * kept);
}

/** Adds places in the tangent plane of an input point's foot. */
void SLIMSmootherBase::Candidates::addAround(const CloudProjection& own, std::size_t from,
                                             const std::vector<std::array<double, 2>>& steps) {
  const ProjectedPoint foot = own.point(from);
  const auto& n = foot.normal;
  const LocalFrame t({n[0], n[1], n[2]});
  for (const auto& [u, v] : steps) {
    Position p = foot.position;
    for (std::size_t a = 0; a < 3; ++a) p[a] += u * t.u[a] + v * t.v[a];
    add(from, p);
  }
}

void SLIMSmootherBase::sampleAround(const CloudView& points, const CloudProjection& own,
                                    Candidates& candidates) const {
  const bool by_density = upsampling_ == RANDOM_UNIFORM_DENSITY;
  const auto grid = by_density ? std::vector<std::array<double, 2>>()
                               : discGrid(upsampling_radius_, upsampling_step_);
  const auto counts =
      by_density ? countNeighbors(points, search_radius_) : std::vector<std::uint32_t>();
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!own.isSupported(i)) continue;
    if (!by_density) {
      candidates.addAround(own, i, grid);
      continue;
    }
    const auto wanted = static_cast<std::size_t>(point_density_ / 2.0 / counts[i]);
    if (wanted == 0)
      candidates.add(i, own.point(i).position);
    else
      candidates.addAround(own, i, discSamples(wanted, search_radius_ / 2, params_.seed + i));
  }
}

bool SLIMSmootherBase::collect(const CloudView& points, const CloudProjection& own,
                               const CloudView& distinct, Candidates& candidates) {
  if (upsampling_ == SAMPLE_LOCAL_PLANE || upsampling_ == RANDOM_UNIFORM_DENSITY) {
    sampleAround(points, own, candidates);
    return true;
  }
  std::vector<Position> places;
  if (upsampling_ == VOXEL_GRID_DILATION) {
    auto corners = dilatedVoxels(points, voxel_size_, dilations_);
    if (!corners) return fail(corners.error().code, corners.error().message);
    places = std::move(*corners);
  }
  for (std::size_t i = 0; upsampling_ == DISTINCT_CLOUD && i < distinct.count(); ++i) {
    const Position p = distinct.position(distinct.inputIndex(i));
    if (isFinite(p)) places.push_back(p);
  }
  const std::vector<std::uint32_t> nearest = nearestPoints(points, places);
  for (std::size_t i = 0; i < places.size(); ++i) candidates.add(nearest[i], places[i]);
  return true;
}

bool SLIMSmootherBase::projectCandidates(const CloudView& points, const ProjectionParams& requested,
                                         const CloudProjection& own, const CloudView& distinct,
                                         Candidates& candidates, CloudProjection& projection) {
  if (!collect(points, own, distinct, candidates)) return false;
  if (candidates.source.empty()) return true;
  candidates.normals.resize(candidates.xyz.size(), 0.0f);
  for (std::size_t i = 0; i < candidates.source.size(); ++i) {
    if (!own.isSupported(candidates.source[i])) continue;
    const auto normal = own.point(candidates.source[i]).normal;
    std::copy(normal.begin(), normal.end(),
              candidates.normals.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  CloudView view;
  view.xyz = candidates.xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = candidates.source.size();
  if (points.normal != nullptr) {  // they keep sheets apart, as those of the input do
    view.normal = candidates.normals.data();
    view.normal_stride = 3 * sizeof(float);
  }
  ProjectionParams params;
  params.reach = kPlaceReach;
  CloudProjection near;
  if (!projectMore(view, params, near)) return false;
  candidates.keep(near);
  if (candidates.source.empty()) return true;
  view.xyz = candidates.xyz.data();
  view.normal = view.normal ? candidates.normals.data() : nullptr;
  view.size = candidates.source.size();
  params.curvature = requested.curvature;
  params.planes = requested.planes;
  params.variation = requested.variation;
  return projectMore(view, params, projection);
}

ProjectedPoint SLIMSmootherBase::upsampled(const Candidates& candidates,
                                           const CloudProjection& projection, std::size_t i) const {
  ProjectedPoint point = projection.point(i);
  const float* normal = candidates.normals.data() + 3 * i;
  const float along =
      normal[0] * point.normal[0] + normal[1] * point.normal[1] + normal[2] * point.normal[2];
  if (along < 0.0f) {
    for (float& component : point.normal) component = -component;
    point.mean_curvature = -point.mean_curvature;
  }
  return point;
}

namespace {

/** k1 and k2 of a point's mean and Gaussian curvature. */
std::array<float, 2> principalOf(const ProjectedPoint& point) {
  const double mean = point.mean_curvature, gaussian = point.gaussian_curvature;
  const double half_gap = std::sqrt(std::max(0.0, mean * mean - gaussian));
  return {static_cast<float>(mean + half_gap), static_cast<float>(mean - half_gap)};
}

}  // namespace

float SLIMSmootherBase::curvatureOf(const ProjectedPoint& point) const {
  switch (curvature_) {
    case kMean: return point.mean_curvature;
    case kGaussian: return point.gaussian_curvature;
    case kMaximum: return principalOf(point)[0];
    case kMinimum: return principalOf(point)[1];
    case kSurfaceVariation: break;
  }
  return point.surface_variation;
}

bool SLIMSmootherBase::run(const Source& source, const Target& target, bool& dense) {
  dense = true;
  CloudProjection projection;
  if (!smooth(source.view, requestedBy(target), projection)) return false;
  warnUnused();
  if (upsampling_ == NONE || foundNoSurface()) {
    dense = write(source, projection, target);
    return true;
  }
  upsample(source, projection, target);
  return false;
}

/** Writes three numbers or one into a field, if the points have it. */
template <std::size_t N>
static void setField(const std::array<float, N>& values, std::size_t offset, unsigned char* to) {
  if (offset != static_cast<std::size_t>(-1))
    std::memcpy(to + offset, values.data(), sizeof(values));
}

/** Writes place, normal and curvature. */
void SLIMSmootherBase::put(const ProjectedPoint& point, const Target& target,
                           unsigned char* to) const {
  const auto& p = point.position;
  setField<3>({finiteFloat(p[0]), finiteFloat(p[1]), finiteFloat(p[2])}, target.position, to);
  putNormal(point, target, to);
}

/** Writes normal and curvature, unless they are to be copied. */
void SLIMSmootherBase::putNormal(const ProjectedPoint& point, const Target& target,
                                 unsigned char* to) const {
  if (!compute_normals_) return;
  setField(point.normal, target.normal, to);
  if (target.curvature != kNoField) setField<1>({curvatureOf(point)}, target.curvature, to);
  if (!target.hasCurvatures()) return;
  const auto [k1, k2] = principalOf(point);
  setField<1>({point.mean_curvature}, target.mean, to);
  setField<1>({point.gaussian_curvature}, target.gaussian, to);
  setField<1>({k1}, target.k1, to);
  setField<1>({k2}, target.k2, to);
}

bool SLIMSmootherBase::write(const Source& source, const CloudProjection& projection,
                             const Target& target) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const ProjectedPoint unknown = CloudProjection::unknownPoint({kNan, kNan, kNan});
  const std::size_t count = projection.size();
  unsigned char* const points = target.resize(count);
  const auto copyFields = [&](const unsigned char* from, unsigned char* to) {
    for (const CommonBytes& bytes : target.copies)
      std::memcpy(to + bytes.to, from + bytes.from, bytes.count);
  };
  corresponding_->indices.resize(count);
  std::atomic<bool> dense{true};
  const bool has_normals = compute_normals_ && target.normal != kNoField;
  parallelFor(count, resolveThreads(params_.threads), 4096, [&](std::size_t i, int) {
    const auto from = source.indices ? static_cast<std::size_t>((*source.indices)[i]) : i;
    unsigned char* const to = points + i * target.step;
    corresponding_->indices[i] = static_cast<pcl::index_t>(from);
    copyFields(source.points + from * source.step, to);
    if (projection.isSupported(i)) return put(projection.point(i), target, to);
    const bool finite = projection.isFinite(i);
    const ProjectedPoint point = finite ? projection.point(i) : unknown;
    putNormal(point, target, to);
    if (!finite || (has_normals && std::isnan(point.normal[0]))) dense = false;
  });
  return dense;
}

void SLIMSmootherBase::upsample(const Source& source, const CloudProjection& own,
                                const Target& target) {
  Candidates candidates;
  CloudProjection projection;
  if (!projectCandidates(source.view, requestedBy(target), own, source.distinct, candidates,
                         projection))
    return;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < projection.size(); ++i)
    if (projection.isSupported(i)) kept.push_back(i);
  unsigned char* const points = target.resize(kept.size());
  const auto copyFields = [&](const unsigned char* from, unsigned char* to) {
    for (const CommonBytes& bytes : target.copies)
      std::memcpy(to + bytes.to, from + bytes.from, bytes.count);
  };
  corresponding_->indices.resize(kept.size());
  parallelFor(kept.size(), resolveThreads(params_.threads), 4096, [&](std::size_t k, int) {
    const std::size_t asked = candidates.source[kept[k]];
    const auto from = source.indices ? static_cast<std::size_t>((*source.indices)[asked]) : asked;
    unsigned char* const to = points + k * target.step;
    corresponding_->indices[k] = static_cast<pcl::index_t>(from);
    copyFields(source.points + from * source.step, to);
    put(upsampled(candidates, projection, kept[k]), target, to);
  });
}

}  // namespace pcl_slim
