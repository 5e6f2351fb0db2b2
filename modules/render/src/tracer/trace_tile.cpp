// SPDX-License-Identifier: BSD-3-Clause
#include "tracer/trace_tile.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/random.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"
#include "tiles/frame_rules.h"

namespace pcl_slim::detail {
namespace {

/** \brief Evenly spread points of the unit square, turned by pixel: the sequence of the generalised
 * golden ratio from a place that hashes the pixel. */
class SquareSamples {
 public:
  SquareSamples(std::uint64_t pixel, std::uint64_t stream)
  {
    const std::uint64_t z = mixBits((pixel * 64 + stream + 1) * SplitMix::kStep);
    x_ = static_cast<double>(z >> 40) * 0x1p-24;
    y_ = static_cast<double>(z & 0xffffffu) * 0x1p-24;
  }

  struct Place {
    double x, y;
  };
  Place at(std::uint64_t i) const
  {
    const double n = static_cast<double>(i);
    return {fraction(x_ + n * 0.75487766624669276), fraction(y_ + n * 0.56984029099805327)};
  }

 private:
  static double fraction(double v) { return v - std::floor(v); }

  double x_, y_;
};

constexpr double kFullTurn = 2 * M_PI;

/** \brief A direction of the half space above a unit normal, as often as its cosine is large. */
inline Vector3
cosineDirection(const Vector3& normal, const SquareSamples::Place& at)
{
  const LocalFrame frame(normal);
  const double rho = std::sqrt(at.x), angle = kFullTurn * at.y;
  const Vector3 flat =
      along(scaled(frame.u, rho * std::cos(angle)), rho * std::sin(angle), frame.v);
  return along(flat, std::sqrt(1.0 - at.x), frame.w);
}

/** \brief A direction within an angle, given by its tangent, of a unit axis. */
inline Vector3
coneDirection(const Vector3& axis, double tangent, const SquareSamples::Place& at)
{
  if (!(tangent > 0.0)) return axis;
  const LocalFrame frame(axis);
  const double rho = tangent * std::sqrt(at.x), angle = kFullTurn * at.y;
  const Vector3 flat =
      along(scaled(frame.u, rho * std::cos(angle)), rho * std::sin(angle), frame.v);
  return normalized(along(flat, 1.0, frame.w));
}

constexpr double kDegree = M_PI / 180.0;

}  // namespace

TraceFrame::TraceFrame(const TracedObject& o, const TraceView& v, const Camera& c)
    : object(o),
      view(v),
      camera(c),
      cuts(localHalfSpaces(v.params.cuts, o.origin, o.scale)),
      near_plane(v.params.near_plane / o.scale),
      reach(v.params.occlusion_reach * o.diagonal)
{
  for (const RayLight& light : v.params.lights) {
    towards.push_back(normalized(light.towards));
    tangent.push_back(std::tan(light.spread * kDegree));
  }
}

void
TraceTile::trace(const TraceFrame& frame, int x0, int y0, GBuffer& buffer, LightBuffer& light,
                 TraceStatistics& statistics)
{
  counts_ = RayCounts();
  shadow_ = occlusion_ = 0;
  traceCamera(frame, x0, y0, buffer);
  for (std::size_t l = 0; l < frame.towards.size(); ++l) traceLight(frame, l, buffer, light);
  if (frame.view.params.occlusion_rays > 0) traceOcclusion(frame, light);
  statistics.rays_primary += rays_.size();
  statistics.rays_shadow += shadow_;
  statistics.rays_occlusion += occlusion_;
  statistics.nodes += counts_.nodes;
  statistics.tested_first += counts_.leaves_first;
  statistics.tested_blend += counts_.leaves_blend;
  statistics.bracketed += counts_.bracketed;
  statistics.closed += counts_.closed;
  statistics.peeled += counts_.peeled;
  for (const MetPoint& point : met_) statistics.covered_pixels += point.met();
}

void
TraceTile::traceCamera(const TraceFrame& frame, int x0, int y0, GBuffer& buffer)
{
  rays_.clear();
  pixels_.clear();
  const int x1 = std::min(x0 + kTraceTile, buffer.width);
  const int y1 = std::min(y0 + kTraceTile, buffer.height);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      BoundedRay ray;
      ray.ray = frame.view.camera->ray(x, y);
      ray.nearest = frame.near_plane;
      cut(frame, ray);
      rays_.push_back(ray);
      pixels_.push_back(buffer.index(x, y));
    }
  }
  met_.assign(rays_.size(), MetPoint());
  frame.object.trace(frame.view, rays_.data(), rays_.size(), met_.data(), &buffer, pixels_.data(),
                     counts_);
}

/** \brief Bounds a ray to its part inside the frame's half spaces. */
void
TraceTile::cut(const TraceFrame& frame, BoundedRay& ray)
{
  const RayStretch left = within(frame.cuts, ray.ray, {ray.nearest, ray.farthest});
  ray.nearest = left.near;
  ray.farthest = left.far;
}

BoundedRay
TraceTile::leaving(const TraceFrame& frame, std::size_t i, const Vector3& direction) const
{
  const Ray& from = rays_[i].ray;
  const MetPoint& point = met_[i];
  const Departure departure = frame.object.departure(point);
  const Vector3 position = along(from.origin, point.depth, from.direction);
  BoundedRay ray;
  ray.ray = {along(position, departure.lift, point.normal), direction};
  ray.nearest_front = departure.front;
  ray.nearest_behind = departure.behind;
  ray.nearest_gap = departure.gap;
  cut(frame, ray);
  return ray;
}

void
TraceTile::block(const TraceFrame& frame, bool close_gaps)
{
  blocked_.resize(outgoing_.size());
  frame.object.block(outgoing_.data(), outgoing_.size(), close_gaps, blocked_.data(), counts_);
}

void
TraceTile::traceLight(const TraceFrame& frame, std::size_t l, const GBuffer& buffer,
                      LightBuffer& light)
{
  outgoing_.clear();
  source_.clear();
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (!met_[i].met()) continue;
    const SquareSamples samples(pixels_[i], l);
    const Vector3 direction =
        coneDirection(frame.towards[l], frame.tangent[l], samples.at(frame.view.params.sample));
    if (!(dot(direction, met_[i].normal) > 0.0)) continue;
    outgoing_.push_back(leaving(frame, i, direction));
    source_.push_back(i);
  }
  block(frame, frame.view.params.close_gaps);
  shadow_ += outgoing_.size();
  for (std::size_t k = 0; k < outgoing_.size(); ++k) {
    light.visible[l * buffer.numPixels() + pixels_[source_[k]]] = blocked_[k] ? 0.0f : 1.0f;
  }
}

void
TraceTile::traceOcclusion(const TraceFrame& frame, LightBuffer& light)
{
  constexpr std::uint64_t kStream = 63;  // apart from those of the lights
  const auto rays = static_cast<std::size_t>(frame.view.params.occlusion_rays);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (!met_[i].met()) continue;
    const SquareSamples samples(pixels_[i], kStream);
    outgoing_.clear();
    for (std::size_t k = 0; k < rays; ++k) {
      const auto at = samples.at(frame.view.params.sample * rays + k);
      outgoing_.push_back(leaving(frame, i, cosineDirection(met_[i].normal, at)));
      outgoing_.back().farthest = std::min(outgoing_.back().farthest, frame.reach);
    }
    block(frame, false);  // one ray of many: an error at a gap does not show
    occlusion_ += rays;
    const auto hidden = std::count(blocked_.begin(), blocked_.end(), std::uint8_t{1});
    light.open[pixels_[i]] = 1.0f - static_cast<float>(hidden) / static_cast<float>(rays);
  }
}

}  // namespace pcl_slim::detail
