// SPDX-License-Identifier: BSD-3-Clause
#include "view/controls.h"

#include <gtest/gtest.h>
#include <vtkActor2D.h>
#include <vtkNew.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include <array>
#include <cstring>

namespace pcl_slim::test {
namespace {

/** \brief The text of a renderer that contains certain words; the last one drawn. */
vtkTextActor* textWith(vtkRenderer* renderer, const char* words) {
  vtkTextActor* found = nullptr;
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal();
  while (vtkProp* prop = props->GetNextProp()) {
    auto* text = vtkTextActor::SafeDownCast(prop);
    if (text && text->GetInput() && std::strstr(text->GetInput(), words)) found = text;
  }
  return found;
}

// Cut off at the right of windows narrower than 690 pixels, it was no help.
TEST(OverlayTest, HelpAndReadoutFitIntoTheWindow) {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->AddRenderer(renderer);
  Overlay overlay(renderer);
  overlay.showHelp(true);
  overlay.setReadout(
      "leaf 15317  level 6  degree 4  ball radius 0.00389  error 1.2e-05  points 23");
  for (const auto& [width, height] : {std::array{800, 600}, {480, 400}, {400, 300}, {1000, 350}}) {
    window->SetSize(width, height);
    window->Render();
    overlay.fitTo(width, height);
    for (const char* words : {"quit", "degree"}) {
      vtkTextActor* text = textWith(renderer, words);
      ASSERT_TRUE(text) << words;
      double box[4]{};
      text->GetBoundingBox(renderer, box);
      const double left = text->GetPositionCoordinate()->GetValue()[0] * width + box[0];
      EXPECT_GE(left, 0.0) << words << " " << width;
      EXPECT_LE(left + box[1] - box[0], width) << words << " " << width;
      EXPECT_LT(box[3] - box[2], height) << words << " " << height;
      EXPECT_GT(box[1] - box[0], 0.4 * width) << words << " " << width;  // and is read easily
    }
  }
}

TEST(OverlayTest, TextGrowsWithTheWindow) {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->AddRenderer(renderer);
  Overlay overlay(renderer);
  overlay.setStatus("5000 leaves");
  overlay.setProgress(0.5f, "covering");
  for (const char* words : {"5000 leaves", "covering", "quit"}) {
    double small[4]{}, large[4]{};
    window->SetSize(800, 600);
    overlay.fitTo(800, 600);
    textWith(renderer, words)->GetBoundingBox(renderer, small);
    window->SetSize(2400, 1800);
    overlay.fitTo(2400, 1800);
    textWith(renderer, words)->GetBoundingBox(renderer, large);
    const double growth =
        (large[3] - large[2]) / (small[3] - small[2]);  // of boxes with their rims
    EXPECT_GT(growth, 2.3) << words;
    EXPECT_LT(growth, 3.3) << words;
  }
}

TEST(OverlayTest, HelpIsDrawnOverWhatWasAddedLater) {
  vtkNew<vtkRenderer> renderer;
  Overlay overlay(renderer);
  vtkNew<vtkActor2D> bar;
  renderer->AddActor2D(bar);
  vtkPropCollection* props = renderer->GetViewProps();
  EXPECT_EQ(props->GetLastProp(), bar.Get());
  overlay.raise();
  EXPECT_EQ(props->GetLastProp(), textWith(renderer, "quit"));
}

}  // namespace
}  // namespace pcl_slim::test
