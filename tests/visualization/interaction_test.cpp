// SPDX-License-Identifier: BSD-3-Clause
// The mouse, through VTK's own events: what it turns, and how fine frames are meanwhile.
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkRenderWindowInteractor.h>

#include "visualization/test_window.h"

namespace pcl_slim::test {
namespace {

class InteractionTest : public WindowTest {
 protected:
  InteractionTest() {
    interactor->SetRenderWindow(window);
    interactor->SetInteractorStyle(style);
    addSphere();
    mapper->setMode(DisplayMode::kNormal);
    picture();
    interactor->Initialize();
  }

  void press(int x, int y) { send(vtkCommand::LeftButtonPressEvent, x, y); }
  void move(int x, int y) { send(vtkCommand::MouseMoveEvent, x, y); }
  void release(int x, int y) { send(vtkCommand::LeftButtonReleaseEvent, x, y); }

  vtkNew<vtkRenderWindowInteractor> interactor;
  vtkNew<vtkInteractorStyleTrackballCamera> style;

 private:
  void send(unsigned long event, int x, int y) {
    interactor->SetEventInformation(x, y);
    interactor->InvokeEvent(event, nullptr);
  }
};

TEST_F(InteractionTest, TheMouseTurnsTheSurface) {
  const Image before = picture();
  press(80, 60);
  move(110, 70);
  release(110, 70);
  EXPECT_GT(shareDifferent(before, picture(), 2), 0.1);
  EXPECT_FALSE(mapper->getError());
}

TEST_F(InteractionTest, FramesAreCoarserWhileTheMouseMovesAndFineAfterwards) {
  mapper->setFrameBudget(1e-6);
  press(80, 60);
  move(90, 60);
  EXPECT_EQ(mapper->getStatistics().coarseness, 4);
  const Image coarse = picture();
  release(90, 60);
  EXPECT_EQ(mapper->getStatistics().coarseness, 1);
  const Image fine = picture();
  // The coarse frame shows the same sphere: its silhouette is off by a pixel or two.
  EXPECT_GT(shareDifferent(coarse, fine, 0), 0.0);
  EXPECT_LT(shareDifferent(coarse, fine, 8), 0.03);

  mapper->setFrameBudget(0.0);
  press(90, 60);
  move(100, 60);
  EXPECT_EQ(mapper->getStatistics().coarseness, 1);
  release(100, 60);
}

TEST_F(InteractionTest, AFineFrameServesAPressedButtonThatDoesNotMove) {
  mapper->setFrameBudget(1e-6);
  const auto rasterized = mapper->getStatistics().rasterized;
  press(80, 60);
  window->Render();
  EXPECT_EQ(mapper->getStatistics().rasterized, rasterized);
  release(80, 60);
}

}  // namespace
}  // namespace pcl_slim::test
