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

constexpr int kLetter = 14;        ///< pixels, in a window that has room for it
constexpr int kSmallest = 6;       ///< that can be read
constexpr double kWidest = 560.0;  ///< pixels that the readout takes

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
    : renderer_(renderer),
      status_(addText(renderer, kLetter)),
      readout_(addText(renderer, kLetter)),
      progress_(addText(renderer, 16)),
      help_(addText(renderer, kLetter))
{
  place(status_, 0.012, 0.985, VTK_TEXT_LEFT, VTK_TEXT_TOP);
  place(readout_, 0.012, 0.015, VTK_TEXT_LEFT, VTK_TEXT_BOTTOM);
  place(progress_, 0.5, 0.08, VTK_TEXT_CENTERED, VTK_TEXT_BOTTOM);
  place(help_, 0.0, 0.5, VTK_TEXT_LEFT, VTK_TEXT_CENTERED);
  for (vtkTextActor* text : {status_.Get(), readout_.Get()}) {
    text->GetTextProperty()->SetLineSpacing(1.25);
  }
  help_->GetTextProperty()->SetFontFamilyToCourier();
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

double
Overlay::letterScale(int width, int height)
{
  constexpr double kHeight = 600.0;  // of a window whose letters are kLetter
  return std::min(std::max(1.0, height / kHeight), width / kWidest);
}

void
Overlay::fitTo(int width, int height)
{
  const double scale = letterScale(width, height);
  const int letter = std::max(kSmallest, static_cast<int>(kLetter * scale));
  for (vtkTextActor* text : {status_.Get(), readout_.Get()})
    text->GetTextProperty()->SetFontSize(letter);
  progress_->GetTextProperty()->SetFontSize(std::max(kSmallest, static_cast<int>(16 * scale)));
  double box[4]{};
  const auto widthAt = [&](int size) {
    help_->GetTextProperty()->SetFontSize(size);
    help_->GetBoundingBox(renderer_, box);
    return box[1] - box[0];
  };
  int size = std::max(kLetter, letter);
  while (widthAt(size) > 0.96 * width || box[3] - box[2] > 0.9 * height) {
    if (--size < kSmallest) break;
  }
  help_->GetPositionCoordinate()->SetValue(0.5 - 0.5 * (box[1] - box[0]) / width, 0.5);
}

void
Overlay::raise()
{
  renderer_->RemoveViewProp(help_);
  renderer_->AddViewProp(help_);
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
