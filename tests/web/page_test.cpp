// SPDX-License-Identifier: BSD-3-Clause
// Pages in a real browser, beside the renderer in double.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/surface/surface_io.h"
#include "pcl_slim/web/page.h"
#include "web/page_frame.h"

using namespace pcl_slim;
using namespace pcl_slim::test;

namespace {

struct Drawn {
  SLIMSurface surface;
  Camera camera;
  PageFrame frame;
  GBuffer truth;
  std::vector<Image> pictures;
};

/** \brief A surface in a page and by the renderer in double, at the same size. */
Drawn
drawBoth(const SLIMSurface& surface, double precision, double lod, const std::vector<std::string>& modes,
         int width, int height)
{
  Drawn drawn;
  drawn.camera = fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kY, 30.0, 10.0), {width, height});
  RenderParams rendering;
  rendering.lod = lod;
  ShadingParams shading;
  shading.ambient_occlusion = 0.0;
  shading.supersampling = 1;
  PageParams params;
  params.precision = precision;
  const auto page = encodePage(surface, drawn.camera, rendering, shading, params);
  if (!page) return drawn;
  const std::string path = ::testing::TempDir() + "page_" + std::to_string(getpid()) + ".html";
  static_cast<void>(writeFile(path, page->data(), page->size()));
  drawn.frame = drawPage(path, surface, width, height, lod, modes);
  std::remove(path.c_str());
  SurfaceRenderer renderer(surface);
  rendering.reference = lod == 0.0;  // the level of detail is the tiles' alone
  static_cast<void>(renderer.render(drawn.camera, rendering, drawn.truth));
  for (const std::string& mode : modes) {
    shading.mode = *shadingModeOf(mode);
    auto picture = renderPicture(renderer, drawn.camera, rendering, shading);
    drawn.pictures.push_back(picture ? *picture : Image());
  }
  return drawn;
}

}  // namespace

TEST(Try, frame)
{
  const auto s = loadSlim(std::getenv("TRY"));
  const double precision = std::atof(std::getenv("PREC"));
  const char* lod = std::getenv("LOD");
  const int w = std::getenv("W") ? std::atoi(std::getenv("W")) : 200;
  auto drawn = drawBoth(*s, precision, lod ? std::atof(lod) : 0.0, {"shaded", "mean", "gauss", "kmax", "kmin", "normal", "level", "size", "error", "reflection"}, w, w * 3 / 4);
  const auto d = compareFrames(drawn.frame.buffer, drawn.truth, s->info.diagonal);
  std::printf("both %zu one %zu normal p95 %.5f p99 %.5f depth p99 %.2g curv p95 %.2g named %zu\n", d.both, d.one,
              d.normal_p95, d.normal_p99, d.depth_p99, d.curvature_p95, d.levels);
  const std::size_t n = drawn.truth.numPixels();
  for (std::size_t k = 0; k < drawn.pictures.size(); ++k) {
    std::size_t off = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t x = i % static_cast<std::size_t>(w), y = i / static_cast<std::size_t>(w);
      const std::size_t flipped = (static_cast<std::size_t>(w * 3 / 4) - 1 - y) * static_cast<std::size_t>(w) + x;
      int most = 0;
      for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int(drawn.pictures[k].rgb[3 * i + c]) - int(drawn.frame.pictures[k][4 * flipped + c])));
      off += most > 2;
    }
    std::printf(" %zu", off);
  }
  std::printf(" of %zu off\n", n);
}
