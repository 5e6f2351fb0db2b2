// SPDX-License-Identifier: BSD-3-Clause
#include "embree_tree.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <string>

#include "pcl_slim/core/parallel.h"
#include "tiles/tiles.h"

namespace pcl_slim::bench {
namespace {

using namespace detail;

/** What callbacks know of a ray besides Embree's single precision. */
struct Context {
  RTCIntersectContext base;  // first: Embree hands out a pointer to it
  const BoundedRay* ray = nullptr;
  bool front_only = false;
  double best = HUGE_VAL;
};

/** The leaves as callbacks see them. */
struct Leaves {
  std::vector<std::uint32_t> ids;
  std::vector<RaySurfel> surfels;
  std::vector<Box> boxes;
  double shrink = 0.0;

  /** First root of a leaf on a ray before a depth. */
  double root(std::size_t i, const Context& context) const {
    const RaySurfel& surfel = surfels[i];
    const Ray& ray = context.ray->ray;
    const Approach approach(surfel, ray);
    const double half_sq = shrink * shrink - approach.distance_sq;
    if (!(half_sq > 0.0)) return HUGE_VAL;
    const double half = std::sqrt(half_sq), scale = surfel.inverse_radius;
    const double low = std::max(-half, (context.ray->nearest - approach.depth) * scale);
    const double high = std::min(half, (context.best - approach.depth) * scale);
    if (!(low <= high)) return HUGE_VAL;
    const RayPolynomial polynomial(surfel, approach, ray.direction);
    const Roots roots = rootsInInterval(surfel.degree, polynomial.a, low, high);
    for (int k = 0; k < roots.count; ++k) {
      const double depth = approach.depth + roots.at[k] * surfel.radius;
      const bool falls = polynomial.slope(roots.at[k]) < 0.0;
      if (falls || (!context.front_only && depth >= context.ray->nearest_behind)) return depth;
    }
    return HUGE_VAL;
  }
};

void bounds(const RTCBoundsFunctionArguments* args) {
  const Box& box = static_cast<const Leaves*>(args->geometryUserPtr)->boxes[args->primID];
  constexpr float kRoom = 2e-6f;  // as RayScene's boxes: rays start in single precision
  RTCBounds& out = *args->bounds_o;
  out.lower_x = box.low[0] - kRoom;
  out.lower_y = box.low[1] - kRoom;
  out.lower_z = box.low[2] - kRoom;
  out.upper_x = box.high[0] + kRoom;
  out.upper_y = box.high[1] + kRoom;
  out.upper_z = box.high[2] + kRoom;
}

void intersect(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  Context& context = *reinterpret_cast<Context*>(args->context);
  const double depth =
      static_cast<const Leaves*>(args->geometryUserPtr)->root(args->primID, context);
  if (!(depth < context.best)) return;
  context.best = depth;
  RTCRayHit& hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  hit.ray.tfar = static_cast<float>(depth * (1.0 + 2e-7));
  hit.hit.geomID = args->geomID;
  hit.hit.primID = args->primID;
}

void occluded(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const Context& context = *reinterpret_cast<const Context*>(args->context);
  const double depth =
      static_cast<const Leaves*>(args->geometryUserPtr)->root(args->primID, context);
  if (depth < HUGE_VAL) {
    reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
  }
}

class EmbreeLeaves : public EmbreeTree {
 public:
  EmbreeLeaves(const SLIMSurface& surface, int threads) {
    leaves_.ids = surface.leaves();
    leaves_.shrink = std::clamp(surface.info.cover_radius, 0.05, kMaxShrink);
    for (const std::uint32_t i : leaves_.ids) {
      leaves_.surfels.emplace_back(surface, i);
      leaves_.boxes.push_back(boxOfLeaf(surface, i, leaves_.shrink, 0.0));
    }
    device_ = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(leaves_.ids.size()));
    rtcSetGeometryUserData(geometry, &leaves_);
    rtcSetGeometryBoundsFunction(
        geometry, [](const RTCBoundsFunctionArguments* args) { bounds(args); }, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occluded);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~EmbreeLeaves() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void first(const std::vector<BoundedRay>& rays, bool front_only, int threads,
             std::vector<double>& depth) const override {
    parallelFor(rays.size(), threads, 256, [&](std::size_t i, int) {
      Context context = contextOf(rays[i], front_only);
      RTCRayHit hit{};
      hit.ray = start(rays[i]);
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_, &context.base, &hit);
      depth[i] = context.best;
    });
  }

  void any(const std::vector<BoundedRay>& rays, int threads,
           std::vector<std::uint8_t>& met) const override {
    parallelFor(rays.size(), threads, 256, [&](std::size_t i, int) {
      Context context = contextOf(rays[i], false);
      RTCRay ray = start(rays[i]);
      rtcOccluded1(scene_, &context.base, &ray);
      met[i] = ray.tfar < 0.0f ? 1 : 0;
    });
  }

 private:
  static Context contextOf(const BoundedRay& ray, bool front_only) {
    Context context;
    rtcInitIntersectContext(&context.base);
    context.ray = &ray;
    context.front_only = front_only;
    return context;
  }

  static RTCRay start(const BoundedRay& ray) {
    RTCRay out{};
    out.org_x = static_cast<float>(ray.ray.origin[0]);
    out.org_y = static_cast<float>(ray.ray.origin[1]);
    out.org_z = static_cast<float>(ray.ray.origin[2]);
    out.dir_x = static_cast<float>(ray.ray.direction[0]);
    out.dir_y = static_cast<float>(ray.ray.direction[1]);
    out.dir_z = static_cast<float>(ray.ray.direction[2]);
    out.tfar = std::numeric_limits<float>::infinity();
    out.mask = ~0u;
    return out;
  }

  Leaves leaves_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace

std::unique_ptr<EmbreeTree> embreeTree(const SLIMSurface& surface, int threads) {
  return std::make_unique<EmbreeLeaves>(surface, threads);
}

}  // namespace pcl_slim::bench
