// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/picture_lines.h"

#include <algorithm>

#include "unit/render/lines/exact_view.h"

namespace pcl_slim {
namespace {

using test::ExactView;

PictureLineParams every() {
  PictureLineParams params;
  params.crest = params.suggestive = params.contour = true;
  return params;
}

std::vector<PictureLine> linesOf(const ExactView& view, const PictureLineParams& params) {
  auto lines = findPictureLines(view.buffer, view.camera, view.surface, params);
  EXPECT_TRUE(lines) << lines.error().message;
  return lines ? *lines : std::vector<PictureLine>();
}

std::size_t countOf(const std::vector<PictureLine>& lines, PictureLineKind kind) {
  return static_cast<std::size_t>(std::count_if(
      lines.begin(), lines.end(), [&](const PictureLine& line) { return line.kind == kind; }));
}

TEST(PictureLines, SphereHasItsContourOnly) {
  ExactView view("sphere");
  view.render();
  const auto lines = linesOf(view, every());
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].kind, PictureLineKind::kContour);
  EXPECT_TRUE(lines[0].closed);
}

TEST(PictureLines, ContourOfASphereIsItsSilhouette) {
  for (const auto projection :
       {Camera::Projection::kPerspective, Camera::Projection::kOrthographic}) {
    ExactView view("sphere");
    view.camera.projection = projection;
    view.camera.view_height = 3;
    view.camera.position = {0, -4, 0};
    view.render();
    PictureLineParams params;
    params.contour = true;
    const auto lines = linesOf(view, params);
    ASSERT_EQ(lines.size(), 1u);
    const bool perspective = projection == Camera::Projection::kPerspective;
    const double half = std::tan(view.camera.fov * M_PI / 360);
    const double radius = perspective ? 100 / half / std::sqrt(15.0) : 100 / 1.5;
    for (const auto& p : lines[0].points)
      EXPECT_NEAR(std::hypot(p[0] - 119.5, p[1] - 99.5), radius, 0.8);
  }
}

/** Exact crest lines as the camera sees them, and how far a found one is from the nearest. */
void expectExactCrestLines(Camera::Projection projection) {
  ExactView view("ellipsoid", 233, 200);
  view.camera.projection = projection;
  view.camera.view_height = 2.4;
  view.render();
  PictureLineParams params;
  params.crest = true;
  params.crest_curvature = 0.5;
  const auto lines = linesOf(view, params);
  std::vector<std::array<float, 2>> truth;
  for (const bool ravine : {false, true}) {
    for (const auto& segment : measure::exactLines(view.truth, ravine, 600)) {
      const SpaceLine line{PictureLineKind::kRidge, {segment[0], segment[1]}};
      const auto seen = projectLines({line}, view.buffer, view.camera, view.surface);
      ASSERT_TRUE(seen);
      for (const auto& part : *seen)
        truth.insert(truth.end(), part.points.begin(), part.points.end());
    }
  }
  ASSERT_FALSE(truth.empty());
  ASSERT_GT(countOf(lines, PictureLineKind::kRidge), 0u);
  std::size_t far = 0, all = 0;
  for (const PictureLine& line : lines) {
    for (const auto& p : line.points) {
      float least = 1e9f;
      for (const auto& q : truth) least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1]));
      ++all;
      far += least > 1.0f;
    }
  }
  EXPECT_LE(far, all / 100) << "of " << all;
}

TEST(PictureLines, CrestLinesLieOnExactOnes) {
  expectExactCrestLines(Camera::Projection::kPerspective);
  expectExactCrestLines(Camera::Projection::kOrthographic);
}

/** Radial curvature by the exact Hessian at the place a pixel's ray meets. */
double radialCurvature(const ExactView& view, const std::array<float, 2>& place) {
  const std::size_t i = view.buffer.index(static_cast<int>(std::lround(place[0])),
                                          static_cast<int>(std::lround(place[1])));
  const detail::CameraRays rays(view.camera, view.surface.info.origin, 1.0);
  const auto ray =
      rays.ray(static_cast<int>(std::lround(place[0])), static_cast<int>(std::lround(place[1])));
  const measure::Jet jet = view.at(along(ray.origin, view.buffer.depth[i], ray.direction));
  const Vector3 n = normalized(jet.g);
  const Vector3 w = normalized(along(scaled(ray.direction, -1.0), dot(n, ray.direction), n));
  return dot(w, multiplied(jet.h, w)) / length(jet.g);
}

void expectZerosOfRadialCurvature(Camera::Projection projection) {
  ExactView view("bumpy", 300, 250);
  view.camera.projection = projection;
  view.camera.view_height = 2.4;
  view.render();
  PictureLineParams params;
  params.suggestive = true;
  const auto lines = linesOf(view, params);
  ASSERT_GT(countOf(lines, PictureLineKind::kSuggestive), 0u);
  double largest = 0;
  for (const PictureLine& line : lines) {
    for (const auto& p : line.points)
      largest = std::max(largest, std::abs(radialCurvature(view, p)));
  }
  // Curvatures of the surface reach 8; half a pixel beside a zero they reach a twentieth of that.
  EXPECT_LT(largest, 0.4);
}

TEST(PictureLines, SuggestiveContoursAreZerosOfRadialCurvature) {
  expectZerosOfRadialCurvature(Camera::Projection::kPerspective);
  expectZerosOfRadialCurvature(Camera::Projection::kOrthographic);
}

TEST(PictureLines, NoiseThatExplainsCurvatureHidesLines) {
  ExactView view("ellipsoid");
  view.render();
  PictureLineParams params;
  params.crest = params.suggestive = true;
  view.surface.info.lambda = 1e-4;
  EXPECT_TRUE(linesOf(view, params).empty());
}

TEST(PictureLines, SameForAnyNumberOfThreads) {
  ExactView view("bumpy");
  view.render();
  PictureLineParams params = every();
  params.threads = 1;
  const auto one = linesOf(view, params);
  params.threads = 3;
  const auto three = linesOf(view, params);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].kind, three[i].kind);
    EXPECT_EQ(one[i].points, three[i].points);
    EXPECT_EQ(one[i].strength, three[i].strength);
  }
}

TEST(PictureLines, EmptyPictureHasNoLines) {
  ExactView view("sphere");
  view.camera.look_at = {0, -9, 0};
  view.render();
  EXPECT_TRUE(linesOf(view, every()).empty());
}

TEST(PictureLines, MistakesAreNamed) {
  ExactView view("sphere", 20, 16);
  view.render();
  PictureLineParams params = every();
  params.crest_curvature = -1;
  EXPECT_FALSE(findPictureLines(view.buffer, view.camera, view.surface, params));
  GBuffer bare;
  bare.resize(20, 16, 0);
  EXPECT_FALSE(findPictureLines(bare, view.camera, view.surface, every()));
  view.camera.size = {21, 16};
  EXPECT_FALSE(findPictureLines(view.buffer, view.camera, view.surface, every()));
  EXPECT_FALSE(projectLines({}, view.buffer, view.camera, view.surface));
}

TEST(PictureLines, LinesBehindTheSurfaceAreHidden) {
  ExactView view("sphere");
  view.render();
  SpaceLine line{PictureLineKind::kRidge, {}};
  for (int i = 0; i <= 200; ++i) {
    const double a = 2 * M_PI * i / 200;
    line.points.push_back({std::cos(a), std::sin(a), 0});
  }
  const auto seen = projectLines({line}, view.buffer, view.camera, view.surface);
  ASSERT_TRUE(seen);
  std::size_t count = 0;
  for (const auto& part : *seen) count += part.points.size();
  EXPECT_GT(count, 60u);
  EXPECT_LT(count, 110u);
}

Image paper(int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgb.assign(static_cast<std::size_t>(3) * width * height, 255);
  return image;
}

TEST(DrawLines, CoverTheirAreaAndCrossWithoutDarkening) {
  PictureLine across{PictureLineKind::kContour, false, {{2, 10}, {18, 10}}, {4, 4}};
  PictureLine down{PictureLineKind::kContour, false, {{10, 2}, {10, 18}}, {4, 4}};
  Image image = paper(21, 21);
  LineStyle style;
  style.width = 1.0;
  ASSERT_FALSE(drawLines({across, down}, style, image));
  const auto red = [&](int x, int y) { return image.rgb[3 * (y * 21 + x)]; };
  EXPECT_EQ(red(5, 10), 0);
  EXPECT_EQ(red(10, 5), 0);
  EXPECT_EQ(red(10, 10), 0);
  EXPECT_EQ(red(5, 12), 255);
  Image once = paper(21, 21);
  across.points = {{2, 10.5f}, {18, 10.5f}};
  ASSERT_FALSE(drawLines({across}, style, once));
  Image twice = paper(21, 21);
  ASSERT_FALSE(drawLines({across, across}, style, twice));
  EXPECT_EQ(once.rgb, twice.rgb);
  EXPECT_GT(once.rgb[3 * (10 * 21 + 9)], 0);
}

TEST(DrawLines, OnGlassAreThoseOverAPicture) {
  const PictureLine across{PictureLineKind::kRavine, false, {{2, 9.7f}, {18, 11}}, {1, 4}};
  const PictureLine down{PictureLineKind::kRidge, false, {{10, 2}, {11, 18}}, {4, 2}};
  Image over = paper(21, 21);
  ASSERT_FALSE(drawLines({across, down}, {}, over));
  std::vector<std::uint8_t> glass;
  ASSERT_FALSE(drawLines({across, down}, {}, {21, 21}, glass));
  ASSERT_EQ(glass.size(), 4u * 21 * 21);
  const auto linear = [](double s) { return std::pow((s + 0.055) / 1.055, 2.4); };
  for (std::size_t i = 0; i < over.rgb.size(); ++i) {
    const double cover = glass[i / 3 * 4 + 3] / 255.0, ink = glass[i / 3 * 4 + i % 3] / 255.0;
    const double light = 1.0 - cover + cover * (cover > 0 ? linear(ink) : 0.0);
    EXPECT_NEAR(light, linear(over.rgb[i] / 255.0), 0.02) << i;
  }
  EXPECT_TRUE(drawLines({}, LineStyle{-1.0, {}, {}, {}, {}}, {21, 21}, glass));
}

TEST(DrawLines, RefuseAWidthThatIsNone) {
  Image image = paper(4, 4);
  LineStyle style;
  style.width = 0;
  EXPECT_TRUE(drawLines({}, style, image));
}

}  // namespace
}  // namespace pcl_slim
