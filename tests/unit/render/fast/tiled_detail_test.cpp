// SPDX-License-Identifier: BSD-3-Clause
// A surface fitted by tiles, seen from afar: levels above the tiles' first stand for their leaves.
#include <gtest/gtest.h>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/stream/stream_fit.h"
#include "support/clouds.h"
#include "support/frame_difference.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

class TiledDetail : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kBumpy, 100000, 0.001);
    StreamParams params;
    params.tile_points = 10000;
    CloudSource source(cloud.view());
    tiled_ = new SLIMSurface;
    const Error error = fitTiles(source, params, *tiled_);
    ASSERT_FALSE(error) << error.message;
    whole_ = new SLIMSurface(pcl_slim_test::fitted(cloud).surface);
  }
  static void TearDownTestSuite() {
    delete tiled_;
    delete whole_;
  }

  /** \brief A camera in whose picture the object is so many pixels high. */
  static Camera camera(int height) {
    return fitCamera(spheresOf(*whole_), viewFromAngles(UpAxis::kZ, 25.0, 35.0), {height, height});
  }
  static GBuffer draw(const SLIMSurface& surface, int height, double lod,
                      RenderStatistics& counts) {
    RenderParams params;
    params.lod = lod;
    return rendered(surface, camera(height), params, &counts);
  }

  static SLIMSurface *tiled_, *whole_;
};

SLIMSurface* TiledDetail::tiled_ = nullptr;
SLIMSurface* TiledDetail::whole_ = nullptr;

TEST_F(TiledDetail, LevelsAboveTheTilesReachToTheTop) {
  ASSERT_EQ(tiled_->child_begin.size(), tiled_->size() + 1);
  std::size_t coarse = 0, roots = 0;
  int first = 255;
  for (std::size_t i = 0; i < tiled_->size(); ++i)
    if (tiled_->isLeaf(i)) first = std::min<int>(first, tiled_->level[i]);
  for (std::size_t i = 0; i < tiled_->size(); ++i) coarse += tiled_->level[i] < first;
  for (const std::uint32_t root : tiled_->roots) roots += tiled_->level[root] >= first;
  EXPECT_GT(coarse, 20u);
  EXPECT_LT(coarse, tiled_->numLeaves() / 2);
  // What no coarser surfel's ball contains has none above it; without these levels all of a tile's
  // first do.
  EXPECT_LT(roots, tiled_->numLeaves() / 20);
}

TEST_F(TiledDetail, AFarFrameTouchesFewSurfels) {
  RenderStatistics far, core, all;
  const GBuffer seen = draw(*tiled_, 30, 1.0, far), truth = draw(*whole_, 30, 1.0, core);
  draw(*tiled_, 30, 0.0, all);
  EXPECT_GT(far.below_detail, 0.9 * static_cast<double>(tiled_->numLeaves()));
  EXPECT_LT(far.tile_entries, 0.5 * static_cast<double>(all.tile_entries));
  EXPECT_LT(far.tile_entries, 2.2 * static_cast<double>(core.tile_entries));
  const FrameDifference d = compareFrames(seen, truth, whole_->info.diagonal);
  EXPECT_LT(d.one, d.both / 20);
  EXPECT_LT(d.depth_p99, 0.02);
}

TEST_F(TiledDetail, NearFramesAreThoseOfTheLeaves) {
  RenderStatistics with, without;
  const GBuffer seen = draw(*tiled_, 600, 1.0, with), truth = draw(*tiled_, 600, 0.0, without);
  const FrameDifference d = compareFrames(seen, truth, whole_->info.diagonal);
  EXPECT_LT(d.one, d.both / 500);
  EXPECT_LT(d.normal_p95, 1.0);
}

}  // namespace
}  // namespace pcl_slim
