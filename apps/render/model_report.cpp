// SPDX-License-Identifier: BSD-3-Clause
#include "render/model_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim {
namespace {

/** What a picture of either kind cost. */
template <typename Counts>
void
reportCounts(const Counts& counts, nlohmann::ordered_json& json)
{
  json.update({{"covered_pixels", counts.covered_pixels},
               {"rays_first", counts.rays_first},
               {"rays_blend", counts.rays_blend},
               {"tile_entries", counts.tile_entries}});
}

}  // namespace

Result<FrameSeconds>
timeFrames(SurfaceRenderer& renderer, const Camera& camera, const RenderParams& params,
           const ShadingParams& shading, int repeat)
{
  RenderParams needed = params;
  needed.columns = columnsFor(shading);
  GBuffer buffer;
  std::vector<double> frames, shades;
  for (int i = 0; i <= repeat; ++i) {
    Camera moved = camera;
    moved.pixel_offset = {0.37 * (i % 3), 0.21 * (i % 5)};
    const Stopwatch frame;
    if (Error error = renderer.render(moved, needed, buffer)) return error;
    const double frame_seconds = frame.seconds();
    const Stopwatch shade_time;
    const auto image = shade(buffer, moved, shading, renderer.surface().info.scale);
    if (!image) return image.error();
    if (i == 0) continue;  // the first frame allocates its buffers
    frames.push_back(frame_seconds);
    shades.push_back(shade_time.seconds());
  }
  return FrameSeconds{median(frames), median(shades)};
}

void
reportSurface(const Model& model, const RenderStatistics& counts, nlohmann::ordered_json& json)
{
  json.update({{"points", model.surface.info.num_points},
               {"surfels", model.surface.size()},
               {"leaves", model.surface.numLeaves()},
               {"levels", model.surface.numLevels()},
               {"degree", model.surface.info.degree},
               {"lambda", model.surface.info.lambda}});
  reportCounts(counts, json);
  json["closed_pixels"] = counts.closed_pixels;
  json["rays_bracketed"] = counts.rays_bracketed;
  json["skipped"] = {{"outside_frustum", counts.outside_frustum},
                     {"outside_region", counts.outside_region},
                     {"back_facing", counts.back_facing},
                     {"below_detail", counts.below_detail},
                     {"occluded_entries", counts.occluded_entries}};
  json["coarse_surfels"] = counts.coarse_surfels;
}

void
reportSplats(const Model& model, const DiscRenderStatistics& counts, nlohmann::ordered_json& json)
{
  const std::uint64_t covered = counts.covered_pixels;
  json.update({{"splats", model.splats.size()}, {"gradient", !model.splats.gradient.empty()}});
  reportCounts(counts, json);
  json["overlap"] =
      covered > 0 ? static_cast<double>(counts.blended) / static_cast<double>(covered) : 0.0;
  json["skipped"] = {{"unusable", model.skipped},
                     {"outside_frustum", counts.outside_frustum},
                     {"back_facing", counts.back_facing}};
}

void
reportTraced(const Model& model, const TraceStatistics& counts, nlohmann::ordered_json& json)
{
  json.update({{model.is_splats ? "splats" : "leaves", counts.leaves},
               {"covered_pixels", counts.covered_pixels},
               {"rays_primary", counts.rays_primary},
               {"rays_shadow", counts.rays_shadow},
               {"rays_occlusion", counts.rays_occlusion},
               {"tested_first", counts.tested_first},
               {"tested_blend", counts.tested_blend},
               {"tested_per_ray", counts.testedPerRay()}});
}

Result<Model>
loadDrawn(const std::string& path, const BlockWish& wish, bool trim, double hole, int threads,
          Console& console, Report& report)
{
  console.begin("Loading " + path);
  Result<Model> model = loadModel(path, wish);
  if (!model) return model;
  if (!trim) model->surface.dropTrimMaps();
  model->surface.closeHoles(hole, threads);
  report.time("load", console.seconds());
  if (model->blocks > 0)
    report.json()["blocks"] = {{"count", model->blocks}, {"read", model->blocks_read}};
  console.done(model->describe());
  if (model->skipped > 0) {
    console.note("  splats left out: " + std::to_string(model->skipped) +
                 " not finite or without a normal");
  }
  return model;
}

}  // namespace pcl_slim
