// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene/cut_box.h"

#include <vtkBoxRepresentation.h>
#include <vtkBoxWidget2.h>
#include <vtkCallbackCommand.h>
#include <vtkPlane.h>
#include <vtkPlanes.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>

namespace pcl_slim {
namespace {

void
onDragged(vtkObject*, unsigned long, void* dragged, void*)
{
  (*static_cast<std::function<void()>*>(dragged))();
}

}  // namespace

CutBox::CutBox(const std::function<void()>& dragged) : dragged_(dragged)
{
  box_->SetPlaceFactor(1.0);
  box_->InsideOutOn();
  box_->GetOutlineProperty()->SetColor(0.25, 0.3, 0.4);
  box_->GetSelectedOutlineProperty()->SetColor(0.85, 0.35, 0.1);
  box_->GetHandleProperty()->SetColor(0.25, 0.3, 0.4);
  box_->GetSelectedHandleProperty()->SetColor(0.85, 0.35, 0.1);
  box_->GetFaceProperty()->SetOpacity(0.0);
  box_->GetSelectedFaceProperty()->SetOpacity(0.0);
  widget_->SetRepresentation(box_);
  widget_->SetKeyPressActivation(0);
  widget_->RotationEnabledOff();
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(onDragged);
  command->SetClientData(&dragged_);
  widget_->AddObserver(vtkCommand::InteractionEvent, command);
}

CutBox::~CutBox() = default;

void
CutBox::show(vtkRenderWindowInteractor* interactor, const std::array<double, 6>& bounds)
{
  std::array<double, 6> place = bounds;
  box_->PlaceWidget(place.data());
  widget_->SetInteractor(interactor);
  widget_->On();
}

void
CutBox::hide()
{
  widget_->Off();
}

bool
CutBox::shown() const
{
  return const_cast<vtkBoxWidget2*>(widget_.Get())->GetEnabled() != 0;
}

std::vector<HalfSpace>
CutBox::sides() const
{
  vtkNew<vtkPlanes> planes;
  const_cast<vtkBoxRepresentation*>(box_.Get())->GetPlanes(planes);
  std::vector<HalfSpace> sides;
  for (int i = 0; i < planes->GetNumberOfPlanes(); ++i) {
    vtkPlane* const plane = planes->GetPlane(i);
    const double *n = plane->GetNormal(), *p = plane->GetOrigin();
    sides.push_back({{n[0], n[1], n[2]}, n[0] * p[0] + n[1] * p[1] + n[2] * p[2]});
  }
  return sides;
}

}  // namespace pcl_slim
