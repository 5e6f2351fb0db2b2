// SPDX-License-Identifier: BSD-3-Clause
// The window's words and its scale: digits, units, round numbers.
#include "view/readout.h"

#include <vtkDoubleArray.h>
#include <vtkPropCollection.h>
#include <vtkScalarBarActor.h>
#include <vtkScalarsToColors.h>

#include <cstdio>
#include <string>
#include <vector>

#include "pcl_slim/visualization/scalar_bar.h"
#include "view/scene.h"
#include "visualization/test_window.h"

namespace pcl_slim::test {
namespace {

/** \brief A sphere of 250 m in map coordinates, seen from the south. */
class ReadoutTest : public WindowTest {
 protected:
  ReadoutTest() : scene(renderer) {
    auto sphere = std::make_shared<SLIMSurface>(*smallSphere());
    sphere->info.origin = {500000.0, 4500000.0, 300.0};
    sphere->info.scale = 1024.0;
    scene.setSurface(sphere);
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetFocalPoint(500000.0, 4500000.0, 300.0);
    camera->SetPosition(500000.0, 4500000.0 - 1228.8, 300.0);
    camera->SetViewUp(0.0, 0.0, 1.0);
    camera->SetClippingRange(100.0, 10000.0);
    picture();
  }

  Scene scene;
};

TEST_F(ReadoutTest, PlacesHaveTheDigitsOfTheObjectNotOfItsPlace) {
  const std::string text = describeUnder(scene, renderer, 80, 60);
  const std::size_t at = text.find("at ");
  ASSERT_NE(at, std::string::npos) << text;
  double x = 0.0, y = 0.0, z = 0.0;
  ASSERT_EQ(std::sscanf(text.c_str() + at, "at %lf %lf %lf", &x, &y, &z), 3) << text;
  EXPECT_NEAR(y, 4500000.0 - 256.0, 1.0);
  // 900 m across: centimetres.
  const std::size_t point = text.find("4499", at);
  EXPECT_EQ(text.find(' ', point) - text.find('.', point), 3u) << text;
  EXPECT_EQ(describeUnder(scene, renderer, 2, 2), "");
}

TEST_F(ReadoutTest, NamesTheUnitOfLength) {
  EXPECT_EQ(describeUnder(scene, renderer, 80, 60).find(" m"), std::string::npos);
  scene.setUnit("m");
  const std::string text = describeUnder(scene, renderer, 80, 60);
  for (const char* words : {" 1/m ", " 1/m²", " m   normal", " m  error"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words << " in " << text;
  }
  scene.setMode(DisplayMode::kGauss, 0.25);
  EXPECT_NE(describeScene(scene).find("Gaussian curvature within 0.25 1/m²"), std::string::npos)
      << describeScene(scene);
}

/** \brief The scale that a renderer shows. */
vtkScalarBarActor* scaleIn(vtkRenderer* renderer) {
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal();
  while (vtkProp* prop = props->GetNextProp()) {
    if (auto* bar = vtkScalarBarActor::SafeDownCast(prop)) return bar;
  }
  return nullptr;
}

std::vector<double> labelsOf(vtkScalarBarActor* bar) {
  std::vector<double> labels;
  for (vtkIdType i = 0; i < bar->GetCustomLabels()->GetNumberOfTuples(); ++i) {
    labels.push_back(bar->GetCustomLabels()->GetValue(i));
  }
  return labels;
}

TEST_F(ReadoutTest, TheScaleHasRoundNumbersOfTheRangeThatIsSet) {
  scene.setUnit("mm");
  scene.setMode(DisplayMode::kMean, 94.9);
  picture();
  vtkScalarBarActor* bar = scaleIn(renderer);
  ASSERT_TRUE(bar);
  EXPECT_STREQ(bar->GetTitle(), "mean\ncurvature\n1/mm");
  EXPECT_EQ(labelsOf(bar), (std::vector<double>{-50.0, 0.0, 50.0}));
  scene.mapper()->setRange(2.3);
  picture();
  EXPECT_EQ(labelsOf(bar), (std::vector<double>{-2.0, -1.0, 0.0, 1.0, 2.0}));
  scene.setMode(DisplayMode::kLevel, 0.0);
  picture();
  EXPECT_EQ(labelsOf(scaleIn(renderer)), (std::vector<double>{1.0, 2.0, 3.0}));
  scene.setMode(DisplayMode::kShaded, 0.0);
  EXPECT_FALSE(scaleIn(renderer));
}

}  // namespace
}  // namespace pcl_slim::test
