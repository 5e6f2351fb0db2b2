// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/scalar_bar.h"

#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkScalarsToColors.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pcl_slim/render/detail/bar_text.h"
#include "pcl_slim/render/detail/ticks.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim {

using namespace detail;
namespace {

void setTextLook(vtkTextProperty* text, int size, bool bold) {
  text->SetFontFamilyToArial();
  text->SetFontSize(size);
  text->SetColor(0.12, 0.13, 0.15);
  text->SetBold(bold);
  text->SetItalic(false);
  text->SetShadow(false);
}

/** \brief A number in the middle of each level's colour, at most ten of them. */
std::vector<double> levelTicks(const double* range) {
  const int first = static_cast<int>(std::lround(range[0] + 0.5));
  const int last = static_cast<int>(std::lround(range[1] - 0.5));
  const int step = 1 + (last - first) / 10;
  std::vector<double> ticks;
  for (int level = first; level <= last; level += step) ticks.push_back(level);
  return ticks;
}

/** \brief A bar whose ticks are round numbers of the range that its table has just now. */
class RoundScalarBar : public vtkScalarBarActor {
 public:
  static RoundScalarBar* New();
  vtkTypeMacro(RoundScalarBar, vtkScalarBarActor)

  void setMode(DisplayMode mode) { mode_ = mode; }

  int RenderOverlay(vtkViewport* viewport) override {
    setTicks();
    return Superclass::RenderOverlay(viewport);
  }
  int RenderOpaqueGeometry(vtkViewport* viewport) override {
    setTicks();
    return Superclass::RenderOpaqueGeometry(viewport);
  }

 private:
  std::vector<double> numberTicks(const double* range) const {
    constexpr double kAlike = 3e-3;  // share of a number within which one is enough
    const double middle = 0.5 * (range[0] + range[1]);
    if (range[1] - range[0] < kAlike * std::abs(middle)) return {middle};
    return roundTicks(range[0], range[1], mode_ == DisplayMode::kSize);
  }

  void setTicks() {
    const double* range = GetLookupTable()->GetRange();
    if (GetUseCustomLabels() && range[0] == range_[0] && range[1] == range_[1]) return;
    range_ = {range[0], range[1]};
    vtkNew<vtkDoubleArray> labels;
    const auto ticks = mode_ == DisplayMode::kLevel ? levelTicks(range) : numberTicks(range);
    for (const double tick : ticks) labels->InsertNextValue(tick);
    SetCustomLabels(labels);
    UseCustomLabelsOn();
  }

  DisplayMode mode_ = DisplayMode::kMean;
  std::array<double, 2> range_{};
};

vtkStandardNewMacro(RoundScalarBar)

}  // namespace

std::string titleOf(DisplayMode mode) {
  if (showsNumbers(mode)) return barTitle(*shadingModeOf(nameOf(mode)));
  return mode == DisplayMode::kReflection ? "reflection lines"
         : mode == DisplayMode::kColor    ? "colour"
                                          : nameOf(mode);
}

std::string unitOf(DisplayMode mode, const std::string& length) {
  const bool is_length = mode == DisplayMode::kSize || mode == DisplayMode::kError;
  if (!showsNumbers(mode) || (is_length && length.empty())) return "";
  return barUnit(*shadingModeOf(nameOf(mode)), length);
}

vtkSmartPointer<vtkScalarBarActor> makeScalarBar(GBufferMapper& mapper, const std::string& unit) {
  auto bar = vtkSmartPointer<RoundScalarBar>::New();
  const DisplayMode mode = mapper.getMode();
  vtkScalarsToColors* table = mapper.GetLookupTable();
  const std::string shown_unit = unitOf(mode, unit);
  std::string title = titleOf(mode) + (shown_unit.empty() ? "" : "\n" + shown_unit);
  // A word a line, so that the title fits next to the picture in small windows, too.
  std::replace(title.begin(), title.end(), ' ', '\n');
  bar->SetLookupTable(table);
  bar->SetTitle(title.c_str());
  bar->setMode(mode);
  bar->SetLabelFormat("%g");
  bar->SetMaximumNumberOfColors(256);
  bar->SetOrientationToVertical();
  bar->SetPosition(0.87, 0.2);
  bar->SetWidth(0.12);
  bar->SetHeight(0.6);
  bar->SetBarRatio(0.22);
  bar->SetUnconstrainedFontSize(true);
  setTextLook(bar->GetTitleTextProperty(), 13, true);
  setTextLook(bar->GetLabelTextProperty(), 13, false);
  bar->SetVerticalTitleSeparation(10);
  return bar;
}

void contrastWith(vtkRenderer* renderer, vtkScalarBarActor* bar) {
  double light = 0.0;  // as the eye weighs colours, of both ends of a gradient
  for (const double* color :
       {renderer->GetBackground(), renderer->GetGradientBackground() ? renderer->GetBackground2()
                                                                     : renderer->GetBackground()}) {
    light += 0.5 * (0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]);
  }
  for (vtkTextProperty* text : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    if (light < 0.5)
      text->SetColor(0.95, 0.95, 0.93);
    else
      text->SetColor(0.12, 0.13, 0.15);
  }
}

void setLetters(vtkScalarBarActor* bar, int pixels) {
  bar->GetTitleTextProperty()->SetFontSize(pixels);
  bar->GetLabelTextProperty()->SetFontSize(pixels);
}

}  // namespace pcl_slim
