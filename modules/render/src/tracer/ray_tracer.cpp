// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/ray_tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "shading/paint_surface.h"
#include "tracer/trace_tile.h"
#include "tracer/traced_object.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr std::size_t kBandTiles = 512;  ///< between looks at the progress

Error
bad(const char* message)
{
  return {ErrorCode::kBadArgument, message};
}

/** \brief A world ray in an object's local units. */
BoundedRay
localRay(const TracedObject& object, const WorldRay& ray)
{
  BoundedRay local;
  local.ray.origin = scaled(subtract(ray.origin, object.origin), 1.0 / object.scale);
  local.ray.direction = normalized(ray.direction);
  local.nearest = ray.nearest / object.scale;
  local.farthest = ray.farthest / object.scale;
  return local;
}

WorldHit
worldHit(const MetPoint& point, const WorldRay& ray, double scale)
{
  WorldHit hit;
  if (!point.met()) return hit;
  hit.depth = point.depth * scale;
  hit.position = along(ray.origin, hit.depth, normalized(ray.direction));
  for (std::size_t a = 0; a < 3; ++a) hit.normal[a] = static_cast<float>(point.normal[a]);
  hit.color = point.color;
  hit.surfel = point.id;
  return hit;
}

Error
checkRays(const std::vector<WorldRay>& rays)
{
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
void
forBatches(std::size_t count, int threads, const Body& body)
{
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
    : state_(new State{nullptr, surface.validate(), surface.hasColors(), nullptr})
{
  if (state_->defect) return;
  state_->object = tracedLeaves(surface, resolveThreads(threads));
  state_->painter = std::make_unique<SurfacePainter>(surface);
}

RayTracer::RayTracer(const SplatSet& splats, int threads)
    : state_(new State{nullptr, validateDiscs(splats), true, nullptr})
{
  if (!state_->defect) state_->object = tracedDiscs(splats, resolveThreads(threads));
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer&
RayTracer::operator=(RayTracer&&) noexcept = default;

Error
RayTracer::defect() const
{
  return state_ ? state_->defect : badInput("the tracer has been moved from; make a new one");
}

bool
RayTracer::hasColors() const
{
  return state_ && state_->colored;
}

double
RayTracer::scale() const
{
  return state_ && state_->object ? state_->object->scale : 1.0;
}

namespace {

/** \brief Traces all tiles of a frame. \return false if it was cancelled. */
bool
traceTiles(const TraceFrame& frame, int threads, GBuffer& buffer, LightBuffer& light,
           TraceStatistics& total, Progress* progress)
{
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
void
clearFrame(const TracedObject& object, const Camera& camera, const TraceParams& params,
           GBuffer& buffer, LightBuffer& light)
{
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

Error
RayTracer::trace(const Camera& camera, const TraceParams& params, GBuffer& buffer,
                 LightBuffer& light, TraceStatistics* statistics, Progress* progress)
{
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
    state_->painter->paint(resolveThreads(params.threads), buffer);
  if (statistics) *statistics = total;
  return {};
}

Error
RayTracer::cast(const std::vector<WorldRay>& rays, VisibleSides sides, std::vector<WorldHit>& hits,
                int threads) const
{
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

Error
RayTracer::castShadows(const std::vector<WorldRay>& rays, std::vector<std::uint8_t>& blocked,
                       int threads) const
{
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
