// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_render: a picture of a SLIM surface, without a window system.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <new>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/progress_bar.h"
#include "common/report.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/surface_files.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/shading.h"

using namespace pcl_slim;

namespace {

struct Settings {
  std::string input, output, camera = "auto", view = "auto", up = "auto", mode = "shaded";
  std::string size = "800x600", sides = "auto", json;
  double fov = 30.0, near_plane = 0.0, range = 0.0, occlusion = 0.6;
  int supersampling = 2, threads = 0;
  bool orthographic = false, white = false, skip = true, quiet = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable table(
      "pcl_slim_render", PCL_SLIM_VERSION,
      "Renders a SLIM surface (.pcd .ply .vtp .slim) into a PNG file; no X server needed.");
  table.positional("IN.pcd|.ply|.vtp|.slim", &s.input, "surface as pcl_slim_fit writes it");
  table.positional("OUT.png", &s.output, "picture");
  table.text("size", &s.size, "WxH", "width and height in pixels");
  table.choice("mode", &s.mode, {"shaded", "normal", "mean", "level", "size"},
               "what the colours show");
  table.text(
      "view", &s.view, "NAME|AZ,EL",
      "auto, front, back, left, right, top, bottom, iso, or azimuth and elevation in degrees");
  table.choice("up", &s.up, {"auto", "x", "y", "z"}, "axis that points upwards");
  table.text("camera", &s.camera, "auto|PX,PY,PZ,LX,LY,LZ,UX,UY,UZ[,FOV]",
             "position, target and upward direction in world coordinates");
  table.number("fov", &s.fov, 1.0, 150.0, "vertical field of view in degrees");
  table.toggle("ortho", &s.orthographic, "parallel projection");
  table.number("near", &s.near_plane, 0.0, 1e300, "cut away what is nearer than this");
  table.choice("sides", &s.sides, {"auto", "front", "both"}, "sides of the surface to draw");
  table.number("range", &s.range, 0.0, 1e300, "curvature of full colour, 1/length", "automatic");
  table.number("ao", &s.occlusion, 0.0, 1.0, "strength of the shade in hollows");
  table.toggle("white", &s.white, "white background");
  table.integer("aa", &s.supersampling, 1, 8, "N x N rays a pixel");
  table.toggle("skip", &s.skip, "leave out work that cannot change the picture");
  table.integer("threads", &s.threads, 0, 1024, "threads, 0: all cores");
  table.text("json", &s.json, "FILE", "write a report");
  table.toggle("quiet", &s.quiet, "print nothing");
  table.exclusive({"camera", "view"});
  table.exclusive({"camera", "fov"});
  return table;
}

Error
badOption(const std::string& message)
{
  return {ErrorCode::kBadArgument, message};
}

/** \brief Numbers separated by single commas; nothing else may stand between. */
bool
parseNumberList(const std::string& text, std::vector<double>& values)
{
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) return false;
    values.push_back(value);
    if (*end == '\0') return true;
    if (*end != ',') return false;
    at = end + 1;
  }
}

Error
parseSize(const std::string& text, ImageSize& size)
{
  int used = 0;
  const bool read = std::sscanf(text.c_str(), "%5dx%5d%n", &size.width, &size.height, &used) == 2;
  if (!read || used != static_cast<int>(text.size()) || size.width < 1 || size.height < 1) {
    return badOption("-size takes width x height in pixels, as in 800x600, not '" + text + "'");
  }
  return {};
}

UpAxis
upAxis(const std::string& name)
{
  return name == "x"   ? UpAxis::kX
         : name == "y" ? UpAxis::kY
         : name == "z" ? UpAxis::kZ
                       : UpAxis::kAuto;
}

/** \brief Azimuth and elevation of -view; none for auto. */
Error
parseView(const std::string& text, std::vector<double>& angles)
{
  static const std::map<std::string, std::vector<double>> kNamed{
      {"auto", {}},
      {"front", {0.0, 0.0}},
      {"back", {180.0, 0.0}},
      {"left", {-90.0, 0.0}},
      {"right", {90.0, 0.0}},
      {"top", {0.0, 90.0}},
      {"bottom", {0.0, -90.0}},
      {"iso", {45.0, 35.264389682754654}}};
  const auto named = kNamed.find(text);
  if (named != kNamed.end()) {
    angles = named->second;
    return {};
  }
  if (parseNumberList(text, angles) && angles.size() == 2) return {};
  return badOption(
      "-view takes auto, front, back, left, right, top, bottom, iso or two angles in "
      "degrees such as 30,20, not '" +
      text + "'");
}

/** \brief What can be said about the view before the surface is there. */
struct ViewRequest {
  ImageSize size;
  std::vector<double> angles, pose;
};

Error
parseViewRequest(const Settings& s, ViewRequest& request)
{
  if (Error error = parseSize(s.size, request.size)) return error;
  if (Error error = parseView(s.view, request.angles)) return error;
  if (s.camera == "auto") return {};
  if (!parseNumberList(s.camera, request.pose) ||
      (request.pose.size() != 9 && request.pose.size() != 10)) {
    return badOption(
        "-camera takes auto or nine or ten numbers separated by commas: position, "
        "target, upward direction and, if wanted, the field of view");
  }
  if (s.orthographic)
    return badOption("-ortho frames the object itself: give -view instead of -camera");
  Camera camera;
  camera.size = request.size;
  const auto& p = request.pose;
  camera.position = {p[0], p[1], p[2]};
  camera.look_at = {p[3], p[4], p[5]};
  camera.up = {p[6], p[7], p[8]};
  if (p.size() == 10) camera.fov = p[9];
  return camera.validate();
}

Camera
makeCamera(const Settings& s, const ViewRequest& request, const SLIMSurface& surface)
{
  if (!request.pose.empty()) {
    Camera camera;
    camera.size = request.size;
    const auto& p = request.pose;
    camera.position = {p[0], p[1], p[2]};
    camera.look_at = {p[3], p[4], p[5]};
    camera.up = {p[6], p[7], p[8]};
    camera.fov = p.size() == 10 ? p[9] : s.fov;
    return camera;
  }
  UpAxis up = upAxis(s.up);
  ViewDirection direction;
  if (request.angles.empty()) {
    direction = chooseView(surface, up);
  } else {
    if (up == UpAxis::kAuto) up = guessUpAxis(surface);
    direction = viewFromAngles(up, request.angles[0], request.angles[1]);
  }
  return s.orthographic ? fitOrthographicCamera(surface, direction, request.size)
                        : fitCamera(surface, direction, request.size, s.fov);
}

void
fillReport(const SLIMSurface& surface, const Camera& camera, const RenderStatistics& counts,
           Report& report)
{
  auto& json = report.json();
  json["points"] = surface.info.num_points;
  json["surfels"] = surface.size();
  json["leaves"] = surface.numLeaves();
  json["levels"] = surface.numLevels();
  json["degree"] = surface.info.degree;
  json["camera"] = {
      {"position", camera.position}, {"look_at", camera.look_at},  {"up", camera.up},
      {"fov", camera.fov},           {"width", camera.size.width}, {"height", camera.size.height}};
  json["covered_pixels"] = counts.covered_pixels;
  json["rays_first"] = counts.rays_first;
  json["rays_blend"] = counts.rays_blend;
  json["tile_entries"] = counts.tile_entries;
  json["skipped"] = {{"outside_frustum", counts.outside_frustum},
                     {"back_facing", counts.back_facing},
                     {"occluded_entries", counts.occluded_entries}};
}

int
fail(Console& console, int status, const Error& error)
{
  console.failed();
  std::fprintf(stderr, "pcl_slim_render: %s\n", error.message.c_str());
  return status;
}

int
run(const Settings& s, const ViewRequest& request)
{
  if (Error error = checkWritable(s.output)) {
    std::fprintf(stderr, "pcl_slim_render: %s\n", error.message.c_str());
    return kExitFailed;
  }
  Console console(s.quiet);
  Report report("pcl_slim_render", PCL_SLIM_VERSION, s.input, resolveThreads(s.threads));
  console.begin("Loading " + s.input);
  const Stopwatch load_time;
  const auto surface = loadSurface(s.input);
  if (!surface) return fail(console, kExitUsage, surface.error());
  report.time("load", load_time.seconds());
  console.done(load_time.seconds(), std::to_string(surface->numLeaves()) + " leaves of " +
                                        std::to_string(surface->size()) + " surfels");

  RenderParams render_params;
  render_params.sides = s.sides == "front"  ? VisibleSides::kFront
                        : s.sides == "both" ? VisibleSides::kBoth
                                            : VisibleSides::kAuto;
  render_params.near_plane = s.near_plane;
  render_params.skip = s.skip;
  render_params.threads = s.threads;
  ShadingParams shading_params;
  shading_params.mode = *shadingModeOf(s.mode);
  shading_params.range = s.range;
  shading_params.ambient_occlusion = s.occlusion;
  shading_params.gradient_background = !s.white;
  shading_params.supersampling = s.supersampling;
  shading_params.threads = s.threads;

  console.begin("Rendering " + s.size);
  const Stopwatch render_time;
  const Camera camera = makeCamera(s, request, *surface);
  RenderStatistics counts;
  const auto image = renderPicture(*surface, camera, render_params, shading_params, &counts);
  if (!image) return fail(console, kExitFailed, image.error());
  report.time("render", render_time.seconds());
  console.done(render_time.seconds(),
               std::to_string(counts.covered_pixels) + " rays met the surface");

  console.begin("Saving " + s.output);
  const Stopwatch save_time;
  if (Error error = savePng(s.output, *image)) return fail(console, kExitFailed, error);
  report.time("save", save_time.seconds());
  console.done(save_time.seconds(), s.size + " pixels");
  fillReport(*surface, camera, counts, report);
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
  ViewRequest request;
  Error error = parseViewRequest(settings, request);
  if (!error && lowerExtension(settings.output) != ".png") {
    error = badOption("the picture '" + settings.output + "' must be named .png");
  }
  if (error) {
    std::fprintf(stderr, "pcl_slim_render: %s\n", error.message.c_str());
    return kExitUsage;
  }
  try {
    return run(settings, request);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "pcl_slim_render: not enough memory; ask for a smaller picture\n");
    return kExitFailed;
  }
}
