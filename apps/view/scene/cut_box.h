// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>

#include <array>
#include <functional>
#include <vector>

#include "pcl_slim/render/render_params.h"

class vtkBoxRepresentation;
class vtkBoxWidget2;
class vtkRenderWindowInteractor;

namespace pcl_slim {

/** \brief A box in a window whose sides and place the mouse drags by their handles: everything outside is
 * to be cut away. */
class CutBox {
 public:
  /** \param[in] dragged called whenever the mouse has moved the box */
  explicit CutBox(const std::function<void()>& dragged);
  ~CutBox();

  /** \brief Shows it in an interactor's window. \param[in] bounds x0, x1, y0, y1, z0, z1 that it starts
   * from, and which size its handles */
  void show(vtkRenderWindowInteractor* interactor, const std::array<double, 6>& bounds);
  void hide();
  bool shown() const;

  /** \brief The half spaces that its sides bound, world coordinates. */
  std::vector<HalfSpace> sides() const;

 private:
  std::function<void()> dragged_;
  vtkNew<vtkBoxWidget2> widget_;
  vtkNew<vtkBoxRepresentation> box_;
};

}  // namespace pcl_slim
