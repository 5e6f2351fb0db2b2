// SPDX-License-Identifier: BSD-3-Clause
// Internal surfels in place of leaves too small to be resolved.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "support/clouds.h"
#include "support/lab/reference/reference_renderer.h"
#include "unit/render/same_buffers.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

class LevelOfDetail : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    FitParams params;
    params.degree = 2;
    const auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kBumpy, 20000, 0.0, 0.02);
    surface_ = new SLIMSurface(pcl_slim_test::fitted(cloud, params).surface);
  }
  static void TearDownTestSuite() { delete surface_; }

  static Camera camera(int width, int height) {
    return fitCamera(spheresOf(*surface_), viewFromAngles(UpAxis::kZ, 25.0, 35.0), {width, height});
  }
  /** \brief Size in pixels of the smallest internal surfel, in a picture of that camera. */
  static double smallestInternal(const Camera& camera) {
    const detail::DetailSizes sizes(*surface_);
    float half = 1.0f;
    for (std::size_t i = 0; i < surface_->size(); ++i) {
      if (!surface_->isLeaf(i)) half = std::min(half, sizes.own[i]);
    }
    const double pixel = 2.0 * std::tan(camera.fov * std::acos(-1.0) / 360.0) / camera.size.height;
    const double distance = std::sqrt(std::pow(camera.position[0] - camera.look_at[0], 2) +
                                      std::pow(camera.position[1] - camera.look_at[1], 2) +
                                      std::pow(camera.position[2] - camera.look_at[2], 2));
    return 2.0 * half * surface_->info.scale / (distance * pixel);
  }
  static GBuffer draw(const Camera& camera, double lod, RenderStatistics* counts = nullptr) {
    RenderParams params;
    params.lod = lod;
    return rendered(*surface_, camera, params, counts);
  }

  static SLIMSurface* surface_;
};

SLIMSurface* LevelOfDetail::surface_ = nullptr;

/** \brief Mean difference of the two pictures' colours where both show the surface, of 255. */
double colorDifference(const GBuffer& a, const GBuffer& b, const Camera& camera) {
  const ShadingParams shading;
  const Result<Image> first = shade(a, camera, shading), second = shade(b, camera, shading);
  EXPECT_TRUE(first && second);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < first->rgb.size(); ++i) {
    if (!a.covered(i / 3) || !b.covered(i / 3)) continue;
    sum += std::abs(int{first->rgb[i]} - int{second->rgb[i]});
    ++count;
  }
  return sum / static_cast<double>(count);
}

TEST_F(LevelOfDetail, BelowEverySurfelNothingChanges) {
  const Camera view = camera(160, 120);
  RenderStatistics counts;
  const double lod = 0.5 * smallestInternal(view);
  ASSERT_GT(lod, 0.0);
  expectSame(draw(view, 0.0), draw(view, lod, &counts));
  EXPECT_EQ(counts.below_detail, 0u);
  EXPECT_EQ(counts.coarse_surfels, 0u);
}

TEST_F(LevelOfDetail, FewerSurfelsGiveThePictureAllTheSame) {
  // So far away that leaves are a pixel wide.
  const Camera view = camera(48, 36);
  RenderStatistics all, few;
  const GBuffer full = draw(view, 0.0, &all), coarse = draw(view, 1.0, &few);
  EXPECT_GT(few.coarse_surfels, 0u);
  EXPECT_GT(few.below_detail, 0u);
  EXPECT_LE(few.outside_frustum + few.back_facing + few.below_detail, few.leaves);
  RenderStatistics least;
  draw(view, 4.0, &least);
  EXPECT_LT(least.tile_entries, all.tile_entries / 2);
  // This cover has holes of a pixel, which larger balls close.
  std::size_t lost = 0, won = 0;
  for (std::size_t i = 0; i < full.numPixels(); ++i) {
    lost += full.covered(i) && !coarse.covered(i);
    won += !full.covered(i) && coarse.covered(i);
  }
  EXPECT_LE(lost, full.numCovered() / 200);
  EXPECT_LE(won, full.numCovered() / 15);
  EXPECT_LT(colorDifference(full, coarse, view), 2.0);
}

// Surfels that popped would turn their pixels at once: of forty steps none may bring more than a
// quarter of the whole change.
TEST_F(LevelOfDetail, SurfelsFadeInsteadOfPopping) {
  constexpr int kSteps = 40;
  const Camera view = camera(96, 72);
  const double first = 0.6 * smallestInternal(view), last = 3.0 * smallestInternal(view);
  GBuffer before = draw(view, first);
  const GBuffer start = before;
  const auto change = [](const GBuffer& a, const GBuffer& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.numPixels(); ++i) {
      if (!a.covered(i) || !b.covered(i)) continue;
      for (std::size_t k = 0; k < 3; ++k) sum += std::abs(a.normal[i][k] - b.normal[i][k]);
    }
    return sum / static_cast<double>(a.numCovered());
  };
  double largest = 0.0, total = 0.0;
  for (int step = 1; step <= kSteps; ++step) {
    GBuffer now = draw(view, first * std::pow(last / first, double{1.0} * step / kSteps));
    const double moved = change(before, now);
    largest = std::max(largest, moved);
    total += moved;
    before = std::move(now);
  }
  EXPECT_GT(change(start, before), 0.0);
  EXPECT_LT(largest, 0.25 * total);
}

TEST_F(LevelOfDetail, ThreadsAndSkippingDoNotChangeAByte) {
  const Camera view = camera(96, 72);
  RenderParams params;
  params.lod = 1.3 * smallestInternal(view);
  params.threads = 1;
  const GBuffer first = rendered(*surface_, view, params);
  for (const int threads : {1, 3}) {
    for (const bool skip : {false, true}) {
      params.threads = threads;
      params.skip = skip;
      expectSame(first, rendered(*surface_, view, params));
    }
  }
}

TEST_F(LevelOfDetail, TheReferenceHasNone) {
  RenderParams params;
  params.lod = 1.0;
  GBuffer buffer;
  EXPECT_TRUE(lab::renderReference(*surface_, camera(16, 12), params, buffer));
}

}  // namespace
}  // namespace pcl_slim
