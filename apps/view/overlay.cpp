// SPDX-License-Identifier: BSD-3-Clause
#include "view/overlay.h"

#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "view/key_table.h"

namespace pcl_slim {
namespace {

void
place(vtkTextActor* actor, double x, double y, int horizontal, int vertical)
{
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->GetPositionCoordinate()->SetValue(x, y);
  actor->GetTextProperty()->SetJustification(horizontal);
  actor->GetTextProperty()->SetVerticalJustification(vertical);
}

void
setText(vtkTextActor* actor, const std::string& text)
{
  actor->SetInput(text.c_str());
  actor->SetVisibility(!text.empty());
}

}  // namespace

Overlay::Overlay(vtkRenderer* renderer)
    : status_(addText(renderer, 14)),
      readout_(addText(renderer, 14)),
      progress_(addText(renderer, 16)),
      help_(addText(renderer, 14))
{
  place(status_, 0.012, 0.985, VTK_TEXT_LEFT, VTK_TEXT_TOP);
  place(readout_, 0.012, 0.015, VTK_TEXT_LEFT, VTK_TEXT_BOTTOM);
  place(progress_, 0.5, 0.08, VTK_TEXT_CENTERED, VTK_TEXT_BOTTOM);
  place(help_, 0.5, 0.5, VTK_TEXT_CENTERED, VTK_TEXT_CENTERED);
  help_->GetTextProperty()->SetFontFamilyToCourier();
  help_->GetTextProperty()->SetJustificationToLeft();
  help_->GetPositionCoordinate()->SetValue(0.1, 0.5);
  help_->GetTextProperty()->SetBackgroundOpacity(0.88);
  help_->GetTextProperty()->SetFrame(true);
  help_->GetTextProperty()->SetFrameColor(0.6, 0.6, 0.62);
  help_->SetInput(helpText().c_str());
}

Overlay::~Overlay() = default;

vtkSmartPointer<vtkTextActor>
Overlay::addText(vtkRenderer* renderer, int size)
{
  auto actor = vtkSmartPointer<vtkTextActor>::New();
  vtkTextProperty* look = actor->GetTextProperty();
  look->SetFontFamilyToArial();
  look->SetFontSize(size);
  look->SetColor(0.12, 0.13, 0.15);
  look->SetBackgroundColor(1.0, 1.0, 1.0);
  look->SetBackgroundOpacity(0.6);
  actor->SetVisibility(false);
  renderer->AddActor2D(actor);
  return actor;
}

void
Overlay::setStatus(const std::string& text)
{
  setText(status_, text);
}

void
Overlay::setReadout(const std::string& text)
{
  setText(readout_, text);
}

void
Overlay::setProgress(float fraction, const std::string& stage)
{
  if (fraction < 0.0f) return setText(progress_, "");
  constexpr int kWidth = 30;
  const int filled = std::clamp(static_cast<int>(std::lround(fraction * kWidth)), 0, kWidth);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '|') +
                          std::string(static_cast<std::size_t>(kWidth - filled), '.');
  const int percent = static_cast<int>(std::lround(100.0f * fraction));
  setText(progress_, "Fitting: " + stage + "\n" + bar + "  " + std::to_string(percent) + " %");
}

void
Overlay::showHelp(bool shown)
{
  help_->SetVisibility(shown);
}

bool
Overlay::helpShown() const
{
  return help_->GetVisibility() != 0;
}

}  // namespace pcl_slim
