// SPDX-License-Identifier: BSD-3-Clause
// Frames of traced rays: parameters, batches of rays in tiles, rays of no camera.
#include "pcl_slim/render/ray_tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/random.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/surface/polynomial.h"
#include "shading/shading.h"
#include "tiles/tiles.h"
#include "tracer/tracer.h"

namespace pcl_slim {

using namespace detail;
namespace {

Error bad(const char* message) {
  return {ErrorCode::kBadArgument, message};
}

Error checkLight(const RayLight& light) {
  const double size = length(light.towards);
  if (!(std::isfinite(size) && size > 0.0)) {
    return bad("a light's direction must be finite and not 0");
  }
  if (!(light.spread >= 0.0 && light.spread <= 45.0)) {
    return bad("a light's radius must be 0 to 45 degrees");
  }
  for (const float channel : light.color) {
    if (!(channel >= 0.0f && std::isfinite(channel))) {
      return bad("a light's colour must be finite and not negative");
    }
  }
  return {};
}

}  // namespace

Error TraceParams::validate() const {
  if (!(near_plane >= 0.0 && std::isfinite(near_plane))) {
    return bad("the near plane must be a finite distance, 0 or more");
  }
  if (Error error = detail::checkHalfSpaces(cuts)) return error;
  if (!(depth_tolerance >= 0.0 && depth_tolerance <= 100.0)) {
    return bad("the depth tolerance must be 0 to 100 radii");
  }
  if (occlusion_rays < 0 || occlusion_rays > 4096) {
    return bad("the number of occlusion rays must be 0 to 4096");
  }
  if (!(occlusion_reach > 0.0 && std::isfinite(occlusion_reach))) {
    return bad("the reach of occlusion rays must be a positive number of diagonals");
  }
  if (lights.size() > 32) return bad("there may be no more than 32 lights");
  for (const RayLight& light : lights) {
    if (Error error = checkLight(light)) return error;
  }
  return {};
}

double TraceStatistics::testedPerRay() const {
  const std::uint64_t rays = rays_primary + rays_shadow + rays_occlusion;
  return rays > 0 ? static_cast<double>(tested_first + tested_blend) / static_cast<double>(rays)
                  : 0.0;
}

TraceStatistics& TraceStatistics::operator+=(const TraceStatistics& other) {
  leaves += other.leaves;
  rays_primary += other.rays_primary;
  rays_shadow += other.rays_shadow;
  rays_occlusion += other.rays_occlusion;
  nodes += other.nodes;
  tested_first += other.tested_first;
  tested_blend += other.tested_blend;
  bracketed += other.bracketed;
  closed += other.closed;
  peeled += other.peeled;
  covered_pixels += other.covered_pixels;
  return *this;
}

namespace {

/** \brief Evenly spread points of the unit square, turned by pixel: the sequence of the generalised
 * golden ratio from a place that hashes the pixel. */
class SquareSamples {
 public:
  SquareSamples(std::uint64_t pixel, std::uint64_t stream) {
    const std::uint64_t z = mixBits((pixel * 64 + stream + 1) * SplitMix::kStep);
    x_ = static_cast<double>(z >> 40) * 0x1p-24;
    y_ = static_cast<double>(z & 0xffffffu) * 0x1p-24;
  }

  struct Place {
    double x, y;
  };
  Place at(std::uint64_t i) const {
    const double n = static_cast<double>(i);
    return {fraction(x_ + n * 0.75487766624669276), fraction(y_ + n * 0.56984029099805327)};
  }

 private:
  static double fraction(double v) { return v - std::floor(v); }

  double x_, y_;
};

constexpr double kFullTurn = 2 * M_PI;

/** \brief A direction of the half space above a unit normal, as often as its cosine is large. */
inline Vector3 cosineDirection(const Vector3& normal, const SquareSamples::Place& at) {
  const LocalFrame frame(normal);
  const double rho = std::sqrt(at.x), angle = kFullTurn * at.y;
  const Vector3 flat =
      along(scaled(frame.u, rho * std::cos(angle)), rho * std::sin(angle), frame.v);
  return along(flat, std::sqrt(1.0 - at.x), frame.w);
}

/** \brief A direction within an angle, given by its tangent, of a unit axis. */
inline Vector3 coneDirection(const Vector3& axis, double tangent, const SquareSamples::Place& at) {
  if (!(tangent > 0.0)) return axis;
  const LocalFrame frame(axis);
  const double rho = tangent * std::sqrt(at.x), angle = kFullTurn * at.y;
  const Vector3 flat =
      along(scaled(frame.u, rho * std::cos(angle)), rho * std::sin(angle), frame.v);
  return normalized(along(flat, 1.0, frame.w));
}

constexpr double kDegree = M_PI / 180.0;

constexpr int kTraceTile = 16;  ///< pixels a side: the rays of one batch

/** \brief What all tiles of a traced frame share. */
struct TraceFrame {
  const TracedObject& object;
  const TraceView& view;
  const Camera& camera;
  std::vector<Vector3> towards;  ///< unit, of each light
  std::vector<double> tangent;   ///< of each light's radius
  std::vector<HalfSpace> cuts;   ///< local
  double near_plane, reach;      ///< local

  TraceFrame(const TracedObject& object, const TraceView& view, const Camera& camera);
};

/** \brief The rays of one tile and what they met; reused from tile to tile. */
class TraceTile {
 public:
  /** \brief Traces every ray of the pixels [x0, x0 + 16) x [y0, y0 + 16) that the picture has. */
  void trace(const TraceFrame& frame, int x0, int y0, GBuffer& buffer, LightBuffer& light,
             TraceStatistics& statistics);

 private:
  void traceCamera(const TraceFrame& frame, int x0, int y0, GBuffer& buffer);
  void traceLight(const TraceFrame& frame, std::size_t l, const GBuffer& buffer,
                  LightBuffer& light);
  void traceOcclusion(const TraceFrame& frame, LightBuffer& light);
  static void cut(const TraceFrame& frame, BoundedRay& ray);
  BoundedRay leaving(const TraceFrame& frame, std::size_t i, const Vector3& direction) const;
  void block(const TraceFrame& frame, bool close_gaps);

  std::vector<BoundedRay> rays_, outgoing_;
  std::vector<MetPoint> met_;
  std::vector<std::size_t> pixels_, source_;  ///< source_: place in rays_ of each outgoing ray
  std::vector<std::uint8_t> blocked_;
  RayCounts counts_;
  std::uint64_t shadow_ = 0, occlusion_ = 0;
};

TraceFrame::TraceFrame(const TracedObject& o, const TraceView& v, const Camera& c)
    : object(o),
      view(v),
      camera(c),
      cuts(localHalfSpaces(v.params.cuts, o.origin, o.scale)),
      near_plane(v.params.near_plane / o.scale),
      reach(v.params.occlusion_reach * o.diagonal) {
  for (const RayLight& light : v.params.lights) {
    towards.push_back(normalized(light.towards));
    tangent.push_back(std::tan(light.spread * kDegree));
  }
}

void TraceTile::trace(const TraceFrame& frame, int x0, int y0, GBuffer& buffer, LightBuffer& light,
                      TraceStatistics& statistics) {
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

void TraceTile::traceCamera(const TraceFrame& frame, int x0, int y0, GBuffer& buffer) {
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
void TraceTile::cut(const TraceFrame& frame, BoundedRay& ray) {
  const RayStretch left = within(frame.cuts, ray.ray, {ray.nearest, ray.farthest});
  ray.nearest = left.near;
  ray.farthest = left.far;
}

BoundedRay TraceTile::leaving(const TraceFrame& frame, std::size_t i,
                              const Vector3& direction) const {
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

void TraceTile::block(const TraceFrame& frame, bool close_gaps) {
  blocked_.resize(outgoing_.size());
  frame.object.block(outgoing_.data(), outgoing_.size(), close_gaps, blocked_.data(), counts_);
}

void TraceTile::traceLight(const TraceFrame& frame, std::size_t l, const GBuffer& buffer,
                           LightBuffer& light) {
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

void TraceTile::traceOcclusion(const TraceFrame& frame, LightBuffer& light) {
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

constexpr std::size_t kBandTiles = 512;  ///< between looks at the progress

/** \brief A world ray in an object's local units. */
BoundedRay localRay(const TracedObject& object, const WorldRay& ray) {
  BoundedRay local;
  local.ray.origin = scaled(subtract(ray.origin, object.origin), 1.0 / object.scale);
  local.ray.direction = normalized(ray.direction);
  local.nearest = ray.nearest / object.scale;
  local.farthest = ray.farthest / object.scale;
  return local;
}

WorldHit worldHit(const MetPoint& point, const WorldRay& ray, double scale) {
  WorldHit hit;
  if (!point.met()) return hit;
  hit.depth = point.depth * scale;
  hit.position = along(ray.origin, hit.depth, normalized(ray.direction));
  for (std::size_t a = 0; a < 3; ++a) hit.normal[a] = static_cast<float>(point.normal[a]);
  hit.color = point.color;
  hit.surfel = point.id;
  return hit;
}

Error checkRays(const std::vector<WorldRay>& rays) {
  for (const WorldRay& ray : rays) {
    if (!isFinite(ray.origin) ||
        !(std::isfinite(length(ray.direction)) && length(ray.direction) > 0.0)) {
      return bad("a ray needs a finite origin and a finite direction that is not 0");
    }
    if (!(ray.nearest >= 0.0 && std::isfinite(ray.nearest)) || std::isnan(ray.farthest)) {
      return bad("a ray begins at a finite distance of 0 or more and ends at one that is a number");
    }
  }
  return {};
}

/** \brief Runs body(begin, end, counts) over [0, count) in equal parts. */
template <typename Body>
void forBatches(std::size_t count, int threads, const Body& body) {
  constexpr std::size_t kBatch = 256;
  parallelFor((count + kBatch - 1) / kBatch, resolveThreads(threads), 1, [&](std::size_t b, int) {
    RayCounts counts;
    body(b * kBatch, std::min(count, (b + 1) * kBatch), counts);
  });
}

}  // namespace

struct RayTracer::State {
  std::unique_ptr<TracedObject> object;
  Error defect;  ///< of the object
  bool colored = false;
  std::unique_ptr<SurfacePainter> painter;  ///< of a surface
};

RayTracer::RayTracer(const SLIMSurface& surface, int threads)
    : state_(new State{nullptr, surface.validate(), surface.hasColors(), nullptr}) {
  if (state_->defect) return;
  state_->object = tracedLeaves(surface, resolveThreads(threads));
  state_->painter = std::make_unique<SurfacePainter>(surface);
}

RayTracer::RayTracer(const SplatSet& splats, int threads)
    : state_(new State{nullptr, validateDiscs(splats), true, nullptr}) {
  if (!state_->defect) state_->object = tracedDiscs(splats, resolveThreads(threads));
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

Error RayTracer::defect() const {
  return state_ ? state_->defect : badInput("the tracer has been moved from; make a new one");
}

bool RayTracer::hasColors() const {
  return state_ && state_->colored;
}

double RayTracer::scale() const {
  return state_ && state_->object ? state_->object->scale : 1.0;
}

namespace {

/** \brief Traces all tiles of a frame. \return false if it was cancelled. */
bool traceTiles(const TraceFrame& frame, int threads, GBuffer& buffer, LightBuffer& light,
                TraceStatistics& total, Progress* progress) {
  const auto tiles = [](int pixels) {
    return static_cast<std::size_t>((pixels + kTraceTile - 1) / kTraceTile);
  };
  const std::size_t columns = tiles(buffer.width), count = columns * tiles(buffer.height);
  std::vector<TraceTile> memory(static_cast<std::size_t>(threads));
  std::vector<TraceStatistics> parts(memory.size());
  const auto cancelled = [&] { return progress && progress->cancelled(); };
  for (std::size_t first = 0; first < count && !cancelled(); first += kBandTiles) {
    if (progress) progress->report(static_cast<float>(first) / static_cast<float>(count), "trace");
    parallelFor(std::min(kBandTiles, count - first), threads, 1, [&](std::size_t i, int thread) {
      if (cancelled()) return;
      const std::size_t t = first + i, own = static_cast<std::size_t>(thread);
      memory[own].trace(frame, static_cast<int>(t % columns) * kTraceTile,
                        static_cast<int>(t / columns) * kTraceTile, buffer, light, parts[own]);
    });
  }
  for (const TraceStatistics& part : parts) total += part;
  if (cancelled()) return false;
  if (progress) progress->report(1.0f, "trace");
  return true;
}

/** \brief Makes both buffers of a frame's size and empty. */
void clearFrame(const TracedObject& object, const Camera& camera, const TraceParams& params,
                GBuffer& buffer, LightBuffer& light) {
  const bool painted = (params.columns & kColorColumn) != 0;
  const unsigned columns = object.discs ? unsigned{kAllColumns}
                           : painted    ? params.columns | kPositionColumn
                                        : params.columns;
  buffer.resize(camera.size.width, camera.size.height, columns);
  if (object.discs) buffer.color.assign(buffer.numPixels(), {});
  light.visible.assign(params.lights.size() * buffer.numPixels(), 0.0f);
  light.open.assign(buffer.numPixels(), 1.0f);
}

}  // namespace

Error RayTracer::trace(const Camera& camera, const TraceParams& params, GBuffer& buffer,
                       LightBuffer& light, TraceStatistics* statistics, Progress* progress) {
  const auto refused = [&](Error error) {
    buffer.resize(0, 0);
    buffer.color.clear();
    light = LightBuffer();
    return error;
  };
  if (Error error = camera.validate()) return refused(error);
  if (Error error = params.validate()) return refused(error);
  if (Error error = defect()) return refused(error);
  const TracedObject& object = *state_->object;
  clearFrame(object, camera, params, buffer, light);
  const CameraRays rays(camera, object.origin, object.scale);
  const TraceView view{params, &rays};
  const TraceFrame frame(object, view, camera);
  TraceStatistics total;
  total.leaves = object.size;
  const bool done =
      traceTiles(frame, resolveThreads(params.threads), buffer, light, total, progress);
  if (!done) return refused({ErrorCode::kCancelled, "tracing was cancelled"});
  if (state_->painter && (params.columns & kColorColumn) != 0)
    state_->painter->paint(camera, resolveThreads(params.threads), buffer);
  if (statistics) *statistics = total;
  return {};
}

Error RayTracer::cast(const std::vector<WorldRay>& rays, VisibleSides sides,
                      std::vector<WorldHit>& hits, int threads) const {
  hits.clear();
  if (Error error = defect()) return error;
  if (Error error = checkRays(rays)) return error;
  const TracedObject& object = *state_->object;
  TraceParams params;
  params.sides = sides;
  const TraceView view{params, nullptr};
  hits.resize(rays.size());
  forBatches(rays.size(), threads, [&](std::size_t begin, std::size_t end, RayCounts& counts) {
    std::vector<BoundedRay> local;
    std::vector<MetPoint> met(end - begin);
    for (std::size_t i = begin; i < end; ++i) local.push_back(localRay(object, rays[i]));
    object.trace(view, local.data(), local.size(), met.data(), nullptr, nullptr, counts);
    for (std::size_t i = begin; i < end; ++i) {
      hits[i] = worldHit(met[i - begin], rays[i], object.scale);
    }
  });
  return {};
}

Error RayTracer::castShadows(const std::vector<WorldRay>& rays, std::vector<std::uint8_t>& blocked,
                             int threads) const {
  blocked.clear();
  if (Error error = defect()) return error;
  if (Error error = checkRays(rays)) return error;
  const TracedObject& object = *state_->object;
  blocked.resize(rays.size());
  forBatches(rays.size(), threads, [&](std::size_t begin, std::size_t end, RayCounts& counts) {
    std::vector<BoundedRay> local;
    for (std::size_t i = begin; i < end; ++i) local.push_back(localRay(object, rays[i]));
    object.block(local.data(), local.size(), true, blocked.data() + begin, counts);
  });
  return {};
}

}  // namespace pcl_slim
