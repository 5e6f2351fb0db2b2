// SPDX-License-Identifier: BSD-3-Clause
// A piece of a cloud is projected to the side that the whole of it has.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/cloud_projection.h"
#include "support/side_scans.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** A cap of a body: its points nearer to one of them than a distance. */
std::vector<std::int32_t> pieceAbout(const Cloud& cloud, std::size_t i, double reach) {
  std::vector<std::int32_t> piece;
  const double* from = &cloud.points[3 * i];
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const double* p = &cloud.points[3 * j];
    if (std::hypot(p[0] - from[0], p[1] - from[1], p[2] - from[2]) < reach)
      piece.push_back(static_cast<std::int32_t>(j));
  }
  return piece;
}

/** Pieces of a cloud with normals that are projected onto the wrong side of the surface of the whole,
 * which is fitted without normals. */
std::size_t numTurnedPieces(const Cloud& truth, double reach) {
  constexpr std::size_t kPieces = 40;
  const Cloud cloud = truth.withoutNormals();
  const auto store = PointStore::build(cloud.view(), 1);
  EXPECT_TRUE(store);
  FitParams params;
  params.threads = 1;
  SLIMSurface surface;
  EXPECT_FALSE(fitSurface(*store, params, surface));
  std::size_t turned = 0;
  for (std::size_t k = 0; k < kPieces; ++k) {
    const auto piece = pieceAbout(cloud, k * cloud.size() / kPieces, reach);
    CloudView view = cloud.view();
    view.indices = piece.data();
    view.num_indices = piece.size();
    CloudProjectionParams how;
    how.projection.threads = 1;
    const auto projection = CloudProjection::make(view, surface, how);
    EXPECT_TRUE(projection) << projection.error().message;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const auto n = projection->point(i).normal;
      const float* own = &truth.normals[3 * static_cast<std::size_t>(piece[i])];
      wrong += n[0] * own[0] + n[1] * own[1] + n[2] * own[2] < -0.5f;
    }
    turned += wrong > piece.size() / 100;
  }
  return turned;
}

TEST(ProjectionPieces, HaveTheSideOfTheWhole) {
  EXPECT_EQ(numTurnedPieces(sceneCloud(measure::Shape::kTorus, 20000, 0.001), 0.4), 0u);
  EXPECT_EQ(numTurnedPieces(sceneCloud(measure::Shape::kBumpy, 20000, 0.001), 0.3), 0u);
  EXPECT_EQ(numTurnedPieces(boxCloud({1, 0.8, 0.2}, 20000, 0.001), 0.4), 0u);
}

}  // namespace
