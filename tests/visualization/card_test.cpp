// SPDX-License-Identifier: BSD-3-Clause
// The back end of the graphics card against that of the CPU, in one window.
#include <vtkPlane.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/colors.h"
#include "visualization/card_window.h"

namespace pcl_slim::test {
namespace {

class CardDegrees : public CardTest, public ::testing::WithParamInterface<int> {};

TEST_P(CardDegrees, EveryModeIsThatOfTheCpu) {
  constexpr DisplayMode kModes[] = {
      DisplayMode::kShaded, DisplayMode::kNormal, DisplayMode::kMean,
      DisplayMode::kGauss,  DisplayMode::kMax,    DisplayMode::kMin,
      DisplayMode::kLevel,  DisplayMode::kSize,   DisplayMode::kError};
  mapper->setSurface(unevenSphere(GetParam()));
  // Planes have no curvature to make a range of.
  mapper->setRange(GetParam() == 1 ? 1.0 : 0.0);
  std::vector<Image> expected;
  for (const DisplayMode mode : kModes) {
    mapper->setMode(mode);
    expected.push_back(pictureBy(RayBackend::kCPU));
    EXPECT_GT(shareDrawn(expected.back()), 0.05);
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    mapper->setMode(kModes[i]);
    const Image image = pictureBy(RayBackend::kOpenGL);
    EXPECT_LE(shareDifferent(expected[i], image, 2), kFewPixels) << nameOf(kModes[i]);
  }
  EXPECT_EQ(mapper->getStatistics().rasterized, 2u);
}

TEST_F(CardTest, ColoursAreThoseOfTheCpu) {
  window->SetSize(80, 60);
  auto surface = unevenSphere(3);
  EXPECT_FALSE(mapper->setMode(DisplayMode::kColor)) << "there is no colour yet";
  pcl_slim_test::setRandomColors(*surface);
  mapper->setSurface(surface);
  ASSERT_TRUE(mapper->setMode(DisplayMode::kColor));
  EXPECT_LE(difference(), kFewPixels);
  const Image colored = picture();
  mapper->setMode(DisplayMode::kShaded);
  EXPECT_GT(shareDifferent(colored, picture(), 2), 0.05);
  mapper->setMode(DisplayMode::kColor);
  EXPECT_EQ(shareDifferent(colored, picture(), 1), 0.0);
  // From inside, where leaves show their backs.
  mapper->setSides(VisibleSides::kBoth);
  renderer->GetActiveCamera()->SetPosition(0.0, 0.0, 0.05);
  renderer->GetActiveCamera()->SetFocalPoint(0.0, 0.0, -1.0);
  EXPECT_LE(difference(), kFewPixels);
}

INSTANTIATE_TEST_SUITE_P(All, CardDegrees, ::testing::Values(1, 2, 3, 4));

TEST_F(CardTest, SmoothSpheresAgreeAtEveryPixelButTheSilhouette) {
  mapper->setSurface(smallSphere());
  mapper->setMode(DisplayMode::kNormal);
  EXPECT_LE(difference(), 4.0 / (160 * 120));
}

TEST_F(CardTest, GapsBetweenShrunkBallsAreClosedAsByTheCpu) {
  // Where a leaf is left out, only the rims of those about it reach.
  auto surface = std::make_shared<SLIMSurface>(sphereSurface(2, 0.25, 600, 0.05));
  for (std::size_t i = 0; i < surface->size(); i += 23) surface->flags[i] = 0;
  pcl_slim_test::setRandomColors(*surface);
  window->SetSize(240, 180);
  mapper->setSurface(surface);
  for (const DisplayMode mode : {DisplayMode::kSize, DisplayMode::kColor}) {
    mapper->setTrimming(true);
    ASSERT_TRUE(mapper->setMode(mode));
    EXPECT_LE(difference(), kFewPixels) << nameOf(mode);
    const Image closed = picture();
    const std::uint64_t met = mapper->getStatistics().covered_pixels;
    mapper->setTrimming(false);  // nothing is closed then
    const Image open = pictureBy(RayBackend::kOpenGL);
    EXPECT_GT(met, mapper->getStatistics().covered_pixels + 20) << nameOf(mode);
    EXPECT_GT(shareDifferent(open, closed, 8), 20.0 / (240 * 180)) << nameOf(mode);
  }
}

TEST_F(CardTest, FollowsTheCameraAndTheActor) {
  mapper->setSurface(unevenSphere(4));
  mapper->setMode(DisplayMode::kNormal);
  renderer->GetActiveCamera()->Azimuth(130.0);
  renderer->GetActiveCamera()->Elevation(40.0);
  EXPECT_LE(difference(), kFewPixels);
  actor->SetScale(0.7);
  actor->RotateY(25.0);
  actor->SetPosition(0.05, 0.1, 0.0);
  EXPECT_LE(difference(), kFewPixels);
  renderer->GetActiveCamera()->SetParallelProjection(true);
  renderer->GetActiveCamera()->SetParallelScale(0.3);
  EXPECT_LE(difference(), kFewPixels);
  // From inside, both sides drawn: leaves' balls reach behind the viewer.
  renderer->GetActiveCamera()->SetParallelProjection(false);
  actor->SetPosition(0.0, 0.0, 0.0);
  actor->SetScale(1.0);
  mapper->setSides(VisibleSides::kBoth);
  renderer->GetActiveCamera()->SetPosition(0.0, 0.0, 0.05);
  renderer->ResetCameraClippingRange();
  EXPECT_LE(difference(), 3.0 * kFewPixels);
}

TEST_F(CardTest, DoubtfulSidesAreBothDrawnAlike) {
  const std::shared_ptr<SLIMSurface> surface = unevenSphere(3);
  mapper->setSurface(surface);
  mapper->setMode(DisplayMode::kShaded);
  renderer->GetActiveCamera()->SetPosition(0.0, 0.0, 0.05);
  renderer->GetActiveCamera()->SetFocalPoint(0.0, 0.0, -1.0);
  renderer->ResetCameraClippingRange();
  EXPECT_EQ(shareDrawn(pictureBy(RayBackend::kOpenGL)), 0.0) << "a front alone, from behind";
  const auto doubtful = std::make_shared<SLIMSurface>(*surface);
  doubtful->info.sides_in_doubt = true;
  mapper->setSurface(doubtful);
  EXPECT_LE(difference(), 3.0 * kFewPixels);
  EXPECT_GT(shareDrawn(picture()), 0.99);
}

TEST_F(CardTest, AnOpenSurfaceEndsWhereTheCpuEndsIt) {
  const std::shared_ptr<SLIMSurface> surface = unevenSphere(2);
  surface->info.oriented = false;
  for (std::size_t i = 0; i < surface->size(); ++i) {
    if (surface->nz[i] > 0.5f) surface->flags[i] = 0;
  }
  mapper->setSurface(surface);
  mapper->setMode(DisplayMode::kNormal);
  // At rims a ray may pass through by one rule's rounding, or step over less of a flap.
  EXPECT_LE(difference(), 8.0 * kFewPixels);
}

TEST_F(CardTest, FarFromTheOriginAndCoarselyToo) {
  const std::shared_ptr<SLIMSurface> surface = unevenSphere(3);
  surface->info.origin = {500000.0, 4500000.0, 1000.0};
  surface->info.scale = 4.0;
  mapper->setSurface(surface);
  mapper->setMode(DisplayMode::kNormal);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetFocalPoint(500000.0, 4500000.0, 1000.0);
  camera->SetPosition(500000.0, 4500000.0, 1004.8);
  renderer->ResetCameraClippingRange();
  EXPECT_LE(difference(), kFewPixels);
}

TEST_F(CardTest, AFrameIsKeptAndFollowsTheWindowAndTheSurface) {
  mapper->setSurface(smallSphere());
  mapper->setBackend(RayBackend::kOpenGL);
  const Image first = picture();
  EXPECT_EQ(mapper->getStatistics().rasterized, 1u);
  EXPECT_GT(mapper->getStatistics().covered_pixels, 3000u);
  mapper->setMode(DisplayMode::kSize);
  EXPECT_GT(shareDifferent(first, picture(), 2), 0.1);
  EXPECT_EQ(mapper->getStatistics().rasterized, 1u);
  mapper->setMode(DisplayMode::kShaded);
  window->SetSize(200, 150);
  const Image large = picture();
  EXPECT_NEAR(shareDrawn(large), shareDrawn(first), 0.01);
  window->SetSize(160, 120);
  mapper->setSurface(smallSphere(0.1));
  EXPECT_LT(shareDrawn(picture()), 0.5 * shareDrawn(first));
  mapper->setSurface(smallSphere());
  EXPECT_EQ(shareDifferent(picture(), first, 0), 0.0);
}

TEST_F(CardTest, DepthAndOpacityComposeAsWithTheCpu) {
  mapper->setSurface(smallSphere());
  actor->GetProperty()->SetOpacity(0.5);
  vtkNew<SLIMMapper> other_mapper;
  other_mapper->setSurface(smallSphere(0.15, {0.15, 0.0, 0.1}));
  other_mapper->setBackend(RayBackend::kOpenGL);
  vtkNew<vtkActor> other;
  other->SetMapper(other_mapper);
  renderer->AddActor(other);
  for (const bool peeling : {false, true}) {
    renderer->SetUseDepthPeeling(peeling);
    EXPECT_LE(difference(), kFewPixels) << peeling;
  }
}

TEST_F(CardTest, TheCpuDrawsWhatIsCutOpen) {
  mapper->setSurface(smallSphere());
  mapper->setBackend(RayBackend::kOpenGL);
  vtkNew<vtkPlane> plane;
  plane->SetNormal(1.0, 0.0, 0.0);
  mapper->AddClippingPlane(plane);
  picture();
  EXPECT_FALSE(mapper->getStatistics().on_card);
  mapper->RemoveAllClippingPlanes();
  picture();
  EXPECT_TRUE(mapper->getStatistics().on_card);
}

TEST_F(CardTest, LeftToItselfItTriesTheCardAndThenTheCpu) {
  picture();
  const std::string driver = window->ReportCapabilities();
  const bool software = driver.find("llvmpipe") != std::string::npos;
  mapper->setSurface(smallSphere());
  const auto turnByCard = [&] {
    renderer->GetActiveCamera()->Azimuth(7.0);
    picture();
    return mapper->getStatistics().on_card;
  };
  double fastest = 1.0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(turnByCard(), !software);
    fastest = std::min(fastest, mapper->getStatistics().rasterize_seconds);
  }
  if (!software && fastest < 1.5e-8 * 160 * 120) return;  // so fast that the CPU is not tried
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(turnByCard());
}

TEST_F(CardTest, EmptySurfacesAndNoneAreDrawnAsNothing) {
  mapper->setBackend(RayBackend::kOpenGL);
  mapper->setSurface(std::make_shared<SLIMSurface>());
  EXPECT_EQ(shareDrawn(picture()), 0.0);
  mapper->setSurface(nullptr);
  EXPECT_EQ(shareDrawn(picture()), 0.0);
}

}  // namespace
}  // namespace pcl_slim::test
