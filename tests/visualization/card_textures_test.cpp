// SPDX-License-Identifier: BSD-3-Clause
// Textures of surfels by the graphics card against those of the CPU and of pictures.
#include <cmath>

#include "pcl_slim/render/shading.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/visualization/studio.h"
#include "support/colors.h"
#include "visualization/card_window.h"

namespace pcl_slim::test {
namespace {

/** \brief Squares of about .07 in black and white on a coloured ground. */
std::array<double, 3> squares(const std::array<double, 3>& p) {
  constexpr double kWidth = 0.07;
  double sign = 1.0;
  for (const double x : p) sign *= std::sin(M_PI * x / kWidth) < 0.0 ? -1.0 : 1.0;
  const double white = sign > 0.0 ? 255.0 : 0.0;
  return {white, 0.5 * (white + 180.0), 180.0};
}

/** \brief A sphere of radius .25 that squares are painted on, fitted to 30000 points. */
std::shared_ptr<SLIMSurface> paintedSphere() {
  constexpr int kCount = 30000;
  std::vector<double> points;
  std::vector<float> normals;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kCount, rho = std::sqrt(1.0 - z * z);
    const double angle = 2.39996323 * i;
    for (const double n : {rho * std::cos(angle), rho * std::sin(angle), z}) {
      points.push_back(0.25 * n);
      normals.push_back(static_cast<float>(n));
    }
  }
  const std::vector<std::uint8_t> bgr = pcl_slim_test::bgrOf(points, squares);
  ScanView scan;
  scan.points.xyz = points.data();
  scan.points.xyz_stride = 3 * sizeof(double);
  scan.points.scalar = CloudView::Scalar::kDouble;
  scan.points.size = kCount;
  scan.points.normal = normals.data();
  scan.points.normal_stride = 3 * sizeof(float);
  scan.colors = {bgr.data(), 3};
  FittedScan fitted;
  const Error error = fitScan(scan, {}, fitted);
  EXPECT_FALSE(error) << error.message;
  return std::make_shared<SLIMSurface>(std::move(fitted.surface));
}

/** \brief A smooth colour of space, 0..255: waves of a length of .2. */
std::array<double, 3> waves(const std::array<double, 3>& p) {
  std::array<double, 3> color;
  for (std::size_t a = 0; a < 3; ++a) color[a] = 128.0 + 120.0 * std::sin(10.0 * M_PI * p[a]);
  return color;
}

class CardTextures : public CardTest {
 protected:
  CardTextures() {
    // Bare colours.
    mapper->setLight(ObjectLight::kStudio);
    actor->GetProperty()->LightingOff();
  }

  /** \brief The picture of a surface's colours by the window's camera, without light. */
  Image expectedPicture() {
    vtkCamera* from = renderer->GetActiveCamera();
    Camera camera;
    from->GetPosition(camera.position.data());
    from->GetFocalPoint(camera.look_at.data());
    from->GetViewUp(camera.up.data());
    camera.fov = from->GetViewAngle();
    camera.size = {window->GetSize()[0], window->GetSize()[1]};
    ShadingParams shading;
    shading.mode = ShadingMode::kColor;
    shading.supersampling = 1;
    shading.lighting = false;
    const auto expected = renderPicture(*mapper->getSurface(), camera, {}, shading);
    EXPECT_TRUE(expected) << expected.error().message;
    return *expected;
  }
};

TEST_F(CardTextures, RandomOnesAreThoseOfTheCpu) {
  window->SetSize(80, 60);
  const auto plain = unevenSphere(3);
  pcl_slim_test::setRandomColors(*plain);
  const auto textured = std::make_shared<SLIMSurface>(*plain);
  pcl_slim_test::setRandomTextures(*textured);
  mapper->setSurface(textured);
  ASSERT_TRUE(mapper->setMode(DisplayMode::kColor));
  EXPECT_LE(difference(), kFewPixels);
  const Image colored = picture();
  // Another surface in the same window.
  mapper->setSurface(plain);
  EXPECT_LE(difference(), kFewPixels);
  EXPECT_GT(shareDifferent(colored, picture(), 16), 0.1);
  mapper->setSurface(textured);
  EXPECT_EQ(shareDifferent(colored, picture(), 0), 0.0);
  // From inside, where leaves show their backs.
  mapper->setSides(VisibleSides::kBoth);
  renderer->GetActiveCamera()->SetPosition(0.0, 0.0, 0.05);
  renderer->GetActiveCamera()->SetFocalPoint(0.0, 0.0, -1.0);
  EXPECT_LE(difference(), kFewPixels);
}

TEST_F(CardTextures, APaintedScanHasTheColoursOfItsPicture) {
  const auto surface = paintedSphere();
  ASSERT_TRUE(surface->hasTextures());
  mapper->setSurface(surface);
  ASSERT_TRUE(mapper->setMode(DisplayMode::kColor));
  setStudioBackground(renderer);
  window->SetSize(320, 240);
  const Image expected = expectedPicture();
  for (const RayBackend backend : {RayBackend::kCPU, RayBackend::kOpenGL})
    EXPECT_LE(shareDifferent(expected, pictureBy(backend), 2), kFewPixels);
  // Polynomials are not so sharp.
  const auto plain = std::make_shared<SLIMSurface>(*surface);
  plain->dropTextures();
  mapper->setSurface(plain);
  EXPECT_GT(shareDifferent(expected, pictureBy(RayBackend::kOpenGL), 32), 0.05);
}

TEST_F(CardTextures, CoarserSurfelsHaveTheirOwn) {
  const auto surface = paintedSphere();
  surface->colors.assign(surface->size() * kColorBytes, 0);  // polynomials are black
  pcl_slim_test::setTexturesOf(*surface, 24, waves);
  mapper->setSurface(surface);
  ASSERT_TRUE(mapper->setMode(DisplayMode::kColor));
  const Image fine = pictureBy(RayBackend::kCPU);
  mapper->setMode(DisplayMode::kSize);
  const Image fine_sizes = pictureBy(RayBackend::kOpenGL);
  mapper->setLevelOfDetail(20.0);
  const double coarser = shareDifferent(fine_sizes, picture(), 2);
  EXPECT_GT(coarser, 0.1);
  mapper->setMode(DisplayMode::kColor);
  // Coarse surfels are seen beyond their textures, too, where they overlap little: black here.
  EXPECT_LT(shareDifferent(fine, picture(), 8), 0.3 * coarser);
}

}  // namespace
}  // namespace pcl_slim::test
