// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/slim_mapper.h"

#include <vtkLookupTable.h>
#include <vtkMatrix4x4.h>
#include <vtkPlane.h>
#include <vtkPointPicker.h>
#include <vtkPolyDataMapper.h>
#include <vtkPropPicker.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>

#include <cmath>

#include "pcl_slim/render/shading.h"
#include "unit/render/tracer/traced_scenes.h"
#include "visualization/test_window.h"

namespace pcl_slim::test {
namespace {

constexpr double kRadius = 0.25;

/** \brief Share of the window's pixels that a sphere of the given radius about the origin covers.
 */
double sphereShare(double radius, double distance) {
  // The cone of half angle asin(r / d) cuts a disc from the image plane at depth 1.
  const double disc = radius * radius / (distance * distance - radius * radius);
  const double half_height = std::tan(15.0 * std::acos(-1.0) / 180.0);
  return std::acos(-1.0) * disc / (2.0 * half_height * 2.0 * half_height * 160.0 / 120.0);
}

TEST_F(WindowTest, DrawsASphereWhereItIs) {
  EXPECT_EQ(shareDrawn(picture()), 0.0);
  addSphere();
  const Image image = picture();
  EXPECT_NEAR(shareDrawn(image), sphereShare(kRadius, 1.2), 0.01);
  EXPECT_NE(pixelOf(image, 80, 60), pixelOf(image, 2, 2));
  EXPECT_FALSE(mapper->getError());
}

TEST_F(WindowTest, ShowsTheSamePictureAsTheModuleDoes) {
  addSphere();
  for (const auto& [mode, shading] : {std::pair{DisplayMode::kNormal, ShadingMode::kNormal},
                                      std::pair{DisplayMode::kMean, ShadingMode::kMean}}) {
    ASSERT_TRUE(mapper->setMode(mode));
    mapper->setRange(8.0);
    actor->GetProperty()->SetLighting(false);
    Camera camera;
    camera.position = {0.0, 0.0, 1.2};
    camera.size = {160, 120};
    ShadingParams params;
    params.mode = shading;
    params.range = {-8.0, 8.0};
    params.lighting = false;
    params.gradient_background = false;
    params.supersampling = 1;
    const auto expected = renderPicture(*mapper->getSurface(), camera, {}, params);
    ASSERT_TRUE(expected) << expected.error().message;
    // A ray at the very silhouette may fall to either side by the rounding of the matrices.
    EXPECT_LE(shareDifferent(picture(), *expected, 2), 4.0 / (160 * 120)) << nameOf(mode);
  }
}

TEST_F(WindowTest, FramesAtRestCloseGaps) {
  // Leaves .024 apart but for the four about the middle, which the others' shrunk balls do not
  // reach.
  auto surface = std::make_shared<SLIMSurface>(emptySurface(2));
  for (int i = -14; i <= 14; ++i) {
    for (int j = -14; j <= 14; ++j) {
      const double x = 0.024 * (i + 0.5), y = 0.024 * (j + 0.5);
      if (std::hypot(x, y) > 0.02) addLeaf(*surface, {x, y, 0.0}, {0.0, 0.0, 1.0}, 0.05);
    }
  }
  mapper->setSurface(surface);
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.6, 0.6, 0.6);
  renderer->AddActor(actor);
  renderer->GetActiveCamera()->SetViewAngle(10.0);
  EXPECT_EQ(shareDrawn(picture()), 1.0);
  mapper->setLevelOfDetail(1e-3);  // frames with levels leave them open, as those in motion do
  EXPECT_LT(shareDrawn(picture()), 1.0);
}

TEST_F(WindowTest, RoundingSpansNoColours) {
  auto surface = std::make_shared<SLIMSurface>(sphereSurface(2, 0.25, 200, 0.09));
  for (float& c : surface->coefficients) c *= 1e-9f;
  mapper->setSurface(surface);
  for (const DisplayMode mode : {DisplayMode::kMean, DisplayMode::kGauss, DisplayMode::kMax}) {
    mapper->setMode(mode);
    EXPECT_GT(mapper->getRange(), 0.1) << nameOf(mode);
  }
}

TEST_F(WindowTest, ChangesOfModeAndRangeShadeAgainOnly) {
  addSphere();
  const Image shaded = picture();
  EXPECT_EQ(mapper->getStatistics().rasterized, 1u);
  mapper->setMode(DisplayMode::kNormal);
  EXPECT_GT(shareDifferent(shaded, picture(), 2), 0.1);
  mapper->setMode(DisplayMode::kMean);
  mapper->setRange(100.0);
  const Image pale = picture();
  mapper->setRange(4.0);
  EXPECT_GT(shareDifferent(pale, picture(), 2), 0.1);
  actor->GetProperty()->SetColor(0.0, 1.0, 0.0);
  mapper->setMode(DisplayMode::kShaded);
  EXPECT_GT(shareDifferent(shaded, picture(), 2), 0.1);
  EXPECT_EQ(mapper->getStatistics().rasterized, 1u);
  EXPECT_EQ(mapper->getStatistics().frames, 5u);

  renderer->GetActiveCamera()->Azimuth(20.0);
  picture();
  EXPECT_EQ(mapper->getStatistics().rasterized, 2u);
}

TEST_F(WindowTest, EachModeLooksDifferent) {
  addSphere();
  // Of one sphere, k_max and k_min are the mean; the rest have colours of their own.
  std::vector<Image> seen;
  for (const DisplayMode mode :
       {DisplayMode::kShaded, DisplayMode::kNormal, DisplayMode::kMean, DisplayMode::kLevel,
        DisplayMode::kSize, DisplayMode::kReflection}) {
    ASSERT_TRUE(mapper->setMode(mode));
    const Image image = picture();
    for (const Image& other : seen) EXPECT_GT(shareDifferent(image, other, 2), 0.1) << nameOf(mode);
    seen.push_back(image);
  }
  EXPECT_FALSE(mapper->setMode(DisplayMode::kColor));
  EXPECT_EQ(mapper->getMode(), DisplayMode::kReflection);
}

TEST_F(WindowTest, CurvatureColoursAreThoseOfTheTable) {
  addSphere();
  actor->GetProperty()->SetLighting(false);
  const std::pair<DisplayMode, double> truths[] = {{DisplayMode::kMean, 1.0 / kRadius},
                                                   {DisplayMode::kGauss, 1.0 / kRadius / kRadius},
                                                   {DisplayMode::kMax, 1.0 / kRadius},
                                                   {DisplayMode::kMin, 1.0 / kRadius}};
  for (const auto& [mode, truth] : truths) {
    mapper->setMode(mode);
    mapper->setRange(0.0);
    EXPECT_NEAR(mapper->getRange(), truth, 0.02 * truth) << nameOf(mode);
    mapper->setRange(2.0 * truth);
    const Image image = picture();
    const unsigned char* expected = mapper->GetLookupTable()->MapValue(truth);
    for (std::size_t k = 0; k < 3; ++k) {
      // Blended leaves have the sphere's curvature to about a percent: a few steps of a channel.
      EXPECT_NEAR(pixelOf(image, 80, 60)[k], int{expected[k]}, 6) << nameOf(mode);
    }
  }
}

TEST_F(WindowTest, ComposesDepthWithOtherActors) {
  addSphere();
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(0.1);
  ball->SetCenter(0.2, 0.0, 0.0);
  ball->SetThetaResolution(60);
  ball->SetPhiResolution(60);
  vtkNew<vtkPolyDataMapper> ball_mapper;
  ball_mapper->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> ball_actor;
  ball_actor->SetMapper(ball_mapper);
  ball_actor->GetProperty()->SetColor(1.0, 0.0, 0.0);
  ball_actor->GetProperty()->SetLighting(false);
  renderer->AddActor(ball_actor);
  const auto red = [this] {
    const Image image = picture();
    int count = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        count += pixelOf(image, x, y) == std::array<int, 3>{255, 0, 0};
      }
    }
    return count;
  };
  const int through = red();
  actor->SetVisibility(false);
  const int alone = red();
  actor->SetVisibility(true);
  // The ball's rim sticks out of the sphere: part of it is seen, part is hidden.
  EXPECT_GT(through, alone / 20);
  EXPECT_LT(through, alone / 2);
  ball_actor->SetPosition(0.0, 0.0, -0.5);
  EXPECT_EQ(red(), 0);
  ball_actor->SetPosition(0.0, 0.0, 0.5);
  EXPECT_GT(red(), alone);
}

TEST_F(WindowTest, TwoSurfacesHideEachOther) {
  addSphere();
  actor->GetProperty()->SetLighting(false);
  actor->GetProperty()->SetColor(0.0, 0.0, 1.0);
  vtkNew<SLIMMapper> other_mapper;
  other_mapper->setSurface(smallSphere(0.1, {0.0, 0.0, 0.3}));
  vtkNew<vtkActor> other;
  other->SetMapper(other_mapper);
  other->GetProperty()->SetLighting(false);
  other->GetProperty()->SetColor(0.0, 1.0, 0.0);
  renderer->AddActor(other);
  EXPECT_EQ(pixelOf(picture(), 80, 60), (std::array<int, 3>{0, 255, 0}));
  other->SetPosition(0.0, 0.0, -0.7);
  EXPECT_EQ(pixelOf(picture(), 80, 60), (std::array<int, 3>{0, 0, 255}));
}

TEST_F(WindowTest, OpacityMixesWithWhatIsBehind) {
  addSphere();
  actor->GetProperty()->SetLighting(false);
  actor->GetProperty()->SetColor(0.0, 0.0, 0.0);
  EXPECT_EQ(pixelOf(picture(), 80, 60), (std::array<int, 3>{0, 0, 0}));
  actor->GetProperty()->SetOpacity(0.5);
  for (const bool peeling : {false, true}) {
    renderer->SetUseDepthPeeling(peeling);
    EXPECT_NEAR(pixelOf(picture(), 80, 60)[0], 128, 2) << peeling;
    EXPECT_EQ(pixelOf(picture(), 2, 2)[0], 255) << peeling;
  }
  EXPECT_EQ(mapper->getStatistics().rasterized, 1u);
}

TEST_F(WindowTest, ParallelProjectionKeepsTheSize) {
  addSphere();
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetParallelProjection(true);
  camera->SetParallelScale(0.4);
  const double expected = std::acos(-1.0) * kRadius * kRadius / (0.8 * 0.8 * 160.0 / 120.0);
  const Image image = picture();
  EXPECT_NEAR(shareDrawn(image), expected, 0.01);
  camera->SetPosition(0.0, 0.0, 3.0);
  EXPECT_LE(shareDifferent(image, picture(), 2), 4.0 / (160 * 120));
  SurfacePick pick;
  ASSERT_TRUE(mapper->pick(renderer, actor, 80, 60, pick));
  EXPECT_NEAR(pick.position[2], kRadius, 1e-3);
}

TEST_F(WindowTest, FollowsTheWindowsSizeAndViewport) {
  addSphere();
  const double share = shareDrawn(picture());
  window->SetSize(321, 243);
  const Image large = picture();
  EXPECT_EQ(large.width, 321);
  EXPECT_NEAR(shareDrawn(large), share * (160.0 / 120.0) / (321.0 / 243.0), 0.01);
  // In the right half alone the sphere stands in that half's middle, as high as before.
  vtkNew<vtkRenderer> left;
  left->SetBackground(1.0, 1.0, 1.0);
  left->SetViewport(0.0, 0.0, 0.5, 1.0);
  window->AddRenderer(left);
  renderer->SetViewport(0.5, 0.0, 1.0, 1.0);
  const Image half = picture();
  const std::array<int, 3> white{255, 255, 255};
  for (const int y : {20, 121, 222}) EXPECT_EQ(pixelOf(half, 80, y), white) << y;
  for (const int y : {30, 121, 212}) EXPECT_NE(pixelOf(half, 240, y), white) << y;
  for (const int y : {20, 223}) EXPECT_EQ(pixelOf(half, 240, y), white) << y;
}

TEST_F(WindowTest, FollowsTheActorsPlaceAndScale) {
  addSphere();
  const double share = shareDrawn(picture());
  actor->SetScale(0.5);
  EXPECT_NEAR(shareDrawn(picture()), sphereShare(0.5 * kRadius, 1.2), 0.01);
  actor->SetScale(1.0);
  actor->SetPosition(0.0, 0.0, 0.15);
  EXPECT_NEAR(shareDrawn(picture()), sphereShare(kRadius, 1.05), 0.01);
  actor->SetPosition(0.0, 0.0, 0.0);
  actor->RotateX(40.0);
  EXPECT_NEAR(shareDrawn(picture()), share, 0.003);
  EXPECT_FALSE(mapper->getError());

  vtkObject::GlobalWarningDisplayOff();
  actor->SetScale(1.0, 2.0, 1.0);
  EXPECT_EQ(shareDrawn(picture()), 0.0);
  EXPECT_NE(mapper->getError().message.find("scale"), std::string::npos);
  actor->SetScale(1.0);
  EXPECT_NEAR(shareDrawn(picture()), share, 0.003);
  vtkObject::GlobalWarningDisplayOn();
}

TEST_F(WindowTest, ClippingPlanesCutTheSurfaceOpen) {
  addSphere();
  actor->GetProperty()->SetLighting(false);
  actor->GetProperty()->SetColor(0.0, 0.0, 0.0);
  const Image whole = picture();
  // The left half is cut away.
  vtkNew<vtkPlane> plane;
  plane->SetNormal(1.0, 0.0, 0.0);
  mapper->AddClippingPlane(plane);
  const Image right = picture();
  EXPECT_NEAR(shareDrawn(right), 0.5 * shareDrawn(whole), 0.01);
  EXPECT_EQ(pixelOf(right, 60, 60)[0], 255);
  EXPECT_NE(pixelOf(right, 100, 60)[0], 255);
  // The front half is cut away: the inner side of the back is seen, in the colour of inner sides.
  plane->SetNormal(0.0, 0.0, -1.0);
  const Image back = picture();
  EXPECT_GT(shareDrawn(back), 0.8 * sphereShare(kRadius, 1.2));
  EXPECT_NE(pixelOf(back, 80, 60), pixelOf(whole, 80, 60));
  SurfacePick pick;
  ASSERT_TRUE(mapper->pick(renderer, actor, 80, 60, pick));
  EXPECT_NEAR(pick.position[2], -kRadius, 1e-3);
  mapper->RemoveAllClippingPlanes();
  EXPECT_EQ(shareDifferent(picture(), whole, 0), 0.0);
}

TEST_F(WindowTest, PickTellsTheSurfelAndItsCurvature) {
  addSphere();
  picture();
  SurfacePick pick;
  ASSERT_TRUE(mapper->pick(renderer, actor, 80, 60, pick));
  EXPECT_NEAR(pick.position[2], kRadius, 1e-3);
  EXPECT_NEAR(pick.normal[2], 1.0, 1e-2);
  EXPECT_NEAR(pick.mean, 1.0 / kRadius, 0.02 / kRadius);
  EXPECT_NEAR(pick.gauss, 1.0 / kRadius / kRadius, 0.04 / kRadius / kRadius);
  const SLIMSurface& surface = *mapper->getSurface();
  EXPECT_LT(std::hypot(surface.cx[pick.surfel], surface.cy[pick.surfel]),
            surface.radius[pick.surfel]);
  EXPECT_EQ(pick.level, surface.level[pick.surfel]);
  EXPECT_EQ(pick.radius, double{surface.radius[pick.surfel]});
  EXPECT_FALSE(mapper->pick(renderer, actor, 2, 2, pick));
  EXPECT_FALSE(mapper->pick(renderer, actor, 500, 60, pick));
}

TEST_F(WindowTest, PickersOfVtkFindTheActor) {
  addSphere();
  picture();
  vtkNew<vtkPropPicker> picker;
  EXPECT_TRUE(picker->PickProp(80, 60, renderer));
  EXPECT_EQ(picker->GetActor(), actor.Get());
  EXPECT_FALSE(picker->PickProp(2, 2, renderer));
  vtkNew<vtkPointPicker> points;
  points->SetTolerance(0.05);
  ASSERT_TRUE(points->Pick(80, 60, 0, renderer));
  EXPECT_EQ(points->GetActor(), actor.Get());
  EXPECT_GE(points->GetPointId(), 0);
}

TEST_F(WindowTest, FarFromTheOriginThePictureIsTheSame) {
  addSphere();
  const Image image = picture();
  auto far = std::make_shared<SLIMSurface>(*mapper->getSurface());
  far->info.origin = {500000.0, 4500000.0, 1000.0};
  mapper->setSurface(far);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetFocalPoint(500000.0, 4500000.0, 1000.0);
  camera->SetPosition(500000.0, 4500000.0, 1001.2);
  // Doubles resolve 1e-9 there.
  EXPECT_LE(shareDifferent(image, picture(), 2), 8.0 / (160 * 120));
}

TEST_F(WindowTest, NothingToDrawDrawsNothing) {
  actor->SetMapper(mapper);
  renderer->AddActor(actor);
  EXPECT_EQ(shareDrawn(picture()), 0.0);
  EXPECT_TRUE(mapper->setSurface(std::make_shared<SLIMSurface>()));
  EXPECT_EQ(shareDrawn(picture()), 0.0);
  auto broken = smallSphere();
  broken->radius[0] = -1.0f;
  EXPECT_FALSE(mapper->setSurface(broken));
  EXPECT_EQ(mapper->getSurface(), nullptr);
  EXPECT_EQ(shareDrawn(picture()), 0.0);
  EXPECT_TRUE(mapper->setSurface(smallSphere()));
  EXPECT_GT(shareDrawn(picture()), 0.1);
  EXPECT_TRUE(mapper->setSurface(nullptr));
  EXPECT_EQ(shareDrawn(picture()), 0.0);
}

TEST_F(WindowTest, ThreadsDoNotChangeThePicture) {
  addSphere();
  mapper->setNumberOfThreads(1);
  const Image one = picture();
  mapper->setSurface(smallSphere());
  mapper->setNumberOfThreads(4);
  EXPECT_EQ(one.rgb, picture().rgb);
}

}  // namespace
}  // namespace pcl_slim::test
