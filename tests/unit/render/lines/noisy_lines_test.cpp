// SPDX-License-Identifier: BSD-3-Clause
// Crest lines in pictures of fitted noisy clouds: those of the shape, and none of the noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/surface_renderer.h"
#include "support/clouds.h"
#include "support/lab/line_truth.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::Cloud;
using Place = std::array<float, 2>;

/** What a camera sees of a fitted cloud. */
struct NoisyView {
  SLIMSurface surface;
  Camera camera;
  GBuffer buffer;

  NoisyView(const Cloud& cloud, const Camera& from) : camera(from) {
    surface = pcl_slim_test::fitted(cloud).surface;
    SurfaceRenderer renderer(surface, 1);
    RenderParams rendering;
    rendering.threads = 1;
    rendering.close_gaps = true;
    rendering.columns = pictureLineColumns(wanted());
    const Error error = renderer.render(camera, rendering, buffer);
    EXPECT_FALSE(error) << error.message;
  }

  static PictureLineParams wanted() {
    PictureLineParams params;
    params.crest = params.contour = true;
    params.threads = 1;
    return params;
  }

  /** Mean radius of the leaves seen, pixels. */
  double radius() const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
      if (!buffer.covered(i)) continue;
      sum += buffer.radius[i] * surface.info.scale;
      count += 1;
    }
    const double distance = length(camera.position);
    return sum / count * camera.size.height / (2 * std::tan(camera.fov * M_PI / 360) * distance);
  }

  /** Vertices of crest lines, or of contours, of a strength and more. */
  std::vector<Place> places(bool crests, const PictureLineParams& params = wanted(),
                            float least = 0) const {
    const auto lines = findPictureLines(buffer, camera, surface, params);
    EXPECT_TRUE(lines) << lines.error().message;
    std::vector<Place> all;
    for (const PictureLine& line : *lines) {
      const bool crest =
          line.kind == PictureLineKind::kRidge || line.kind == PictureLineKind::kRavine;
      for (std::size_t i = 0; i < line.points.size(); ++i) {
        if (crest == crests && line.strength[i] >= least) all.push_back(line.points[i]);
      }
    }
    return all;
  }
};

Camera cameraAt(const Vector3& position) {
  Camera camera;
  camera.position = position;
  camera.up = {0, 0, 1};
  camera.fov = 36;
  camera.size = {400, 350};
  return camera;
}

Cloud cloudOf(const measure::Scene& scene) {
  return {scene.points, scene.normals};
}

Cloud shapeCloud(const std::string& name, double noise, std::uint64_t seed) {
  measure::LineSurface shape;
  EXPECT_TRUE(measure::parseLineSurface(name, shape));
  return cloudOf(measure::sampleSurface(shape, 30000, noise, 0.05, seed));
}

double distanceTo(const std::vector<Place>& places, const Place& p) {
  double least = 1e9;
  for (const Place& q : places)
    least = std::min<double>(least, std::hypot(p[0] - q[0], p[1] - q[1]));
  return least;
}

/** Share of places that are near another set's. */
double shareNear(const std::vector<Place>& places, const std::vector<Place>& others, double reach) {
  const auto near = std::count_if(places.begin(), places.end(),
                                  [&](const Place& p) { return distanceTo(others, p) <= reach; });
  return static_cast<double>(near) / static_cast<double>(std::max<std::size_t>(1, places.size()));
}

TEST(NoisyLines, ASphereHasNone) {
  for (const double noise : {0.0005, 0.002, 0.01}) {
    for (const std::uint64_t seed : {3u, 4u}) {
      const NoisyView view(shapeCloud("sphere", noise, seed), cameraAt({0.7, -3.4, 1.9}));
      EXPECT_TRUE(view.places(true).empty()) << noise << " " << seed;
      // Whatever curvature is required: noise explains all of it.
      PictureLineParams params = NoisyView::wanted();
      params.crest_curvature = 1e-3;
      params.min_length = 0;
      EXPECT_TRUE(view.places(true, params).empty()) << noise << " " << seed;
    }
  }
}

TEST(NoisyLines, ATorusHasNextToNone) {
  // Its tube is equally curved everywhere. Contours are 1500 pixels long.
  for (const double noise : {0.0005, 0.002}) {
    const NoisyView view(shapeCloud("torus", noise, 5), cameraAt({1, -4, 2.6}));
    EXPECT_LT(view.places(true).size(), 20u) << noise;
  }
}

TEST(NoisyLines, BumpsBelowTheNoiseAreNotDrawn) {
  // Bumps a thousandth of the diagonal high, a sixth of it wide, under noise of half a percent.
  const measure::Scene scene = [] {
    measure::LineSurface shape;
    EXPECT_TRUE(measure::parseLineSurface("sphere", shape));
    measure::Scene s = measure::sampleSurface(shape, 30000, 0.005, 0.05, 9);
    for (std::size_t i = 0; i < s.points.size(); i += 3) {
      double* const p = s.points.data() + i;
      const double bump = 1 + 0.0035 * std::sin(9 * p[0]) * std::sin(9 * p[1]) * std::cos(9 * p[2]);
      for (int a = 0; a < 3; ++a) p[a] *= bump;
    }
    return s;
  }();
  const NoisyView view(cloudOf(scene), cameraAt({0.7, -3.4, 1.9}));
  EXPECT_TRUE(view.places(true).empty());
}

/** Edges of the cube that are seen, away from the contours. */
std::vector<Place> edgesSeen(const NoisyView& view, double half_edge, double away) {
  const std::vector<Place> contours = view.places(false);
  std::vector<Place> seen;
  for (const auto& edge : measure::cubeEdges(half_edge, 100)) {
    const auto parts = projectLines({{PictureLineKind::kRidge, {edge[0], edge[1]}}}, view.buffer,
                                    view.camera, view.surface);
    EXPECT_TRUE(parts);
    for (const PictureLine& part : *parts) {
      if (distanceTo(contours, part.points[0]) > away) seen.push_back(part.points[0]);
    }
  }
  return seen;
}

constexpr double kHalfEdge = 0.6;

TEST(NoisyLines, ACubeKeepsItsEdgesAndHasNoOthers) {
  for (const double noise : {0.0005, 0.003}) {
    const NoisyView view(cloudOf(measure::sampleCube(kHalfEdge, 30000, noise, 5)),
                         cameraAt({1.6, -2.2, 1.9}));
    const std::vector<Place> found = view.places(true);
    // A leaf rounds an edge off, and places its crest to a fraction of its radius.
    const double reach = 0.25 * view.radius();
    const std::vector<Place> truth = edgesSeen(view, kHalfEdge, view.radius());
    ASSERT_GT(truth.size(), 100u);
    EXPECT_GT(shareNear(truth, found, reach), 0.95) << noise;
    EXPECT_GT(shareNear(found, edgesSeen(view, kHalfEdge, 0.0), reach), 0.99) << noise;
  }
}

TEST(NoisyLines, ATurnedCloudHasTheSameLines) {
  // A third of a turn about (1, 1, 1): the axes change places, and no number is rounded.
  const auto turned = [](const Vector3& p) { return Vector3{p[2], p[0], p[1]}; };
  const Cloud cloud = shapeCloud("bumpy", 0.001, 6);
  Cloud other = cloud;
  for (std::size_t i = 0; i < cloud.points.size(); i += 3) {
    for (std::size_t a = 0; a < 3; ++a) {
      other.points[i + (a + 1) % 3] = cloud.points[i + a];
      other.normals[i + (a + 1) % 3] = cloud.normals[i + a];
    }
  }
  Camera camera = cameraAt({0.7, -3.4, 1.9});
  const NoisyView view(cloud, camera);
  camera.position = turned(camera.position);
  camera.up = turned(camera.up);
  const NoisyView turned_view(other, camera);
  // Other leaves cover it: lines move by a share of their radius, and those just strong enough for
  // one picture are missing in the other.
  const double reach = 0.1 * view.radius();
  constexpr float kClear = 2.0f;
  const NoisyView* const both[] = {&view, &turned_view};
  for (int i = 0; i < 2; ++i) {
    const std::vector<Place> clear = both[i]->places(true, NoisyView::wanted(), kClear);
    ASSERT_GT(clear.size(), 300u);
    EXPECT_GT(shareNear(clear, both[1 - i]->places(true), reach), 0.95);
  }
}

}  // namespace
}  // namespace pcl_slim
