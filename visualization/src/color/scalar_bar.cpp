// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/scalar_bar.h"

#include <vtkDoubleArray.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkScalarsToColors.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim {
namespace {

void setTextLook(vtkTextProperty* text, int size, bool bold) {
  text->SetFontFamilyToArial();
  text->SetFontSize(size);
  text->SetColor(0.12, 0.13, 0.15);
  text->SetBold(bold);
  text->SetItalic(false);
  text->SetShadow(false);
}

std::string unitOf(DisplayMode mode, const std::string& unit) {
  if (mode == DisplayMode::kSize || mode == DisplayMode::kError) return unit;
  if (!showsCurvature(mode)) return "";
  return "1/" + (unit.empty() ? "length" : unit) + (mode == DisplayMode::kGauss ? "^2" : "");
}

/** \brief A number in the middle of each level's colour, at most ten of them. */
void labelLevels(const double* range, vtkScalarBarActor* bar) {
  const int first = static_cast<int>(std::lround(range[0] + 0.5));
  const int last = static_cast<int>(std::lround(range[1] - 0.5));
  const int step = 1 + (last - first) / 10;
  vtkNew<vtkDoubleArray> labels;
  for (int level = first; level <= last; level += step) labels->InsertNextValue(level);
  bar->SetCustomLabels(labels);
  bar->SetUseCustomLabels(true);
  bar->SetLabelFormat("%-2.0f");
}

void addLight(vtkRenderer* renderer, double x, double y, double z, double intensity) {
  vtkNew<vtkLight> light;
  light->SetLightTypeToCameraLight();
  light->SetPosition(x, y, z);
  light->SetFocalPoint(0.0, 0.0, 0.0);
  light->SetIntensity(intensity);
  renderer->AddLight(light);
}

}  // namespace

std::string titleOf(DisplayMode mode) {
  switch (mode) {
    case DisplayMode::kMean: return "mean curvature";
    case DisplayMode::kGauss: return "Gaussian curvature";
    case DisplayMode::kMax: return "largest curvature";
    case DisplayMode::kMin: return "smallest curvature";
    case DisplayMode::kLevel: return "level";
    case DisplayMode::kSize: return "radius";
    case DisplayMode::kError: return "residual";
    case DisplayMode::kReflection: return "reflection lines";
    case DisplayMode::kColor: return "colour";
    default: return nameOf(mode);
  }
}

vtkSmartPointer<vtkScalarBarActor> makeScalarBar(GBufferMapper& mapper, const std::string& unit) {
  auto bar = vtkSmartPointer<vtkScalarBarActor>::New();
  const DisplayMode mode = mapper.getMode();
  vtkScalarsToColors* table = mapper.GetLookupTable();
  const std::string shown_unit = unitOf(mode, unit);
  std::string title = titleOf(mode) + (shown_unit.empty() ? "" : "\n" + shown_unit);
  // A word a line, so that the title fits next to the picture in small windows, too.
  std::replace(title.begin(), title.end(), ' ', '\n');
  bar->SetLookupTable(table);
  bar->SetTitle(title.c_str());
  if (mode == DisplayMode::kLevel) {
    labelLevels(table->GetRange(), bar);
  } else {
    bar->SetNumberOfLabels(5);
    bar->SetLabelFormat("%.3g");
  }
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

void setClayLook(vtkProperty* property) {
  property->SetColor(0.80, 0.74, 0.66);
  property->SetAmbient(0.22);
  property->SetDiffuse(0.9);
  property->SetSpecular(0.18);
  property->SetSpecularColor(1.0, 1.0, 1.0);
  property->SetSpecularPower(40.0);
}

void setStudioLights(vtkRenderer* renderer) {
  renderer->RemoveAllLights();
  renderer->AutomaticLightCreationOff();
  addLight(renderer, 0.0, 0.0, 1.0, 0.35);
  addLight(renderer, -0.55, 0.75, 0.65, 0.68);
}

}  // namespace pcl_slim
