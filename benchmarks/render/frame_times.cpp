// SPDX-License-Identifier: BSD-3-Clause
// Seconds of a frame as a window draws it, one ray a pixel, of any surface, camera and mode, and what
// its stages cost.
#include <cstdio>
#include <string>
#include <vector>

#include "common/run_program.h"
#include "fast/fast_rasterizer.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/surface/surface_io.h"
#include "render/picture_request.h"
#include "render/view_request.h"
#include "support/lab/bench.h"

using namespace pcl_slim;

namespace {

struct Settings {
  std::string input;
  ViewRequest view;
  PictureRequest picture;
  RenderParams rendering;
  std::string vectors = "best";
  int repeat = 15;
};

OptionTable declareOptions(Settings& s) {
  OptionTable table("frame_times", "", "Prints the median seconds of a frame and of its shading.");
  table.positional("IN.slim", &s.input, "surface of pcl_slim_fit");
  s.view.declareSize(table);
  s.picture.declareColors(table);
  s.view.declareCamera(table);
  table.number("lod", &s.rendering.lod, 0.0, 1024.0, "level of detail in pixels");
  table.toggle("skip", &s.rendering.skip, "leave out work that cannot change the picture");
  table.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  table.integer("repeat", &s.repeat, 1, 10000, "frames to take the median of");
  table.integer("threads", &s.rendering.threads, 0, 1024, "threads, 0: all cores");
  return table;
}

/** \brief Times frames after a first one, which allocates the buffers. Each camera is shifted by a
 * part of a pixel against the last, so that nothing repeats. */
Error timeFrames(const Settings& s, const SLIMSurface& surface, const Camera& camera) {
  SurfaceRenderer renderer(surface, s.rendering.threads);
  const ShadingParams shading = s.picture.shadingFor(surface.hasColors(), s.rendering.threads);
  RenderParams rendering = s.rendering;
  rendering.columns = columnsFor(shading);
  GBuffer buffer;
  std::vector<double> frames, shades;
  for (int i = 0; i <= s.repeat; ++i) {
    Camera moved = camera;
    moved.pixel_offset = {0.37 * (i % 3), 0.21 * (i % 5)};
    const Stopwatch frame;
    if (Error error = renderer.render(moved, rendering, buffer)) return error;
    const double seconds = frame.seconds();
    const Stopwatch shading_time;
    const auto image = shade(buffer, moved, shading, surface.info.scale);
    if (!image) return image.error();
    if (i == 0) continue;
    frames.push_back(seconds);
    shades.push_back(shading_time.seconds());
  }
  std::printf("frame %.6g s, shading %.6g s\n", median(frames), median(shades));
  return {};
}

/** \brief Prints the processor time a pixel of each stage of the rasteriser, and its share. Of all
 * threads, in their part of the time of tiles; stages before them are the calling thread's. */
Error printStages(const Settings& s, const SLIMSurface& surface, const Camera& camera) {
  static const char* const kNames[detail::kFrameStages] = {
      "culling, setup", "sort, tiles", "lists", "first hits", "blending", "output"};
  const int threads = resolveThreads(s.rendering.threads);
  detail::FastRasterizer rasterizer(surface, threads);
  RenderParams rendering = s.rendering;
  rendering.threads = threads;
  const detail::FrameRules rules(surface.info, rendering);
  GBuffer buffer;
  buffer.reserve(camera.size.width, camera.size.height, 0);
  RenderStatistics counts;
  detail::StageTicks ticks;
  double seconds = 0.0;
  for (int i = 0; i <= s.repeat; ++i) {
    Camera moved = camera;
    moved.pixel_offset = {0.37 * (i % 3), 0.21 * (i % 5)};
    counts = {};
    const double begin = measure::cpuSeconds();
    rasterizer.draw(moved, rules, 0, buffer, counts, i > 0 ? &ticks : nullptr);
    if (i > 0) seconds += measure::cpuSeconds() - begin;
  }
  if (counts.covered_pixels == 0) return badInput("no pixel is covered");
  double all = 0.0;
  for (const std::uint64_t t : ticks.of) all += static_cast<double>(t);
  const double frame = seconds / s.repeat;
  std::printf("%llu pixels covered, %.2f ms of processor time a frame\n",
              static_cast<unsigned long long>(counts.covered_pixels), 1e3 * frame);
  for (int i = 0; i < detail::kFrameStages; ++i) {
    const double share = static_cast<double>(ticks.of[i]) / all;
    std::printf("  %-14s %6.1f ns a covered pixel, %4.1f %%\n", kNames[i],
                1e9 * share * frame / static_cast<double>(counts.covered_pixels), 100.0 * share);
  }
  return {};
}

Exit run(Settings& s) {
  Error error = s.view.parse();
  if (!error) error = s.picture.parse();
  if (!error) error = measure::chooseVectors(s.vectors);
  if (error) return Exit::usage(error);
  const Result<SLIMSurface> surface = loadSlim(s.input);
  if (!surface) return Exit::usage(surface.error());
  const Camera camera = s.view.viewOf(spheresOf(*surface)).camera;
  error = timeFrames(s, *surface, camera);
  return error ? error : printStages(s, *surface, camera);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "ask for smaller frames", [&] { return run(s); });
}
