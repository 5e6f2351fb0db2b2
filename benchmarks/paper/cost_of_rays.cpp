// SPDX-License-Identifier: BSD-3-Clause
// What a frame costs by the number of primitives, of rays, and by degree (section 4).
#include <cmath>

#include "paper/study.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/surface_renderer.h"
#include "support/lab/bench.h"

namespace pcl_slim::paper {

namespace {

/** Milliseconds of a frame, the median of nine, and its counts. */
Result<double> frameTime(SurfaceRenderer& renderer, int size, int threads,
                         RenderStatistics& counts) {
  const BoundingSpheres object = spheresOf(renderer.surface());
  Camera camera = cameraFor(chooseView(object), object, {size, size});
  RenderParams params;
  params.threads = threads;
  params.columns = 0;
  GBuffer buffer;
  std::vector<double> times;
  for (int i = 0; i < 10; ++i) {
    camera.pixel_offset = {0.01 * i, -0.02 * i};
    const double begin = measure::cpuSeconds();
    if (Error error = renderer.render(camera, params, buffer, &counts)) return error;
    if (i > 0) times.push_back(1e3 * (measure::cpuSeconds() - begin));
  }
  return measure::median(times);
}

}  // namespace

Error costOfRays(const StudySettings& settings) {
  const auto model = loadModel(settings, "stanford_dragon_res2.ply");
  if (!model) return model.error();
  Table table("CPU milliseconds a frame of the dragon, one thread (section 4)",
              {"degree", "leaves", "250 x 250", "500 x 500", "1000 x 1000", "rays at 1000 x 1000",
               "ns a ray"});
  for (int degree = 1; degree <= 4; ++degree) {
    for (const int limit : {2000, 6000, 20000}) {
      FitParams params;
      params.degree = degree;
      params.size = MaxSurfels{static_cast<std::uint64_t>(limit)};
      params.threads = settings.threads;
      const auto fitted = fitModel(*model, params);
      if (!fitted) return fitted.error();
      SurfaceRenderer renderer(fitted->surface, 1);
      std::vector<std::string> cells = {std::to_string(degree),
                                        std::to_string(fitted->statistics.leaves)};
      RenderStatistics counts;
      double last = 0;
      for (const int size : {250, 500, 1000}) {
        counts = {};
        const auto time = frameTime(renderer, size, 1, counts);
        if (!time) return time.error();
        last = *time;
        cells.push_back(number("%.1f", last));
      }
      const auto rays = static_cast<double>(counts.rays_first + counts.rays_blend);
      cells.push_back(number("%.2fM", 1e-6 * rays));
      cells.push_back(number("%.1f", 1e6 * last / rays));
      table.row(cells);
    }
  }
  return table.save(settings, "s42");
}

}  // namespace pcl_slim::paper
