// SPDX-License-Identifier: BSD-3-Clause
#include "borders/drawn_area.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/surface_renderer.h"
#include "support/lab/bench.h"
#include "support/lab/reference/reference_renderer.h"

namespace pcl_slim::borders {
namespace {

constexpr double kOfEighth = 0.627;      ///< spacing over the distance to the 8th neighbour
constexpr double kLeastCosine = 0.05;    ///< pixels seen more obliquely show no more than at this
constexpr std::uint32_t kNeighbors = 9;  ///< with the point itself

std::vector<Camera> axisViews(const SLIMSurface& surface, int size) {
  std::vector<Camera> cameras;
  const BoundingSpheres object = spheresOf(surface);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      ViewDirection view{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
      view.towards_viewer[static_cast<std::size_t>(axis)] = side;
      view.up[static_cast<std::size_t>((axis + 1) % 3)] = 1.0;
      cameras.push_back(fitOrthographicCamera(object, view, {size, size}, 0.0));
    }
  }
  return cameras;
}

/** \brief One view's pixels: where they are, and how much area each shows. */
class ViewPixels {
 public:
  ViewPixels(const SLIMSurface& surface, const Camera& camera, const GBuffer& buffer)
      : info_(surface.info), buffer_(buffer) {
    const double pixel = camera.view_height / camera.size.height;
    area_ = pixel * pixel;
    to_eye_ = normalized(subtract(camera.position, camera.look_at));
  }

  Vector3 world(std::size_t i) const {
    const auto& p = buffer_.position[i];
    return along(info_.origin, info_.scale, {p[0], p[1], p[2]});
  }

  double width() const { return std::sqrt(area_); }

  double area(std::size_t i) const {
    const auto& n = buffer_.normal[i];
    return area_ / std::max(std::abs(dot(to_eye_, {n[0], n[1], n[2]})), kLeastCosine);
  }

 private:
  const SurfaceInfo& info_;
  const GBuffer& buffer_;
  double area_;
  Vector3 to_eye_;
};

/** \brief Adds one view's pixels. */
void addView(const ViewPixels& pixels, const FootSearch& search, const FootSearch& floats,
             const GBuffer& buffer, int threads, DrawnArea& area) {
  std::vector<DrawnArea> rows(static_cast<std::size_t>(buffer.height));
  std::vector<std::uint8_t> floating(rows.size() * static_cast<std::size_t>(buffer.width));
  std::vector<std::vector<std::uint32_t>> scratch(static_cast<std::size_t>(threads));
  parallelFor(rows.size(), threads, 8, [&](std::size_t y, int thread) {
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, static_cast<int>(y));
      if (!buffer.covered(i)) continue;
      const double shown = pixels.area(i);
      rows[y].total += shown;
      auto& blocks = scratch[static_cast<std::size_t>(thread)];
      const Vector3 place = pixels.world(i);
      if (search.isNear(place, blocks)) continue;
      rows[y].far += shown;
      floating[i] = !floats.isNear(place, blocks);
    }
  });
  for (const DrawnArea& row : rows) {
    area.total += row.total;
    area.far += row.far;
  }
  addPieces(floating, buffer.width, pixels.width(), area.floating);
}

/** \brief Spacings of feet that are stored. */
void measureSpacings(int threads, Feet& feet) {
  feet.spacing.resize(feet.store.size());
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads),
                                       NeighborSearch(feet.store));
  parallelFor(feet.store.size(), threads, 1024, [&](std::size_t i, int thread) {
    std::vector<std::uint32_t> neighbors;
    std::vector<float> distances_sq;
    searches[static_cast<std::size_t>(thread)].nearest(i, kNeighbors, neighbors, distances_sq);
    feet.spacing[i] = static_cast<float>(kOfEighth * std::sqrt(distances_sq.back()));
  });
}

}  // namespace

FootSearch::FootSearch(const Feet& feet, double spacings, double extra)
    : feet_(feet), spacings_(spacings), extra_(extra / feet.store.scale()) {
  constexpr double kUsual = 4.0;  ///< medians that a usual spacing does not exceed
  const double usual =
      measure::median(std::vector<double>(feet.spacing.begin(), feet.spacing.end()));
  usual_spacing_ = usual * feet.store.scale();
  reach_ = static_cast<float>(spacings_ * kUsual * usual + extra_);
  for (std::size_t i = 0; i < feet.spacing.size(); ++i) {
    const auto block = static_cast<std::uint32_t>(i / PointStore::kBlock);
    if (feet.spacing[i] <= kUsual * usual) continue;
    if (sparse_.empty() || sparse_.back() != block) sparse_.push_back(block);
  }
}

bool FootSearch::isNear(const Vector3& world, std::vector<std::uint32_t>& blocks) const {
  const Vector3 place = scaled(subtract(world, feet_.store.origin()), 1.0 / feet_.store.scale());
  const float at[3] = {static_cast<float>(place[0]), static_cast<float>(place[1]),
                       static_cast<float>(place[2])};
  // Most places have a foot close by: look farther only where there is none.
  for (const float reach : {0.25f * reach_, reach_}) {
    blocks.clear();
    feet_.store.tree().blocksInBall(at, reach, blocks);
    for (const std::uint32_t b : blocks) {
      if (nearBlock(place, b)) return true;
    }
  }
  return std::any_of(sparse_.begin(), sparse_.end(),
                     [&](std::uint32_t b) { return nearBlock(place, b); });
}

bool FootSearch::nearBlock(const std::array<double, 3>& place, std::uint32_t block) const {
  const std::size_t first = block * PointStore::kBlock;
  const std::size_t end = std::min(first + PointStore::kBlock, feet_.store.size());
  for (std::size_t i = first; i < end; ++i) {
    const auto p = feet_.store.position(i);
    const double x = p[0] - place[0], y = p[1] - place[1], z = p[2] - place[2];
    const double limit = spacings_ * feet_.spacing[i] + extra_;
    if (x * x + y * y + z * z <= limit * limit) return true;
  }
  return false;
}

Feet feetOf(const PointStore& points, const SLIMSurface& surface, int threads) {
  Projection projection;
  ProjectionParams params;
  params.threads = threads;
  if (projectPoints(points, surface, params, projection)) return {};
  std::vector<double> xyz;
  for (const auto& local : projection.position) {
    const Vector3 foot = along(points.origin(), points.scale(), local);
    xyz.insert(xyz.end(), foot.begin(), foot.end());
  }
  // A point without support has no normal and is left out for it: it is no foot.
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.normal = projection.normal.data();
  view.normal_stride = 3 * sizeof(float);
  view.size = points.size();
  Result<PointStore> store = PointStore::build(view, threads);
  Feet feet;
  if (!store) return feet;
  feet.store = std::move(*store);
  for (std::size_t i = 0; i < feet.store.size(); ++i) feet.normal.push_back(feet.store.normal(i));
  measureSpacings(threads, feet);
  return feet;
}

Feet pointsOf(const PointStore& points, int threads) {
  Feet feet;
  feet.store = points;
  measureSpacings(threads, feet);
  return feet;
}

DrawnArea drawnArea(const SLIMSurface& surface, const FootSearch& feet, const FootSearch& floats,
                    const RenderParams& params, const AreaViews& views) {
  DrawnArea area;
  RenderParams own = params;
  own.columns = kPositionColumn;
  SurfaceRenderer renderer(surface, params.threads);
  lab::ReferenceRenderer exact(surface);
  GBuffer buffer;
  for (const Camera& camera : axisViews(surface, views.size)) {
    const double start = measure::wallSeconds();
    if (views.reference ? exact.render(camera, own, buffer) : renderer.render(camera, own, buffer))
      return {};
    area.seconds += measure::wallSeconds() - start;
    addView({surface, camera, buffer}, feet, floats, buffer, resolveThreads(params.threads), area);
  }
  return area;
}

void addPieces(std::vector<std::uint8_t>& marks, int width, double pixel, Floating& floating) {
  constexpr std::size_t kSmallest = 4;
  const int height = static_cast<int>(marks.size()) / width;
  std::vector<int> open;
  for (std::size_t first = 0; first < marks.size(); ++first) {
    if (marks[first] == 0) continue;
    marks[first] = 0;
    open.assign(1, static_cast<int>(first));
    int low[2] = {width, height}, high[2] = {0, 0};
    std::size_t count = 0;
    while (!open.empty()) {
      const int at[2] = {open.back() % width, open.back() / width};
      open.pop_back();
      ++count;
      for (int a = 0; a < 2; ++a) {
        low[a] = std::min(low[a], at[a]);
        high[a] = std::max(high[a], at[a]);
      }
      for (int y = std::max(0, at[1] - 1); y <= std::min(height - 1, at[1] + 1); ++y) {
        for (int x = std::max(0, at[0] - 1); x <= std::min(width - 1, at[0] + 1); ++x) {
          auto& mark = marks[static_cast<std::size_t>(y * width + x)];
          if (mark != 0) open.push_back(y * width + x);
          mark = 0;
        }
      }
    }
    floating.pixels += count;
    if (count < kSmallest) continue;
    ++floating.pieces;
    const int side = std::max(high[0] - low[0], high[1] - low[1]) + 1;
    floating.widest = std::max(floating.widest, pixel * side);
  }
}

}  // namespace pcl_slim::borders
