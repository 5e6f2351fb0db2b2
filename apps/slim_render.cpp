// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_render: a picture of a SLIM surface or of splats, without a window system.
#include <cstdio>
#include <new>
#include <string>

#include "common/options.h"
#include "common/program.h"
#include "common/progress_bar.h"
#include "common/report.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/shading.h"
#include "render/model.h"
#include "render/view_request.h"

using namespace pcl_slim;

namespace {

struct Settings {
  std::string input, output, mode = "auto", lighting = "auto", sides = "auto", json;
  ViewRequest view;
  double near_plane = 0.0, range = 0.0, occlusion = 0.6;
  int supersampling = 2, threads = 0;
  bool filtered = true, trim = true, white = false, skip = true, quiet = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable table("pcl_slim_render", PCL_SLIM_VERSION,
                    "Renders a SLIM surface (.pcd .ply .vtp .slim) or splats (.pcd .ply) into a "
                    "picture; no X server needed.");
  table.positional("IN.pcd|.ply|.vtp|.slim", &s.input,
                   "surface of pcl_slim_fit or splats of pcl_color_splat_sampling");
  table.positional("OUT.png|.ppm", &s.output, "picture");
  s.view.declareSize(table);
  table.choice("mode", &s.mode, {"auto", "shaded", "normal", "mean", "level", "size", "color"},
               "what the colours show; auto: shaded surfaces, splats in their colours");
  table.choice("lighting", &s.lighting, {"auto", "0", "1"},
               "light on the colours; auto: all but -mode color");
  table.toggle("filtered", &s.filtered,
               "blend splats, none below a pixel; 0: the nearest as it is");
  s.view.declareCamera(table);
  table.number("near", &s.near_plane, 0.0, 1e300, "cut away what is nearer than this");
  table.choice("sides", &s.sides, {"auto", "front", "both"}, "sides of the surface to draw");
  table.toggle("trim", &s.trim, "end a surface where its scan ended; 0: draw all of its balls");
  table.number("range", &s.range, 0.0, 1e300, "curvature of full colour, 1/length", "automatic");
  table.number("ao", &s.occlusion, 0.0, 1.0, "strength of the shade in hollows");
  table.toggle("white", &s.white, "white background");
  table.integer("aa", &s.supersampling, 1, 8, "N x N rays a pixel");
  table.toggle("skip", &s.skip, "leave out work that cannot change the picture");
  table.integer("threads", &s.threads, 0, 1024, "threads, 0: all cores");
  table.text("json", &s.json, "FILE", "write a report");
  table.toggle("quiet", &s.quiet, "print nothing");
  return table;
}

VisibleSides
sidesOf(const Settings& s)
{
  return s.sides == "front"  ? VisibleSides::kFront
         : s.sides == "both" ? VisibleSides::kBoth
                             : VisibleSides::kAuto;
}

ShadingParams
shadingOf(const Settings& s, const Model& model)
{
  ShadingParams params;
  const std::string automatic = model.is_splats ? "color" : "shaded";
  params.mode = *shadingModeOf(s.mode == "auto" ? automatic : s.mode);
  params.lighting = s.lighting == "auto" ? params.mode != ShadingMode::kColor : s.lighting == "1";
  params.range = s.range;
  params.ambient_occlusion = s.occlusion;
  params.gradient_background = !s.white;
  params.supersampling = s.supersampling;
  params.threads = s.threads;
  return params;
}

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

Result<Image>
renderSurfaceModel(const Settings& s, const Model& model, const Camera& camera,
                   nlohmann::ordered_json& json, std::uint64_t& covered)
{
  RenderParams params;
  params.sides = sidesOf(s);
  params.near_plane = s.near_plane;
  params.trim = s.trim;
  params.skip = s.skip;
  params.threads = s.threads;
  RenderStatistics counts;
  auto image = renderPicture(model.surface, camera, params, shadingOf(s, model), &counts);
  covered = counts.covered_pixels;
  json.update({{"points", model.surface.info.num_points},
               {"surfels", model.surface.size()},
               {"leaves", model.surface.numLeaves()},
               {"levels", model.surface.numLevels()},
               {"degree", model.surface.info.degree}});
  reportCounts(counts, json);
  json["skipped"] = {{"outside_frustum", counts.outside_frustum},
                     {"back_facing", counts.back_facing},
                     {"occluded_entries", counts.occluded_entries}};
  return image;
}

Result<Image>
renderSplatModel(const Settings& s, const Model& model, const Camera& camera,
                 nlohmann::ordered_json& json, std::uint64_t& covered)
{
  DiscRenderParams params;
  params.filtered = s.filtered;
  params.sides = sidesOf(s);
  params.near_plane = s.near_plane;
  params.skip = s.skip;
  params.threads = s.threads;
  DiscRenderStatistics counts;
  auto image = renderPicture(model.splats, camera, params, shadingOf(s, model), &counts);
  covered = counts.covered_pixels;
  json.update({{"splats", model.splats.size()}, {"gradient", !model.splats.gradient.empty()}});
  reportCounts(counts, json);
  json["overlap"] =
      covered > 0 ? static_cast<double>(counts.blended) / static_cast<double>(covered) : 0.0;
  json["skipped"] = {{"unusable", model.skipped},
                     {"outside_frustum", counts.outside_frustum},
                     {"back_facing", counts.back_facing}};
  return image;
}

int
fail(Console& console, int status, const Error& error)
{
  console.failed();
  std::fprintf(stderr, "pcl_slim_render: %s\n", error.message.c_str());
  return status;
}

int
run(const Settings& s)
{
  if (Error error = checkWritable(s.output)) {
    std::fprintf(stderr, "pcl_slim_render: %s\n", error.message.c_str());
    return kExitFailed;
  }
  Console console(s.quiet);
  Report report("pcl_slim_render", PCL_SLIM_VERSION, s.input, resolveThreads(s.threads));
  console.begin("Loading " + s.input);
  const Stopwatch load_time;
  const Result<Model> model = loadModel(s.input);
  if (!model) return fail(console, kExitUsage, model.error());
  report.time("load", load_time.seconds());
  console.done(load_time.seconds(), model->describe());
  if (model->skipped > 0) {
    console.note("  splats left out: " + std::to_string(model->skipped) +
                 " not finite or without a normal");
  }

  console.begin("Rendering " + s.view.size_text);
  const Stopwatch render_time;
  const Camera camera = s.view.cameraFor(model->spheres());
  std::uint64_t covered = 0;
  const auto render = model->is_splats ? renderSplatModel : renderSurfaceModel;
  const auto image = render(s, *model, camera, report.json(), covered);
  if (!image) {
    const bool usage = image.error().code == ErrorCode::kBadArgument;
    return fail(console, usage ? kExitUsage : kExitFailed, image.error());
  }
  report.time("render", render_time.seconds());
  console.done(render_time.seconds(), std::to_string(covered) + " rays met the surface");

  console.begin("Saving " + s.output);
  const Stopwatch save_time;
  if (Error error = saveImage(s.output, *image)) return fail(console, kExitFailed, error);
  report.time("save", save_time.seconds());
  console.done(save_time.seconds(), s.view.size_text + " pixels");
  report.json()["camera"] = {
      {"position", camera.position}, {"look_at", camera.look_at},  {"up", camera.up},
      {"fov", camera.fov},           {"width", camera.size.width}, {"height", camera.size.height}};
  if (Error error = report.write(s.json)) return fail(console, kExitFailed, error);
  return kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  Settings settings;
  OptionTable table = declareOptions(settings);
  if (const auto status = table.parse(argc, argv)) return *status;
  Error error = settings.view.parse();
  if (!error) error = checkImageExtension(settings.output);
  if (error) {
    std::fprintf(stderr, "pcl_slim_render: %s\n", error.message.c_str());
    return kExitUsage;
  }
  return guarded("pcl_slim_render", "ask for a smaller picture", [&] { return run(settings); });
}
