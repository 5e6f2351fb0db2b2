// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/web/page.h"
#include "support/clouds.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim::test {

inline constexpr int kWidth = 120, kHeight = 90;

/** \brief A page in a file, for as long as this lives. */
class PageFile {
 public:
  PageFile(const SLIMSurface& surface, const Camera& camera, double precision, double lod = 0.0,
           const std::vector<SpaceLine>& lines = {}, ShadingMode mode = ShadingMode::kNormal) {
    RenderParams rendering;
    rendering.lod = lod;
    ShadingParams shading;
    shading.mode = mode;
    shading.lighting = mode != ShadingMode::kColor;
    PageParams params;
    params.precision = precision;
    params.lines = lines;
    write(encodePage(surface, camera, rendering, shading, params));
  }
  PageFile(const SplatSet& splats, const Camera& camera, const ShadingParams& shading) {
    write(encodePage(splats, camera, {}, shading, {}));
  }
  PageFile(const SLIMSurface& surface, const Camera& camera, const ShadingParams& shading,
           const PageParams& params) {
    write(encodePage(surface, camera, {}, shading, params));
  }
  ~PageFile() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }
  std::size_t bytes() const { return bytes_; }

 private:
  void write(const Result<std::string>& page) {
    EXPECT_FALSE(page ? writeFile(path_, page->data(), page->size()) : page.error());
    if (page) bytes_ = page->size();
  }

  static std::string newPath() {
    static int count = 0;
    return testing::TempDir() + "pcl_slim_" + std::to_string(getpid()) + "_" +
           std::to_string(++count) + ".html";
  }

  std::string path_ = newPath();
  std::size_t bytes_ = 0;
};

inline SLIMSurface fittedSurface(measure::Shape shape, int degree, bool with_normals) {
  FitParams params;
  params.degree = degree;
  const auto cloud = pcl_slim_test::sceneCloud(shape, 8000, 0.0005, 0.02);
  return pcl_slim_test::fitted(with_normals ? cloud : cloud.withoutNormals(), params).surface;
}

/** \brief Discs all over a sphere, coloured by their places, with the colours' change. */
inline SplatSet discsOnSphere() {
  const SLIMSurface sphere = sphereSurface(1, kSphere, 500, 0.04);
  SplatSet splats;
  splats.resize(sphere.size(), true);
  splats.x = sphere.cx;
  splats.y = sphere.cy;
  splats.z = sphere.cz;
  splats.nx = sphere.nx;
  splats.ny = sphere.ny;
  splats.nz = sphere.nz;
  splats.radius = sphere.radius;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const auto byte = [](float x) { return static_cast<std::uint32_t>(127.0f + 400.0f * x); };
    splats.rgb[i] = byte(splats.x[i]) << 16 | byte(splats.y[i]) << 8 | byte(splats.z[i]);
    const float n[3] = {splats.nx[i], splats.ny[i], splats.nz[i]};
    for (std::size_t k = 0; k < 9; ++k) {
      splats.gradient[i][k] = 400.0f * ((k / 3 == k % 3 ? 1.0f : 0.0f) - n[k / 3] * n[k % 3]);
    }
  }
  return splats;
}

/** \brief Share of pixels in which a picture differs by more than 2 of 255. */
inline double shareOff(const std::vector<std::uint8_t>& seen, const Image& truth) {
  std::size_t off = 0;
  for (int y = 0; y < truth.height; ++y) {
    for (int x = 0; x < truth.width; ++x) {
      const auto below = static_cast<std::size_t>((truth.height - 1 - y) * truth.width + x);
      const auto at = static_cast<std::size_t>(y * truth.width + x);
      int most = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        most = std::max(most, std::abs(int{seen[4 * below + k]} - int{truth.rgb[3 * at + k]}));
      }
      off += most > 2;
    }
  }
  return static_cast<double>(off) / (truth.width * truth.height);
}

}  // namespace pcl_slim::test
