// SPDX-License-Identifier: BSD-3-Clause
#include "view/readout.h"

#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "pcl_slim/render/image.h"
#include "pcl_slim/visualization/scalar_bar.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "pcl_slim/visualization/splat_mapper.h"

namespace pcl_slim {
namespace {

template <typename... Values>
std::string
print(const char* format, Values... values)
{
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::string
describePick(const SurfacePick& pick)
{
  return print("leaf %u  level %d  degree %d  ball radius %.4g  error %.3g  points %.0f\n",
               pick.surfel, pick.level, pick.degree, pick.radius, pick.error,
               pick.effective_count) +
         print("mean %.4g  Gauss %.4g  k_max %.4g  k_min %.4g\n", pick.mean, pick.gauss, pick.k_max,
               pick.k_min) +
         print("at %.7g %.7g %.7g  normal %.3f %.3f %.3f", pick.position[0], pick.position[1],
               pick.position[2], pick.normal[0], pick.normal[1], pick.normal[2]);
}

std::string
describeSplat(const SplatSet& splats, std::size_t i)
{
  const std::uint32_t rgb = splats.rgb[i];
  return print("splat %zu  radius %.4g  colour %u %u %u\n", i, double{splats.radius[i]},
               (rgb >> 16) & 255, (rgb >> 8) & 255, rgb & 255) +
         print("at %.7g %.7g %.7g  normal %.3f %.3f %.3f", splats.origin[0] + splats.x[i],
               splats.origin[1] + splats.y[i], splats.origin[2] + splats.z[i], double{splats.nx[i]},
               double{splats.ny[i]}, double{splats.nz[i]});
}

}  // namespace

std::string
describeScene(const Scene& scene)
{
  GBufferMapper* mapper = scene.mapper();
  if (!mapper) return "h: help";
  std::string text;
  if (const SLIMMapper* surface = scene.surfaceMapper()) {
    text = std::to_string(surface->getSurface()->numLeaves()) + " leaves";
  } else {
    text = std::to_string(static_cast<SplatMapper*>(mapper)->getSplats()->size()) + " splats";
  }
  text += "   " + titleOf(mapper->getMode());
  if (takesRange(mapper->getMode())) text += print(" within %.4g", mapper->getRange());
  return text + "   h: help";
}

std::string
describeUnder(const Scene& scene, vtkRenderer* renderer, int x, int y)
{
  if (SLIMMapper* surface = scene.surfaceMapper()) {
    SurfacePick pick;
    return surface->pick(renderer, scene.model(), x, y, pick) ? describePick(pick) : "";
  }
  GBuffer pixel;
  if (!scene.mapper() || !scene.mapper()->castRay(renderer, scene.model(), x, y, pixel)) return "";
  return describeSplat(*static_cast<SplatMapper*>(scene.mapper())->getSplats(), pixel.surfel[0]);
}

Error
savePicture(vtkRenderWindow* window, const std::string& path)
{
  Image image;
  image.width = window->GetSize()[0];
  image.height = window->GetSize()[1];
  vtkNew<vtkUnsignedCharArray> pixels;
  window->GetPixelData(0, 0, image.width - 1, image.height - 1, 1, pixels);
  const auto row = static_cast<std::size_t>(3 * image.width);
  image.rgb.resize(row * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    // VTK's rows begin at the bottom.
    const unsigned char* from =
        pixels->GetPointer(0) + static_cast<std::size_t>(image.height - 1 - y) * row;
    std::copy(from, from + row, image.rgb.begin() + static_cast<std::ptrdiff_t>(y * row));
  }
  return savePng(path, image);
}

std::string
freePictureName()
{
  for (int number = 1;; ++number) {
    std::string name = print("pcl_slim_view_%03d.png", number);
    std::error_code code;
    if (!std::filesystem::exists(name, code)) return name;
  }
}

void
toggleParallel(vtkCamera* camera)
{
  constexpr double kDegrees = 180.0 / M_PI;
  const bool parallel = camera->GetParallelProjection() != 0;
  const double half = std::tan(0.5 * camera->GetViewAngle() / kDegrees);
  if (parallel) {
    // The pinhole steps to where it sees as much at the target.
    const double factor = camera->GetDistance() * half / camera->GetParallelScale();
    camera->Dolly(factor);
  } else {
    camera->SetParallelScale(camera->GetDistance() * half);
  }
  camera->SetParallelProjection(!parallel);
}

}  // namespace pcl_slim
