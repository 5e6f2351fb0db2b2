// SPDX-License-Identifier: BSD-3-Clause
#include "splats/picture_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim::measure {
namespace {

constexpr double kSpacings = 1.3, kWidest = 4.0, kOneSided = 0.5;
constexpr double kDegree = M_PI / 180.0;
constexpr std::size_t kNeighbors = 6;
constexpr int kRim = 3;         ///< pixels between an inner pixel and what ends a surface
constexpr double kStep = 0.02;  ///< of the extent

using Vector = std::array<double, 3>;

/** Mean distance of each stored point to its nearest ones, local units. */
std::vector<float> spacingsOf(const PointStore& store) {
  std::vector<float> spacing(store.size());
  const std::size_t chunks = (store.size() + 1023) / 1024;
  parallelFor(chunks, resolveThreads(0), 1, [&](std::size_t chunk, int) {
    NeighborSearch search(store);
    std::vector<std::uint32_t> neighbors;
    std::vector<float> distances_sq;
    const std::size_t end = std::min(store.size(), 1024 * (chunk + 1));
    for (std::size_t i = 1024 * chunk; i < end; ++i) {
      search.nearest(i, kNeighbors + 1, neighbors, distances_sq);
      float sum = 0.0f;
      for (const float sq : distances_sq) sum += std::sqrt(sq);
      spacing[i] = sum / static_cast<float>(std::max<std::size_t>(1, distances_sq.size() - 1));
    }
  });
  return spacing;
}

bool isOneSided(const BoundingSpheres& object) {
  Vector mean{};
  for (const BoundingSphere& sphere : object.spheres) {
    for (std::size_t a = 0; a < 3; ++a) mean[a] += sphere.normal[a];
  }
  const auto count = static_cast<double>(object.spheres.size());
  return std::hypot(mean[0], mean[1], mean[2]) > kOneSided * count;
}

Vector rotated(const Vector& v, const Vector& axis, double degrees) {
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  const double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
  Vector r;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, d = (a + 2) % 3;
    r[a] = c * v[a] + s * (axis[b] * v[d] - axis[d] * v[b]) + (1.0 - c) * along * axis[a];
  }
  return r;
}

std::vector<ViewDirection> fixedViews(const BoundingSpheres& object) {
  std::vector<ViewDirection> views;
  if (!isOneSided(object)) {
    const UpAxis up = guessUpAxis(object);
    for (const double azimuth : {0.0, 90.0, 180.0, 270.0}) {
      views.push_back(viewFromAngles(up, azimuth, 15.0));
    }
    for (const double azimuth : {45.0, 225.0}) views.push_back(viewFromAngles(up, azimuth, 50.0));
    return views;
  }
  const ViewDirection base = chooseView(object).direction;
  const Vector &up = base.up, &to = base.towards_viewer;
  Vector right;
  for (std::size_t a = 0; a < 3; ++a) {
    right[a] = up[(a + 1) % 3] * to[(a + 2) % 3] - up[(a + 2) % 3] * to[(a + 1) % 3];
  }
  const double length = std::hypot(right[0], right[1], right[2]);
  for (double& value : right) value /= length;
  views.push_back(base);
  for (const double angle : {-30.0, 30.0}) views.push_back({rotated(to, up, angle), up});
  for (const double angle : {-30.0, 30.0}) views.push_back({rotated(to, right, angle), up});
  return views;
}

double distanceOf(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

SplatSet everyPoint(const ColoredScan& scan) {
  const CloudView view = scan.view();
  const Result<PointStore> store = PointStore::build(scan.file.view(false));
  if (!store) {
    std::fprintf(stderr, "%s\n", store.error().message.c_str());
    std::exit(1);
  }
  std::vector<float> spacing = spacingsOf(*store), sorted = spacing;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double widest = kWidest * *middle;
  SplatSet splats;
  splats.origin = store->origin();
  splats.resize(store->size(), false);
  for (std::size_t i = 0; i < store->size(); ++i) {
    const std::size_t input = view.inputIndex(store->orderOfStore()[i]);
    const auto p = store->position(i);
    const auto* normal = reinterpret_cast<const float*>(
        static_cast<const unsigned char*>(view.normal) + input * view.normal_stride);
    const auto* bgr =
        static_cast<const unsigned char*>(scan.colors.bgr) + input * scan.colors.stride;
    splats.x[i] = static_cast<float>(p[0] * store->scale());
    splats.y[i] = static_cast<float>(p[1] * store->scale());
    splats.z[i] = static_cast<float>(p[2] * store->scale());
    splats.nx[i] = normal[0];
    splats.ny[i] = normal[1];
    splats.nz[i] = normal[2];
    splats.radius[i] =
        static_cast<float>(kSpacings * std::min<double>(spacing[i], widest) * store->scale());
    splats.rgb[i] = static_cast<std::uint32_t>(bgr[2] << 16 | bgr[1] << 8 | bgr[0]);
    splats.kept[i] = static_cast<std::uint32_t>(input);
  }
  return splats;
}

PictureComparison::PictureComparison(const SplatSet& every_point, int size,
                                     const std::optional<Ball>& focus)
    : focus_(focus) {
  const BoundingSpheres object = spheresOf(every_point);
  step_ = kStep * object.scale;
  for (const ViewDirection& view : fixedViews(object)) {
    cameras_.push_back(fitCamera(object, view, {size, size}));
    reference_.push_back(draw(every_point, cameras_.back(), {}));
    inner_.push_back(innerPixels(reference_.back(), cameras_.back().size));
  }
}

std::vector<bool> PictureComparison::innerPixels(const Picture& picture,
                                                 const ImageSize& size) const {
  std::vector<bool> inner(picture.depth.size(), false);
  for (int y = kRim; y + kRim < size.height; ++y) {
    for (int x = kRim; x + kRim < size.width; ++x) {
      float low = std::numeric_limits<float>::infinity(), high = 0.0f;
      for (int v = y - kRim; v <= y + kRim; ++v) {
        const auto row = picture.depth.begin() + std::ptrdiff_t{v} * size.width;
        const auto [least, most] = std::minmax_element(row + x - kRim, row + x + kRim + 1);
        low = std::min(low, *least);
        high = std::max(high, *most);
      }
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                      static_cast<std::size_t>(x);
      inner[at] = high - low < step_;
    }
  }
  return inner;
}

PictureComparison::Picture PictureComparison::draw(const SplatSet& splats, const Camera& camera,
                                                   const DiscRenderParams& params) const {
  GBuffer buffer;
  if (const Error error = renderDiscs(splats, camera, params, buffer)) {
    std::fprintf(stderr, "%s\n", error.message.c_str());
    std::exit(1);
  }
  Picture picture;
  picture.depth = buffer.depth;
  picture.lab.assign(buffer.numPixels(), {-1.0f, 0.0f, 0.0f});
  picture.in_focus.assign(buffer.numPixels(), false);
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    const auto& rgb = buffer.color[i];
    const auto lab = labFromRgb({rgb[0], rgb[1], rgb[2]});
    for (std::size_t k = 0; k < 3; ++k) picture.lab[i][k] = static_cast<float>(lab[k]);
    if (!focus_) continue;
    double sq = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = splats.origin[a] + buffer.position[i][a] - focus_->center[a];
      sq += d * d;
    }
    picture.in_focus[i] = sq < focus_->radius * focus_->radius;
  }
  return picture;
}

PictureDifference PictureComparison::compare(const SplatSet& splats,
                                             const DiscRenderParams& params) const {
  std::vector<float> distances;
  double covered = 0, lost = 0, extra = 0, inner = 0, holes = 0, sum = 0, focus_sum = 0,
         focus_count = 0;
  for (std::size_t v = 0; v < cameras_.size(); ++v) {
    const Picture& truth = reference_[v];
    const Picture drawn = draw(splats, cameras_[v], params);
    for (std::size_t i = 0; i < truth.lab.size(); ++i) {
      const bool here = truth.lab[i][0] >= 0.0f, there = drawn.lab[i][0] >= 0.0f;
      covered += here;
      lost += here && !there;
      extra += there && !here;
      inner += inner_[v][i];
      holes += inner_[v][i] && drawn.depth[i] > truth.depth[i] + step_;
      if (!here || !there) continue;
      const double distance = distanceOf(truth.lab[i], drawn.lab[i]);
      distances.push_back(static_cast<float>(distance));
      sum += distance;
      if (!truth.in_focus[i]) continue;
      focus_sum += distance;
      focus_count += 1;
    }
  }
  PictureDifference difference;
  if (distances.empty()) return difference;
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), distances.begin() + at, distances.end());
  difference.mean = sum / static_cast<double>(distances.size());
  difference.p95 = distances[static_cast<std::size_t>(at)];
  difference.lost = lost / covered;
  difference.extra = extra / covered;
  difference.holes = holes / std::max(1.0, inner);
  difference.focus = focus_count > 0 ? focus_sum / focus_count : -1.0;
  return difference;
}

}  // namespace pcl_slim::measure
