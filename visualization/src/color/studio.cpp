// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/studio.h"

#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>

#include <array>
#include <cmath>

#include "pcl_slim/render/detail/light.h"

namespace pcl_slim {

using namespace detail;
namespace {

void addLight(vtkRenderer* renderer, const std::array<double, 3>& position, double intensity) {
  vtkNew<vtkLight> light;
  light->SetLightTypeToCameraLight();
  light->SetPosition(position.data());
  light->SetFocalPoint(0.0, 0.0, 0.0);
  light->SetIntensity(intensity);
  renderer->AddLight(light);
}

/** \brief The background's colour at a share of its height from the top. */
std::array<double, 3> paperAt(double from_top) {
  const double level = kPaper[0] - kPaper[1] * from_top * from_top;
  return {level, level, level + kPaper[2]};
}

}  // namespace

void setClayLook(vtkProperty* property) {
  property->SetColor(kClay[0], kClay[1], kClay[2]);
  property->SetAmbient(0.22);
  property->SetDiffuse(0.9);
  property->SetSpecular(0.18);
  property->SetSpecularColor(1.0, 1.0, 1.0);
  property->SetSpecularPower(kShinePower);
}

void setStudioLights(vtkRenderer* renderer) {
  renderer->RemoveAllLights();
  renderer->AutomaticLightCreationOff();
  addLight(renderer, {0.0, 0.0, 1.0}, 0.35);
  addLight(renderer, {kKeyLight[0], kKeyLight[1], -kKeyLight[2]}, 0.68);
}

void setStudioBackground(vtkRenderer* renderer) {
  constexpr int kColumns = 2, kRows = 512;  // VTK turns an image of one column over
  vtkNew<vtkImageData> rows;
  rows->SetDimensions(kColumns, kRows, 1);
  rows->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < kRows; ++y) {
    const std::array<double, 3> color = paperAt(1.0 - (y + 0.5) / kRows);
    auto* row = static_cast<unsigned char*>(rows->GetScalarPointer(0, y, 0));
    for (std::size_t k = 0; k < 3 * kColumns; ++k) {
      row[k] = static_cast<unsigned char>(std::lround(255.0 * color[k % 3]));
    }
  }
  vtkNew<vtkTexture> texture;
  texture->SetInputData(rows);
  texture->InterpolateOn();
  texture->RepeatOff();
  texture->EdgeClampOn();
  renderer->SetBackgroundTexture(texture);
  renderer->TexturedBackgroundOn();
  // For callers that read how light the renderer is, and for windows that have no textures.
  renderer->GradientBackgroundOn();
  renderer->SetBackground(paperAt(1.0).data());
  renderer->SetBackground2(paperAt(0.0).data());
}

}  // namespace pcl_slim
