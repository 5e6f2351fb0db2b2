// SPDX-License-Identifier: BSD-3-Clause
// The controls of a page: views, projection, clipping box, distances, link, layout.
#include <gtest/gtest.h>

#include <sstream>

#include "pcl_slim/render/auto_view.h"
#include "web/page_file.h"
#include "web/page_frame.h"

namespace pcl_slim {
namespace {

using namespace test;

/** \brief A kilometre of a survey: a sphere of 250 m, and a ring around it at half of its radius. */
SLIMSurface surveyedSphere(std::vector<SpaceLine>& ring) {
  SLIMSurface sphere = sphereSurface(4, kSphere, 300, 0.07);
  sphere.info.origin = {431000.0, 5812000.0, 300.0};
  sphere.info.scale = 1000.0;
  // Radii differ, so that their range is none of one number; the polynomials stay where they are.
  for (std::size_t i = 0; i < sphere.size(); ++i) {
    const float wider = 1.0f + 0.1f * static_cast<float>(i % 4);
    sphere.radius[i] *= wider;
    float* c = sphere.coefficients.data() + i * static_cast<std::size_t>(sphere.stride());
    for (const int k : {3, 5}) c[k] *= wider;
    for (const int k : {10, 12, 14}) c[k] *= wider * wider * wider;
  }
  ring.resize(1);
  for (int k = 0; k <= 100; ++k) {
    const double angle = 2.0 * std::acos(-1.0) * k / 100.0;
    ring[0].points.push_back({sphere.info.origin[0] + 251.0 * std::cos(angle),
                              sphere.info.origin[1] + 251.0 * std::sin(angle),
                              sphere.info.origin[2]});
  }
  return sphere;
}

TEST(PageControls, DoWhatTheySay) {
  const std::string why = whyNoBrowser();
  if (!why.empty()) GTEST_SKIP() << why;
  PageParams params;
  const SLIMSurface sphere = surveyedSphere(params.lines);
  ShadingParams shading;
  shading.mode = ShadingMode::kNormal;
  shading.unit = "m";
  const Camera camera =
      fitCamera(spheresOf(sphere), viewFromAngles(UpAxis::kZ, 30, 25), {800, 600});
  const PageFile page(sphere, camera, shading, params);
  shading.mode = ShadingMode::kColor;
  shading.unit = "";
  const PageFile splats(discsOnSphere(), frontCamera(800, 600), shading);
  EXPECT_EQ(runScript("controls.mjs", page.path() + " " + splats.path()), "");
}

TEST(PageControls, ViewsAreThoseOfTheRenderer) {
  if (std::string(PCL_SLIM_NODE).empty()) GTEST_SKIP() << "node is not installed";
  std::ostringstream words;
  words.precision(17);
  const std::array<double, 3> ups[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const UpAxis axes[3] = {UpAxis::kX, UpAxis::kY, UpAxis::kZ};
  const std::tuple<const char*, double, double> views[6] = {// those of pcl_slim_render -view
                                                            {"front", 0, 0},  {"back", 180, 0},
                                                            {"left", -90, 0}, {"right", 90, 0},
                                                            {"top", 0, 90},   {"bottom", 0, -90}};
  for (std::size_t k = 0; k < 3; ++k) {
    for (const auto& [name, azimuth, elevation] : views) {
      const ViewDirection view = viewFromAngles(axes[k], azimuth, elevation);
      for (const double x : ups[k]) words << ' ' << x;
      words << ' ' << name;
      for (const double x : view.towards_viewer) words << ' ' << x;
      for (const double x : view.up) words << ' ' << x;
    }
  }
  EXPECT_EQ(runScript("views.mjs", words.str()), "");
}

}  // namespace
}  // namespace pcl_slim
