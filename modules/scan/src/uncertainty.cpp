// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/scan/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim {

namespace {

constexpr int kNodes = 9;             ///< a side, of the places of a leaf
constexpr double kWithin = 0.7;       ///< [r] the part of a leaf's disc that has places
constexpr double kPercentile = 0.95;  ///< of the errors inside an automatic range

/** Places on a surface, world coordinates. */
struct Places {
  std::vector<Vector3> positions;
  std::vector<std::array<float, 3>> normals;
};

/** Adds the places of a leaf, on its polynomial. */
void addPlaces(const SLIMSurface& surface, std::size_t i, Places& places) {
  const std::array<float, 3> normal = {surface.nx[i], surface.ny[i], surface.nz[i]};
  const LocalFrame frame({normal[0], normal[1], normal[2]});
  const SurfaceInfo& info = surface.info;
  const double center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
  for (int k = 0; k < kNodes * kNodes; ++k) {
    const double u = kWithin * (2.0 * (k % kNodes) / (kNodes - 1) - 1),
                 v = kWithin * (2.0 * (k / kNodes) / (kNodes - 1) - 1);
    if (u * u + v * v > kWithin * kWithin) continue;
    if (outsideShare(surface.trimMap(i), u, v) > 0.5) continue;
    const double h = evaluateHeight(surface.degree[i], surface.coefficientsOf(i), u, v);
    Vector3 place;
    for (std::size_t a = 0; a < 3; ++a) {
      const double local =
          center[a] + surface.radius[i] * (u * frame.u[a] + v * frame.v[a] + h * frame.w[a]);
      place[a] = info.origin[a] + info.scale * local;
    }
    places.positions.push_back(place);
    places.normals.push_back(normal);
  }
}

double percentileOf(const std::vector<StandardErrors>& errors) {
  std::vector<double> values;
  for (const StandardErrors& e : errors) {
    if (e.position > 0) values.push_back(e.position);
  }
  if (values.empty()) return 0;
  const auto last = static_cast<double>(values.size() - 1);
  return kthSmallest(values, static_cast<std::size_t>(kPercentile * last));
}

std::array<std::uint8_t, 3> bgrOf(const std::array<float, 3>& color) {
  std::array<std::uint8_t, 3> bgr;
  for (std::size_t c = 0; c < 3; ++c)
    bgr[2 - c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[c], 0.0f, 1.0f)));
  return bgr;
}

}  // namespace

Result<std::array<double, 2>> paintUncertainty(SLIMSurface& surface,
                                               const std::array<double, 2>& range,
                                               const ShareColor& color, int threads) {
  Places places;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) addPlaces(surface, i, places);
  }
  const std::vector<StandardErrors> errors =
      surfaceErrors(surface, places.positions, places.normals, threads);
  std::array<double, 2> shown = {0.0, percentileOf(errors)};
  if (range[0] < range[1]) shown = range;
  if (!(shown[1] > shown[0])) {
    return Error{ErrorCode::kBadArgument,
                 "the surface has no standard error anywhere: fit it to points with noise"};
  }
  std::vector<std::array<std::uint8_t, 3>> bgr;
  Places known;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (!(errors[k].position > 0)) continue;  // a place that no leaf supports
    known.positions.push_back(places.positions[k]);
    known.normals.push_back(places.normals[k]);
    bgr.push_back(bgrOf(color((errors[k].position - shown[0]) / (shown[1] - shown[0]))));
  }
  CloudView cloud;
  cloud.xyz = known.positions.data();
  cloud.xyz_stride = sizeof(Vector3);
  cloud.scalar = CloudView::Scalar::kDouble;
  cloud.size = known.positions.size();
  cloud.normal = known.normals.data();
  cloud.normal_stride = sizeof(known.normals[0]);
  ColorView colors;
  colors.bgr = bgr.data();
  colors.stride = sizeof(bgr[0]);
  const Result<PaintStatistics> painted = paintColors(cloud, colors, threads, surface);
  if (!painted) return painted.error();
  return shown;
}

}  // namespace pcl_slim
