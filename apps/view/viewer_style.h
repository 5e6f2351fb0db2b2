// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkInteractorStyleTrackballCamera.h>

#include <functional>
#include <string>

namespace pcl_slim {

/** \brief VTK's trackball, which reports keys, moves, sizes and time instead of what VTK does
 * with them. */
class ViewerStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static ViewerStyle* New();
  vtkTypeMacro(ViewerStyle, vtkInteractorStyleTrackballCamera)

  std::function<void(const std::string& symbol)> on_key;
  std::function<void()> on_move, on_resize, on_timer;

  void OnChar() override {}
  void OnKeyPress() override;
  void OnMouseMove() override;
  void OnConfigure() override;
  /** \brief Nothing but on_timer(): VTK's own would turn the camera on, by the last move of the mouse,
   * at every tick while a button is down. */
  void OnTimer() override;
};

}  // namespace pcl_slim
