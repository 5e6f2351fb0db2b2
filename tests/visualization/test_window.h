// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "pcl_slim/render/image.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim::test {

/** \brief What a window shows, rows from the top. */
inline Image pictureOf(vtkRenderWindow* window) {
  window->Render();
  Image image;
  image.width = window->GetSize()[0];
  image.height = window->GetSize()[1];
  vtkNew<vtkUnsignedCharArray> pixels;
  window->GetPixelData(0, 0, image.width - 1, image.height - 1, 1, pixels);
  for (int y = image.height - 1; y >= 0; --y) {
    const unsigned char* row = pixels->GetPointer(3 * static_cast<vtkIdType>(y) * image.width);
    image.rgb.insert(image.rgb.end(), row, row + 3 * image.width);
  }
  return image;
}

inline std::array<int, 3> pixelOf(const Image& image, int x, int y) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(x));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

/** \brief Share of pixels with a channel that differs by more than tolerance; 1 for other sizes. */
inline double shareDifferent(const Image& a, const Image& b, int tolerance) {
  if (a.width != b.width || a.height != b.height) return 1.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    bool differs = false;
    for (std::size_t k = i; k < i + 3; ++k) {
      differs = differs || std::abs(int{a.rgb[k]} - int{b.rgb[k]}) > tolerance;
    }
    count += differs;
  }
  return static_cast<double>(count) / (static_cast<double>(a.rgb.size()) / 3.0);
}

/** \brief Share of pixels that are not white. */
inline double shareDrawn(const Image& image) {
  Image white = image;
  std::fill(white.rgb.begin(), white.rgb.end(), std::uint8_t{255});
  return shareDifferent(image, white, 0);
}

/** \brief A sphere of 600 quartic leaves, .25 world units wide unless said otherwise. */
inline std::shared_ptr<SLIMSurface> smallSphere(double radius = 0.25,
                                                std::array<double, 3> center = {0.0, 0.0, 0.0}) {
  return std::make_shared<SLIMSurface>(sphereSurface(4, radius, 600, 0.36 * radius, center));
}

/** \brief Leaves that differ in size, level and residual, and whose curvatures vary. */
inline std::shared_ptr<SLIMSurface> unevenSphere(int degree) {
  auto surface = std::make_shared<SLIMSurface>(sphereSurface(degree, 0.25, 600, 0.09));
  const auto stride = static_cast<std::size_t>(surface->stride());
  for (std::size_t i = 0; i < surface->size(); ++i) {
    surface->radius[i] *= 1.0f + 0.1f * static_cast<float>(i % 3);
    surface->error[i] = 1e-5f * static_cast<float>(i % 7);
    float* c = surface->coefficients.data() + i * stride;
    for (std::size_t k = 1; k < stride; ++k) {
      // Cubics and quartics that turn within a ball have several roots on a ray.
      c[k] += (k < 6 ? 0.004f : 0.03f) * std::sin(static_cast<float>(7 * i + 3 * k));
    }
  }
  return surface;
}

/** \brief A white window of 160 x 120 pixels that a test can draw in, seen from (0, 0, 1.2). */
class WindowTest : public ::testing::Test {
 protected:
  WindowTest() {
    window->SetOffScreenRendering(1);
    window->SetMultiSamples(0);
    window->SetSize(160, 120);
    renderer->SetBackground(1.0, 1.0, 1.0);
    window->AddRenderer(renderer);
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetPosition(0.0, 0.0, 1.2);
    camera->SetFocalPoint(0.0, 0.0, 0.0);
    camera->SetViewUp(0.0, 1.0, 0.0);
    camera->SetViewAngle(30.0);
    camera->SetClippingRange(0.1, 10.0);
  }

  /** \brief Adds the small sphere, grey, so that no light makes it white. */
  void addSphere(std::array<double, 3> center = {0.0, 0.0, 0.0}) {
    mapper->setSurface(smallSphere(0.25, center));
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(0.6, 0.6, 0.6);
    renderer->AddActor(actor);
  }

  Image picture() { return pictureOf(window); }

  vtkNew<vtkRenderWindow> window;
  vtkNew<vtkRenderer> renderer;
  vtkNew<SLIMMapper> mapper;
  vtkNew<vtkActor> actor;
};

}  // namespace pcl_slim::test
