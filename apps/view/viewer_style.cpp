// SPDX-License-Identifier: BSD-3-Clause
#include "view/viewer_style.h"

#include <vtkObjectFactory.h>
#include <vtkRenderWindowInteractor.h>

namespace pcl_slim {

vtkStandardNewMacro(ViewerStyle)

void
ViewerStyle::OnKeyPress()
{
  if (on_key) on_key(Interactor->GetKeySym());
}

void
ViewerStyle::OnMouseMove()
{
  Superclass::OnMouseMove();
  if (on_move) on_move();
}

void
ViewerStyle::OnConfigure()
{
  Superclass::OnConfigure();
  if (on_resize) on_resize();
}

void
ViewerStyle::OnTimer()
{
  if (on_timer) on_timer();
}

}  // namespace pcl_slim
