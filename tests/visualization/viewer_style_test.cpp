// SPDX-License-Identifier: BSD-3-Clause
#include "view/controls.h"

#include <gtest/gtest.h>
#include <vtkCamera.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <array>

namespace pcl_slim::test {
namespace {

TEST(ViewerStyleTest, TheMouseTurnsTheCameraAndTimeDoesNot) {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetSize(200, 150);
  window->AddRenderer(renderer);
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(window);
  vtkNew<ViewerStyle> style;
  int ticks = 0, moves = 0;
  style->on_timer = [&] { ++ticks; };
  style->on_move = [&] { ++moves; };
  interactor->SetInteractorStyle(style);
  interactor->Initialize();
  window->Render();

  const auto position = [&] {
    std::array<double, 3> at{};
    renderer->GetActiveCamera()->GetPosition(at.data());
    return at;
  };
  const auto begin = position();
  interactor->SetEventInformation(100, 75);
  interactor->InvokeEvent(vtkCommand::LeftButtonPressEvent);
  interactor->SetEventInformation(120, 75);
  interactor->InvokeEvent(vtkCommand::MouseMoveEvent);
  const auto turned = position();
  EXPECT_NE(turned, begin);
  for (int i = 0; i < 5; ++i) interactor->InvokeEvent(vtkCommand::TimerEvent);
  EXPECT_EQ(position(), turned);  // the button is down, the mouse rests
  interactor->InvokeEvent(vtkCommand::LeftButtonReleaseEvent);
  EXPECT_EQ(ticks, 5);
  EXPECT_EQ(moves, 1);
}

}  // namespace
}  // namespace pcl_slim::test
