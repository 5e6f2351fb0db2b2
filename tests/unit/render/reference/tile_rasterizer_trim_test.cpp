// SPDX-License-Identifier: BSD-3-Clause
// Trim maps end what is drawn; rays that pass a border go on behind it.
#include <gtest/gtest.h>

#include <cmath>

#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

constexpr int kMapSide = 9;

/** Level discs, one above the other, all but the lowest with data where x < 0 alone. */
SLIMSurface halfDiscs(std::size_t count) {
  SLIMSurface surface;
  surface.info.degree = 1;
  surface.info.oriented = true;
  surface.resize(count);
  std::vector<std::uint8_t> sides(count), bits;
  for (std::size_t i = 0; i < count; ++i) {
    surface.nz[i] = 1.0f;
    surface.cz[i] = 0.25f * static_cast<float>(i);
    surface.radius[i] = 0.25f;
    surface.degree[i] = 1;
    surface.flags[i] = kSurfelLeaf;
    if (i == 0) continue;
    sides[i] = kMapSide;
    std::vector<std::uint8_t> map(TrimMap::numBytes(kMapSide));
    for (int k = 0; k < kMapSide * kMapSide; ++k) {
      const bool inside = k % kMapSide < kMapSide / 2;  // u is x in this frame
      map[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(inside << (k & 7));
    }
    bits.insert(bits.end(), map.begin(), map.end());
  }
  surface.setTrimMaps(sides, bits);
  return surface;
}

TEST(TrimmedPicture, EndsAtTheBorderAndShowsWhatLiesBehind) {
  const SLIMSurface surface = halfDiscs(2);
  Camera camera = frontCamera(160, 120);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.6;
  RenderParams params;
  params.min_coverage = 0.05;
  const GBuffer trimmed = referenceFrame(surface, camera, params);
  params.trim = false;
  const GBuffer whole = referenceFrame(surface, camera, params);
  const double border = -0.25 / (kMapSide - 1);  // half a node before the middle
  std::size_t behind = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const std::size_t i = whole.index(x, y);
      if (!whole.covered(i)) continue;
      ASSERT_EQ(whole.surfel[i], 1u);
      const double place = whole.position[i][0];
      if (std::abs(place - border) < 1e-4) continue;  // rounding decides
      EXPECT_EQ(trimmed.surfel[i], place < border ? 1u : 0u) << x << ' ' << y;
      behind += trimmed.surfel[i] == 0u;
    }
  }
  EXPECT_GT(behind, 1000u);
}

TEST(TrimmedPicture, NothingIsDrawnWhereNothingLiesBehind) {
  SLIMSurface surface = halfDiscs(3);
  surface.cz[0] = 5.0f;  // behind the camera
  RenderParams params;
  const Camera camera = frontCamera();
  const std::size_t with = referenceFrame(surface, camera, params).numCovered();
  params.trim = false;
  const std::size_t without = referenceFrame(surface, camera, params).numCovered();
  EXPECT_GT(with, without / 3);
  EXPECT_LT(with, 2 * without / 3);
}

TEST(TrimmedPicture, RaysPassALeafWhereItHasNoDataWithoutABlend) {
  const SLIMSurface surface = halfDiscs(2);
  Camera camera = frontCamera(160, 120);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.6;
  for (const bool reference : {true, false}) {
    const auto draw = reference ? referenceFrame : rendered;
    RenderParams params;
    RenderStatistics trimmed, whole;
    draw(surface, camera, params, &trimmed);
    params.trim = false;
    draw(surface, camera, params, &whole);
    EXPECT_GT(trimmed.rays_blend, 0u);
    EXPECT_LE(trimmed.rays_blend, whole.rays_blend) << (reference ? "reference" : "fast");
  }
}

}  // namespace
}  // namespace pcl_slim
