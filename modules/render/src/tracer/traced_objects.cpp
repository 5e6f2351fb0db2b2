// SPDX-License-Identifier: BSD-3-Clause
// What rays meet: leaves of a surface, discs; and gaps of rasterised frames closed by such rays.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "discs/disc_blend.h"
#include "pcl_slim/core/parallel.h"
#include "tiles/tiles.h"
#include "tracer/tracer.h"

namespace pcl_slim::detail {
namespace {

bool frontOnly(VisibleSides sides, bool oriented) {
  return sides == VisibleSides::kFront || (sides == VisibleSides::kAuto && oriented);
}

class TracedLeaves : public TracedObject {
 public:
  TracedLeaves(const SLIMSurface& surface, int threads) : scene_(surface, threads) {
    origin = surface.info.origin;
    scale = surface.info.scale;
    diagonal = surface.info.diagonal;
    size = surface.numLeaves();
    rules_.min_coverage = surface.info.cover_threshold;
  }

  void trace(const TraceView& view, const BoundedRay* rays, std::size_t count, MetPoint* met,
             GBuffer* buffer, const std::size_t* pixels, RayCounts& counts) const override {
    RayRules rules = rules_;
    const bool closed = scene_.surface.info.hasFront() && view.params.cuts.empty();
    rules.front_only = frontOnly(view.params.sides, closed);
    rules.close_gaps = view.params.close_gaps;
    rules.enclosed = view.enclosed;
    rules.with_hessian = buffer && (view.params.columns & (kHessianColumn | kCurvatureColumn)) != 0;
    std::vector<BlendedHit> hits(count);
    kernels::traceHits(scene_, rules, rays, count, hits.data(), counts);
    for (std::size_t i = 0; i < count; ++i) {
      met[i] = pointOf(hits[i]);
      if (!buffer || !met[i].met()) continue;
      writeBlend(scene_.surface, rays[i].ray, hits[i].depth_hat, hits[i].sum, pixels[i], *buffer);
      if (!buffer->residual.empty()) {
        buffer->residual[pixels[i]] = scene_.surface.error[met[i].id];
      }
    }
  }

  void block(const BoundedRay* rays, std::size_t count, bool close_gaps, std::uint8_t* blocked,
             RayCounts& counts) const override {
    RayRules rules = rules_;
    rules.close_gaps = close_gaps;
    kernels::traceBlocked(scene_, rules, rays, count, blocked, counts);
  }

  Departure departure(const MetPoint& point) const override {
    const double r = scene_.surface.radius[point.id], error = scene_.surface.error[point.id];
    // Leaves that blend at a point are apart by about their residuals, and by a small share of
    // their radii where the data are clean.
    const double lift = std::min(0.1 * r, 2.0 * error + 0.005 * r);
    if (!scene_.surface.info.hasFront()) return {lift, 0.0, 0.0, r};
    return point.back ? Departure{lift, r, 0.0, r} : Departure{lift, 0.0, r, r};
  }

 private:
  static MetPoint pointOf(const BlendedHit& hit) {
    MetPoint point;
    if (!hit.met()) return point;
    point.id = hit.sum.surfel;
    point.back = hit.sum.facing < 0;
    point.depth = hit.depth_hat + hit.sum.shift / hit.sum.weight;
    point.normal = normalized({hit.sum.gradient[0], hit.sum.gradient[1], hit.sum.gradient[2]});
    return point;
  }

  RayScene scene_;
  RayRules rules_;
};

}  // namespace

std::unique_ptr<TracedObject> tracedLeaves(const SLIMSurface& surface, int threads) {
  return std::make_unique<TracedLeaves>(surface, threads);
}

namespace {

/** Pixels beyond its rim within which a disc may be met: half a diagonal aside, and along a ray
 * that grazes its plane by what Disc::span and Disc::width add to the radius. */
constexpr double kReach = 2.5;

Box boxOfDisc(const SplatSet& splats, std::size_t i) {
  const double center[3] = {splats.x[i], splats.y[i], splats.z[i]};
  const Vector3 normal = normalized({splats.nx[i], splats.ny[i], splats.nz[i]});
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double half = splats.radius[i] * std::sqrt(std::max(0.0, 1.0 - normal[a] * normal[a]));
    box.low[a] = static_cast<float>(center[a] - half);
    box.high[a] = static_cast<float>(center[a] + half);
  }
  return box;
}

/** \brief Runs body(disc index, farthest) for the discs that a ray may meet; false stops. */
template <typename Body>
void forDiscs(const WideTree& tree, const BoundedRay& ray, const RayWidth& width, RayCounts& counts,
              Body& body) {
  struct Context {
    const WideTree& tree;
    Body& body;
  } context{tree, body};
  const BlockVisitor visitor{
      [](void* memory, std::uint32_t block, double& farthest) {
        const Context& own = *static_cast<Context*>(memory);
        const std::uint32_t* disc = own.tree.order.data() + std::size_t{block} * kWide;
        for (std::uint32_t k = 0; k < kWide && disc[k] != WideTree::kNothing; ++k) {
          if (!own.body(disc[k], farthest)) return false;
        }
        return true;
      },
      &context};
  kernels::visitBlocks(tree, ray, width, visitor, counts.nodes);
}

class TracedDiscs : public TracedObject {
 public:
  TracedDiscs(const SplatSet& splats, int threads) : splats_(splats) {
    const std::size_t n = splats.size();
    std::vector<Box> boxes(n);
    parallelFor(n, threads, 1024, [&](std::size_t i, int) { boxes[i] = boxOfDisc(splats, i); });
    tree_ = buildWideTree(boxes, boxes, threads);
    origin = splats.origin;
    size = n;
    discs = true;
    for (const float radius : splats.radius) widest_ = std::max(widest_, double{radius});
    double diagonal_sq = 0.0;
    for (int a = 0; a < 3 && n > 0; ++a) {
      const double side = double{tree_.bounds.high[a]} - tree_.bounds.low[a];
      diagonal_sq += side * side;
    }
    if (diagonal_sq > 0.0) diagonal = std::sqrt(diagonal_sq);
  }

  void trace(const TraceView& view, const BoundedRay* rays, std::size_t count, MetPoint* met,
             GBuffer* buffer, const std::size_t* pixels, RayCounts& counts) const override {
    const CameraRays none(Camera(), origin, 1.0);
    DiscRenderParams params;
    params.filtered = view.camera && view.params.filtered;
    params.depth_tolerance = view.params.depth_tolerance;
    const Look look{{splats_, view.camera ? *view.camera : none, params,
                     view.params.sides == VisibleSides::kFront},
                    view.camera != nullptr,
                    view.params.filtered};
    for (std::size_t i = 0; i < count; ++i) {
      params.near_plane = rays[i].nearest;
      const FirstDisc first = findFirst(look, rays[i], counts);
      if (first.disc == GBuffer::kNothing) continue;
      const DiscSum sum = blend(look, rays[i], first, counts);
      met[i] = pointOf(first, sum);
      if (buffer) writeDiscs(look.view, rays[i].ray, first, sum, pixels[i], *buffer);
    }
  }

  void block(const BoundedRay* rays, std::size_t count, bool /*close_gaps*/, std::uint8_t* blocked,
             RayCounts& counts) const override {
    const CameraRays none(Camera(), origin, 1.0);
    DiscRenderParams params;
    params.filtered = false;
    const DiscView view{splats_, none, params, false};
    for (std::size_t i = 0; i < count; ++i) {
      params.near_plane = std::max(rays[i].nearest, rays[i].nearest_front);
      blocked[i] = 0;
      auto look = [&](std::uint32_t d, double&) {
        DiscHit hit;
        ++counts.leaves_first;
        const bool meets = intersect(view, rays[i].ray, Disc(view, d), hit);
        blocked[i] = meets && hit.depth <= rays[i].farthest ? 1 : 0;
        return blocked[i] == 0;
      };
      forDiscs(tree_, rays[i], RayWidth(), counts, look);
    }
  }

  Departure departure(const MetPoint& point) const override {
    // Discs within half a radius of each other are blended as one surface.
    const double r = splats_.radius[point.id];
    return {0.5 * r, r, r, r};
  }

 private:
  /** \brief How primary rays see discs. */
  struct Look {
    DiscView view;
    bool by_camera;
    bool blended;

    /** \brief Whether a disc is drawn at all; the rasteriser too leaves out those turned away as a
     * whole. */
    bool draws(const Disc& disc, const BoundedRay& ray) const {
      if (!view.front_only) return true;
      const Vector3 to_disc = by_camera ? view.rays.directionTo(disc.center) : ray.ray.direction;
      return dot(disc.normal, to_disc) < 0.0;
    }
    /** \brief The screen filter's reach. */
    RayWidth width() const {
      if (!view.params.filtered) return {};
      return {static_cast<float>(kReach * view.rays.pixelAtEye()),
              static_cast<float>(kReach * view.rays.pixelPerDepth())};
    }
  };

  FirstDisc findFirst(const Look& look, const BoundedRay& ray, RayCounts& counts) const {
    FirstDisc first;
    first.depth = ray.farthest;
    auto meet = [&](std::uint32_t d, double& farthest) {
      ++counts.leaves_first;
      const Disc disc(look.view, d);
      DiscHit hit;
      if (!look.draws(disc, ray) || !intersect(look.view, ray.ray, disc, hit)) return true;
      if (hit.depth < first.depth) first = {hit.depth, hit.cosine, disc.radius, d};
      farthest = first.depth;
      return true;
    };
    forDiscs(tree_, ray, look.width(), counts, meet);
    return first;
  }

  /** \brief Depth behind which no disc counts in addition to the first. */
  double lastDepth(const Look& look, const FirstDisc& first) const {
    const double tolerance = look.view.params.depth_tolerance;
    const double growth = tolerance * look.view.rays.pixelPerDepth();
    const double pixel =
        look.view.rays.pixelAtEye() + look.view.rays.pixelPerDepth() * std::max(0.0, first.depth);
    if (!(first.cosine > 2.0 * growth)) return HUGE_VAL;
    return first.depth + 2.0 * tolerance * (0.5 * (first.radius + widest_) + pixel) / first.cosine;
  }

  DiscSum blend(const Look& look, const BoundedRay& ray, const FirstDisc& first,
                RayCounts& counts) const {
    DiscSum sum;
    BoundedRay stretch = ray;
    stretch.farthest = lastDepth(look, first);
    auto meet = [&](std::uint32_t d, double&) {
      if (!look.blended && d != first.disc) return true;
      ++counts.leaves_blend;
      const Disc disc(look.view, d);
      DiscHit hit;
      if (!look.draws(disc, ray) || !intersect(look.view, ray.ray, disc, hit)) return true;
      if (countsBehind(look.view, first, disc, hit.depth, hit.cosine)) {
        addDisc(look.view, hit, disc, d, sum);
      }
      return true;
    };
    forDiscs(tree_, stretch, look.width(), counts, meet);
    return sum;
  }

  static MetPoint pointOf(const FirstDisc& first, const DiscSum& sum) {
    MetPoint point;
    point.id = first.disc;
    point.depth = sum.depth / sum.weight;
    point.normal = normalized({sum.normal[0], sum.normal[1], sum.normal[2]});
    for (std::size_t k = 0; k < 3; ++k) {
      point.color[k] = static_cast<float>(sum.color[k] / (255.0 * sum.weight));
    }
    return point;
  }

  const SplatSet& splats_;
  WideTree tree_;
  double widest_ = 0.0;
};

}  // namespace

std::unique_ptr<TracedObject> tracedDiscs(const SplatSet& splats, int threads) {
  return std::make_unique<TracedDiscs>(splats, threads);
}

namespace {

constexpr int kGapReach = 8;      ///< pixels from a gap's rim inwards that one pass closes
constexpr int kLeastCovered = 6;  ///< of the eight directions from a pixel in a gap

/** Whether most directions from a pixel soon lead to one that met something. */
bool isEnclosed(const GBuffer& buffer, int x, int y) {
  int covered = 0, looked = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      bool met = false;
      for (int k = 1; k <= kGapReach && !met; ++k) {
        const int px = x + k * dx, py = y + k * dy;
        if (px < 0 || py < 0 || px >= buffer.width || py >= buffer.height) break;
        met = buffer.covered(buffer.index(px, py));
      }
      covered += met ? 1 : 0;
      if (++looked - covered > 8 - kLeastCovered) return false;
    }
  }
  return true;
}

using Rows = std::vector<std::vector<int>>;  ///< columns of pixels, row by row

/** Pixels not tried yet that met nothing within what did; they count as tried from now on. */
Rows enclosedPixels(const GBuffer& buffer, int threads, std::vector<std::uint8_t>& tried) {
  Rows rows(static_cast<std::size_t>(buffer.height));
  parallelFor(rows.size(), threads, 16, [&](std::size_t y, int) {
    for (int x = 0; x < buffer.width; ++x) {
      const int row = static_cast<int>(y);
      const std::size_t pixel = buffer.index(x, row);
      if (tried[pixel] || buffer.covered(pixel) || !isEnclosed(buffer, x, row)) continue;
      tried[pixel] = 1;
      rows[y].push_back(x);
    }
  });
  return rows;
}

}  // namespace

bool closesGaps(const RenderParams& params) {
  return params.close_gaps && params.lod == 0.0 && params.cuts.empty() && params.shrink == 0.0 &&
         params.min_coverage < 0.0 && params.trim;
}

std::uint64_t GapCloser::close(const Camera& camera, const RenderParams& params, int threads,
                               GBuffer& buffer) {
  const CameraRays rays(camera, surface_.info.origin, surface_.info.scale);
  TraceParams tracing;
  tracing.sides = params.sides;
  tracing.columns = params.columns;
  const TraceView view{tracing, &rays, true};
  std::vector<std::uint8_t> tried(buffer.numPixels(), 0);
  std::uint64_t all = 0;
  for (;;) {  // from the rims of wide gaps inwards
    const Rows rows = enclosedPixels(buffer, threads, tried);
    if (std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.empty(); })) break;
    if (!leaves_) leaves_ = tracedLeaves(surface_, threads);
    std::atomic<std::uint64_t> filled{0};
    parallelFor(rows.size(), threads, 4, [&](std::size_t y, int) {
      std::vector<BoundedRay> bounded;
      std::vector<std::size_t> pixels;
      for (const int x : rows[y]) {
        bounded.emplace_back();
        bounded.back().ray = rays.ray(x, static_cast<int>(y));
        bounded.back().nearest = params.near_plane / surface_.info.scale;
        pixels.push_back(buffer.index(x, static_cast<int>(y)));
      }
      std::vector<MetPoint> met(bounded.size());
      RayCounts counts;
      leaves_->trace(view, bounded.data(), bounded.size(), met.data(), &buffer, pixels.data(),
                     counts);
      filled += static_cast<std::uint64_t>(
          std::count_if(met.begin(), met.end(), [](const MetPoint& p) { return p.met(); }));
    });
    if (filled == 0) break;
    all += filled;
  }
  return all;
}

}  // namespace pcl_slim::detail
