// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/pcl_visualizer.h"

#include <pcl/visualization/pcl_visualizer.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPropCollection.h>
#include <vtkRendererCollection.h>
#include <vtkScalarBarActor.h>
#include <vtkTextProperty.h>

#include "pcl_slim/visualization/polydata.h"
#include "pcl_slim/visualization/splat_mapper.h"
#include "support/colors.h"
#include "visualization/test_window.h"

namespace pcl_slim::test {
namespace {

class PCLVisualizerTest : public ::testing::Test {
 protected:
  PCLVisualizerTest() : viewer("test") {
    viewer.setSize(160, 120);
    viewer.setBackgroundColor(1.0, 1.0, 1.0);
    viewer.setCameraPosition(0.0, 0.0, 1.2, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    viewer.setCameraFieldOfView(0.5236);
    viewer.setCameraClipDistances(0.1, 10.0);
  }

  Image picture() { return pictureOf(viewer.getRenderWindow()); }

  pcl::visualization::PCLVisualizer viewer;
};

TEST_F(PCLVisualizerTest, AddsUpdatesAndRemoves) {
  const Image empty = picture();
  const SLIMSurface sphere = *smallSphere();
  ASSERT_TRUE(addSLIMSurface(viewer, sphere, "sphere"));
  EXPECT_FALSE(addSLIMSurface(viewer, sphere, "sphere"));
  EXPECT_TRUE(viewer.contains("sphere"));
  const Image large = picture();
  EXPECT_GT(shareDifferent(empty, large, 2), 0.2);

  ASSERT_TRUE(updateSLIMSurface(viewer, *smallSphere(0.1), "sphere"));
  EXPECT_FALSE(updateSLIMSurface(viewer, sphere, "another"));
  EXPECT_LT(shareDifferent(empty, picture(), 2), 0.5 * shareDifferent(empty, large, 2));

  ASSERT_TRUE(removeSLIMSurface(viewer, "sphere"));
  EXPECT_FALSE(removeSLIMSurface(viewer, "sphere"));
  EXPECT_FALSE(viewer.contains("sphere"));
  EXPECT_EQ(shareDifferent(empty, picture(), 2), 0.0);
}

TEST_F(PCLVisualizerTest, PropertiesOfShapesWork) {
  using namespace pcl::visualization;
  addSLIMSurface(viewer, *smallSphere(), "sphere");
  const Image opaque = picture();
  ASSERT_TRUE(viewer.setShapeRenderingProperties(PCL_VISUALIZER_OPACITY, 0.4, "sphere"));
  const Image pale = picture();
  EXPECT_GT(pixelOf(pale, 80, 60)[2], pixelOf(opaque, 80, 60)[2]);
  EXPECT_TRUE(viewer.removeShape("sphere"));
}

TEST_F(PCLVisualizerTest, AScalarBarComesAndGoesWithTheMode) {
  addSLIMSurface(viewer, *smallSphere(), "sphere");
  const std::size_t shapes = viewer.getShapeActorMap()->size();
  EXPECT_TRUE(setSLIMSurfaceMode(viewer, DisplayMode::kMean, 8.0, "sphere"));
  EXPECT_EQ(viewer.getShapeActorMap()->size(), shapes + 1);
  EXPECT_EQ(getSLIMMapper(viewer, "sphere")->getRange(), 8.0);
  // The bar stands at the right, where there was white.
  const Image with_bar = picture();
  bool colored = false;
  for (int y = 30; y < 90; ++y) {
    for (int x = 140; x < 160; ++x) {
      const auto p = pixelOf(with_bar, x, y);
      colored = colored || std::abs(p[0] - p[2]) > 60;
    }
  }
  EXPECT_TRUE(colored);
  EXPECT_TRUE(setSLIMSurfaceMode(viewer, DisplayMode::kNormal, 0.0, "sphere"));
  EXPECT_EQ(viewer.getShapeActorMap()->size(), shapes);
  EXPECT_FALSE(setSLIMSurfaceMode(viewer, DisplayMode::kColor, 0.0, "sphere"));
  EXPECT_FALSE(setSLIMSurfaceMode(viewer, DisplayMode::kMean, 0.0, "another"));
  setSLIMSurfaceMode(viewer, DisplayMode::kSize, 0.0, "sphere");
  EXPECT_TRUE(removeSLIMSurface(viewer, "sphere"));
  EXPECT_EQ(viewer.getShapeActorMap()->size(), shapes - 1);
}

/** The text's lightness of the scalar bar of a renderer; -1 without one. */
double barLightness(vtkRenderer* renderer) {
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal();
  while (vtkProp* prop = props->GetNextProp()) {
    if (auto* bar = vtkScalarBarActor::SafeDownCast(prop))
      return bar->GetLabelTextProperty()->GetColor()[1];
  }
  return -1.0;
}

TEST_F(PCLVisualizerTest, AScalarBarIsLegibleInTheViewportOfItsSurface) {
  int left = 0, right = 0;
  viewer.createViewPort(0.0, 0.0, 0.5, 1.0, left);
  viewer.createViewPort(0.5, 0.0, 1.0, 1.0, right);
  viewer.setBackgroundColor(0.0, 0.0, 0.0, left);
  viewer.setBackgroundColor(1.0, 1.0, 0.9, right);
  std::vector<vtkRenderer*> renderers;
  auto all = viewer.getRendererCollection();
  all->InitTraversal();
  while (vtkRenderer* renderer = all->GetNextItem()) renderers.push_back(renderer);
  ASSERT_TRUE(addSLIMSurface(viewer, *smallSphere(), "dark", left));
  ASSERT_TRUE(addSLIMSurface(viewer, *smallSphere(), "light", right));
  const auto at = [&](int viewport) { return renderers[static_cast<std::size_t>(viewport)]; };
  ASSERT_TRUE(setSLIMSurfaceMode(viewer, DisplayMode::kMean, 0.0, "dark"));
  EXPECT_GT(barLightness(at(left)), 0.8);
  EXPECT_EQ(barLightness(at(right)), -1.0);
  ASSERT_TRUE(setSLIMSurfaceMode(viewer, DisplayMode::kMean, 0.0, "light"));
  EXPECT_LT(barLightness(at(right)), 0.2);
  ASSERT_TRUE(setSLIMSurfaceMode(viewer, DisplayMode::kShaded, 0.0, "dark"));
  EXPECT_EQ(barLightness(at(left)), -1.0);
  EXPECT_GE(barLightness(at(right)), 0.0);
}

TEST_F(PCLVisualizerTest, SplatsOfACloud) {
  pcl::PointCloud<pcl::PointSurfel> cloud;
  pcl::PointSurfel surfel{};
  surfel.normal_z = 2.0f;
  surfel.radius = 0.2f;
  surfel.rgba = 0xff0000ffu;
  cloud.push_back(surfel);
  surfel.x = std::numeric_limits<float>::quiet_NaN();
  cloud.push_back(surfel);
  EXPECT_EQ(splatsFrom(cloud).size(), 1u);
  ASSERT_TRUE(addSplats(viewer, cloud, "discs"));
  EXPECT_FALSE(addSplats(viewer, cloud, "discs"));
  // Facing the viewer, it has most of the light.
  EXPECT_GT(pixelOf(picture(), 80, 60)[2], 230);
  vtkActor::SafeDownCast(viewer.getShapeActorMap()->at("discs"))->GetProperty()->LightingOff();
  EXPECT_EQ(pixelOf(picture(), 80, 60), (std::array<int, 3>{0, 0, 255}));
  cloud[0].rgba = 0xff00ff00u;
  ASSERT_TRUE(updateSplats(viewer, cloud, "discs"));
  EXPECT_EQ(pixelOf(picture(), 80, 60), (std::array<int, 3>{0, 255, 0}));
  EXPECT_EQ(getSLIMMapper(viewer, "discs"), nullptr);
  EXPECT_NE(getSplatMapper(viewer, "discs"), nullptr);
  EXPECT_TRUE(removeSplats(viewer, "discs"));
  EXPECT_EQ(pixelOf(picture(), 80, 60), (std::array<int, 3>{255, 255, 255}));
}

TEST(PolyDataTest, HasTheColoursAtCentres) {
  SLIMSurface surface = *smallSphere();
  pcl_slim_test::setRandomColors(surface);
  std::vector<std::uint8_t> sides(surface.size()), texels(12, 40);
  sides[7] = 2;
  texels[0] = 44;  // red of one of four texels about the centre
  surface.setTextures(sides, texels);
  const auto data = toPolyData(surface);
  vtkDataArray* colors = data->GetPointData()->GetScalars();
  EXPECT_EQ(colors->GetComponent(6, 0), surface.colors[6 * kColorBytes]);
  EXPECT_EQ(colors->GetComponent(7, 0), 41.0);
  EXPECT_EQ(colors->GetComponent(7, 1), 40.0);
}

TEST(PolyDataTest, HoldsEverySurfelInWorldUnits) {
  SLIMSurface surface = *smallSphere();
  surface.info.origin = {500000.0, 0.0, 0.0};
  surface.info.scale = 2.0;
  surface.flags[3] = 0;
  const auto data = toPolyData(surface);
  ASSERT_EQ(data->GetNumberOfPoints(), 600);
  EXPECT_EQ(data->GetNumberOfVerts(), 600);
  EXPECT_EQ(data->GetPoint(5)[0], 500000.0 + 2.0 * surface.cx[5]);
  EXPECT_FLOAT_EQ(data->GetPointData()->GetArray("radius")->GetTuple1(5), 2.0f * surface.radius[5]);
  EXPECT_FLOAT_EQ(data->GetPointData()->GetArray("c3")->GetTuple1(5), surface.coefficientsOf(5)[3]);
  EXPECT_FLOAT_EQ(data->GetPointData()->GetNormals()->GetComponent(5, 2), surface.nz[5]);
  EXPECT_EQ(toPolyData(surface, true)->GetNumberOfPoints(), 599);
  EXPECT_EQ(toPolyData(SplatSet())->GetNumberOfPoints(), 0);
}

}  // namespace
}  // namespace pcl_slim::test
