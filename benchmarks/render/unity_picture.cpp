// SPDX-License-Identifier: BSD-3-Clause
// A picture of a surface by the derivatives of its partition of unity (equation 8, right) in place
// of its leaves'.
#include <cstdio>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/surface/surface_io.h"
#include "render/picture_request.h"
#include "render/view_request.h"
#include "shading/shading.h"
#include "support/lab/reference/partition_of_unity.h"

using namespace pcl_slim;

namespace {

struct Settings {
  std::string input, output;
  ViewRequest view;
  PictureRequest picture;
};

/** \brief As renderPicture(): shifted frames, averaged in linear light. */
Result<Image> picture(const SLIMSurface& surface, const Camera& camera,
                      const ShadingParams& shading) {
  SurfaceRenderer renderer(surface);
  RenderParams rendering;
  rendering.columns = columnsFor(shading) | kPositionColumn;
  rendering.close_gaps = true;
  const int n = shading.supersampling;
  std::vector<Color> sums;
  ShadingRange range;
  GBuffer buffer;
  for (int pass = 0; pass < n * n; ++pass) {
    Camera shifted = camera;
    shifted.pixel_offset = {(pass % n + 0.5) / n - 0.5, (pass / n + 0.5) / n - 0.5};
    if (Error error = renderer.render(shifted, rendering, buffer)) return error;
    if (Error error = lab::differentiateInSpace(surface, 0, buffer)) return error;
    if (pass == 0) range = rangeOf(buffer, shading, surface.info.scale);
    const auto colors = shadeLinear(buffer, shifted, shading, range, surface.info.scale);
    sums.resize(colors.size(), Color{0.0f, 0.0f, 0.0f});
    for (std::size_t i = 0; i < colors.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sums[i][k] += colors[i][k];
    }
  }
  Image image;
  image.width = camera.size.width;
  image.height = camera.size.height;
  const float factor = 1.0f / static_cast<float>(n * n);
  for (const Color& sum : sums) {
    for (const float channel : sum) image.rgb.push_back(detail::toByte(channel * factor));
  }
  return image;
}

Error draw(Settings& s) {
  Error error = s.view.parse();
  if (!error) error = s.picture.parse();
  if (error) return error;
  const auto surface = loadSlim(s.input);
  if (!surface) return surface.error();
  const Camera camera = s.view.viewOf(spheresOf(*surface)).camera;
  const auto image = picture(*surface, camera, s.picture.shadingFor(false, 0));
  return image ? saveImage(s.output, *image) : image.error();
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable table("unity_picture", "",
                    "Draws a surface by the derivatives of its partition of unity.");
  table.positional("IN.slim", &s.input, "surface of pcl_slim_fit");
  table.positional("OUT.png|.ppm", &s.output, "the picture");
  s.view.declareSize(table);
  s.picture.declareColors(table);
  s.view.declareCamera(table);
  s.picture.declareFinish(table);
  if (const auto status = table.parse(argc, argv)) return *status;
  if (const Error error = draw(s)) {
    std::fprintf(stderr, "unity_picture: %s\n", error.message.c_str());
    return kExitUsage;
  }
  return kExitDone;
}
