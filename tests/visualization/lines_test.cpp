// SPDX-License-Identifier: BSD-3-Clause
// Lines over a surface in a window.
#include <vtkCamera.h>

#include <cmath>

#include "visualization/card_window.h"

namespace pcl_slim::test {
namespace {

class LinesTest : public CardTest {
 protected:
  LinesTest() {
    mapper->setSurface(smallSphere());
    actor->GetProperty()->SetAmbient(1.0);
    actor->GetProperty()->SetDiffuse(0.0);
    contours.contour = true;
  }

  /** \brief Pixels darker than anything the grey sphere has. */
  static std::size_t countDark(const Image& image) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) count += image.rgb[i] < 70;
    return count;
  }

  PictureLineParams contours;
};

TEST_F(LinesTest, AContourRunsAroundASphereOnBothBackEnds) {
  for (const RayBackend backend : {RayBackend::kCPU, RayBackend::kOpenGL}) {
    ASSERT_FALSE(mapper->setLines({}));
    const Image plain = pictureBy(backend);
    EXPECT_EQ(countDark(plain), 0u);
    ASSERT_FALSE(mapper->setLines(contours));
    const Image lined = pictureBy(backend);
    // A circle of .25 seen from 1.2 away: 2 pi 47.7 pixels and a line 1.6 pixels wide.
    const double outline = 2.0 * std::acos(-1.0) * 47.7;
    EXPECT_GT(static_cast<double>(countDark(lined)), 0.7 * outline);
    EXPECT_LT(static_cast<double>(countDark(lined)), 2.5 * outline);
    // Away from the contour nothing changes.
    EXPECT_EQ(pixelOf(lined, 80, 60), pixelOf(plain, 80, 60));
    EXPECT_EQ(pixelOf(lined, 2, 2), pixelOf(plain, 2, 2));
  }
}

TEST_F(LinesTest, LinesAreKeptWhileNothingMovesAndFollowTheCamera) {
  ASSERT_FALSE(mapper->setLines(contours));
  pictureBy(RayBackend::kCPU);
  const Image first = picture();
  EXPECT_EQ(mapper->getStatistics().lines, 1u);
  mapper->setMode(DisplayMode::kMean);
  picture();
  EXPECT_EQ(mapper->getStatistics().lines, 1u);
  mapper->setMode(DisplayMode::kShaded);
  renderer->GetActiveCamera()->SetPosition(0.0, 0.0, 2.4);
  renderer->ResetCameraClippingRange();
  EXPECT_LT(countDark(picture()), countDark(first));
  EXPECT_EQ(mapper->getStatistics().lines, 2u);
  EXPECT_EQ(mapper->getStatistics().rasterized, 2u);
}

TEST_F(LinesTest, ASketchIsLinesOnWhite) {
  ASSERT_TRUE(mapper->setMode(DisplayMode::kSketch));
  const Image sketch = pictureBy(RayBackend::kCPU);
  EXPECT_EQ(pixelOf(sketch, 80, 60), (std::array<int, 3>{255, 255, 255}));
  EXPECT_GT(countDark(sketch), 200u);
  mapper->setMode(DisplayMode::kShaded);
  EXPECT_EQ(countDark(picture()), 0u);
}

TEST_F(LinesTest, WiderLinesCoverMoreAndBadOnesAreRefused) {
  ASSERT_FALSE(mapper->setLines(contours));
  const std::size_t fine = countDark(pictureBy(RayBackend::kCPU));
  LineStyle style;
  style.width = 5.0;
  ASSERT_FALSE(mapper->setLines(contours, style));
  EXPECT_GT(countDark(picture()), 2 * fine);
  style.width = 0.0;
  EXPECT_TRUE(mapper->setLines(contours, style));
  EXPECT_EQ(mapper->getLineStyle().width, 5.0);
  contours.min_length = -1.0;
  EXPECT_TRUE(mapper->setLines(contours));
  EXPECT_EQ(mapper->getLines().min_length, 12.0);
}

}  // namespace
}  // namespace pcl_slim::test
