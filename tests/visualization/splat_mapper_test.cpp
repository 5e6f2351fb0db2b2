// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/splat_mapper.h"

#include <vtkPlane.h>

#include "visualization/test_window.h"

namespace pcl_slim::test {
namespace {

/** \brief Two discs that face the viewer: a red one on the left, a green one on the right. */
std::shared_ptr<SplatSet> twoDiscs() {
  auto splats = std::make_shared<SplatSet>();
  splats->resize(2, false);
  splats->x = {-0.12f, 0.12f};
  splats->y = {0.0f, 0.0f};
  splats->z = {0.0f, 0.0f};
  splats->nx = {0.0f, 0.0f};
  splats->ny = {0.0f, 0.0f};
  splats->nz = {1.0f, 1.0f};
  splats->radius = {0.1f, 0.1f};
  splats->rgb = {0xff0000u, 0x00ff00u};
  return splats;
}

class SplatWindowTest : public WindowTest {
 protected:
  SplatWindowTest() {
    EXPECT_TRUE(discs->setSplats(twoDiscs()));
    discs->setMode(DisplayMode::kColor);
    actor->SetMapper(discs);
    renderer->AddActor(actor);
  }

  vtkNew<SplatMapper> discs;
};

TEST_F(SplatWindowTest, ShowsTheColoursAsTheyAre) {
  const Image image = picture();
  EXPECT_EQ(pixelOf(image, 57, 60), (std::array<int, 3>{255, 0, 0}));
  EXPECT_EQ(pixelOf(image, 103, 60), (std::array<int, 3>{0, 255, 0}));
  EXPECT_EQ(pixelOf(image, 80, 60), (std::array<int, 3>{255, 255, 255}));
  GBuffer pixel;
  ASSERT_TRUE(discs->castRay(renderer, actor, 103, 60, pixel));
  EXPECT_EQ(pixel.surfel[0], 1u);
}

TEST_F(SplatWindowTest, HasNoCurvatureAndNoLevels) {
  EXPECT_FALSE(discs->setMode(DisplayMode::kMean));
  EXPECT_FALSE(discs->setMode(DisplayMode::kLevel));
  const Image colored = picture();
  EXPECT_TRUE(discs->setMode(DisplayMode::kShaded));
  EXPECT_GT(shareDifferent(colored, picture(), 2), 0.05);
  EXPECT_EQ(discs->getStatistics().rasterized, 1u);
}

TEST_F(SplatWindowTest, ClippingPlanesLeaveDiscsOut) {
  vtkNew<vtkPlane> plane;
  plane->SetNormal(1.0, 0.0, 0.0);
  discs->AddClippingPlane(plane);
  const Image image = picture();
  EXPECT_EQ(pixelOf(image, 57, 60), (std::array<int, 3>{255, 255, 255}));
  EXPECT_EQ(pixelOf(image, 103, 60), (std::array<int, 3>{0, 255, 0}));
}

TEST_F(SplatWindowTest, RefusesBrokenSplats) {
  auto broken = twoDiscs();
  broken->radius[1] = -1.0f;
  EXPECT_FALSE(discs->setSplats(broken));
  EXPECT_EQ(shareDrawn(picture()), 0.0);
}

}  // namespace
}  // namespace pcl_slim::test
