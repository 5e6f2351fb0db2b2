// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_render: pictures and pages of a SLIM surface or of splats, without a window system.
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/file_program.h"
#include "common/options.h"
#include "common/program.h"
#include "common/programs.h"
#include "common/standard_output.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/render/frame_blocks.h"
#include "pcl_slim/render/shading.h"
#include "render/camera_file.h"
#include "render/model.h"
#include "render/output_request.h"
#include "render/painted_errors.h"
#include "render/picture_request.h"
#include "render/view_request.h"
#include "scan/small_components.h"

using namespace pcl_slim;

namespace {

constexpr double kBytesOfPixel = 40;  ///< of a frame and its picture at least, whatever -aa

struct Settings {
  std::string input, output, sides = "auto", save_camera, json;
  OutputNames names;  ///< in place of output
  ViewRequest view;
  PictureRequest picture;
  RegionRequest region;
  LineRequest lines;
  TracedRequest traced;
  PageRequest page;
  double near_plane = 0.0, lod = 0.0, hole = 0.0, min_component = kLeastComponentPoints;
  int threads = 0, turntable = 1;
  bool filtered = true, trim = true, quiet = false;
};

OptionTable declareOptions(Settings& s) {
  OptionTable table = programOptions("pcl_slim_render");
  table.input("IN.pcd|.ply|.vtp|.slim", &s.input,
              "surface of pcl_slim_fit, splats of pcl_color_splat_sampling, or a mesh, "
              "also .obj .off .stl");
  table.output("OUT.png|.ppm|.html", &s.output, "picture or page",
               checkImageExtension("x.png") ? ".ppm" : ".png");
  s.view.declareSize(table);
  s.picture.declareColors(table);
  s.traced.declare(table);
  table.toggle("filtered", &s.filtered,
               "blend splats, none below a pixel; 0: the nearest as it is");
  s.view.declareCamera(table);
  table.text("save_camera", &s.save_camera, "FILE", "write the camera, for -camera FILE",
             FileUse::kWritten);
  table.integer("turntable", &s.turntable, 1, 10000,
                "pictures all the way round: OUT_000.png, OUT_001.png ...");
  table.number("near", &s.near_plane, 0.0, 1e300, "cut away what is nearer than this");
  s.region.declare(table);
  table.choice("sides", &s.sides, {"auto", "front", "both"}, "sides of the surface to draw");
  table.toggle("trim", &s.trim, "end a surface where its scan ended; 0: draw all of its balls");
  table.number("hole", &s.hole, 0.0, 1e6,
               "close holes narrower than so many spacings of the points; 0: as they were fitted");
  declareComponentOption(table, s.min_component);
  s.picture.declareFinish(table);
  s.lines.declare(table);
  s.page.declare(table);
  table.number("lod", &s.lod, 0.0, 1024.0,
               "draw coarser surfels where they are seen smaller than this many pixels");
  table.integer("threads", &s.threads, 0, 1024, "threads, 0: all cores");
  table.outputNames(&s.names);
  table.text("json", &s.json, "FILE", "write a report", FileUse::kWritten);
  declareMemoryLimit(table);
  table.toggle("quiet", &s.quiet, "print nothing");
  return table;
}

VisibleSides sidesOf(const Settings& s) {
  return s.sides == "front"  ? VisibleSides::kFront
         : s.sides == "both" ? VisibleSides::kBoth
                             : VisibleSides::kAuto;
}

RenderParams renderingOf(const Settings& s) {
  RenderParams params;
  params.sides = sidesOf(s);
  params.near_plane = s.near_plane;
  params.lod = s.lod;
  params.cuts = s.region.sides;
  params.close_gaps = true;
  params.threads = s.threads;
  return params;
}

/** Every picture of the turntable, each in its place as soon as it is drawn; a single one with the
 * camera and the report.
 * \param[in] draw Result<Image>(const Camera&) */
template <typename Draw>
Error renderTurns(const Settings& s, const Turntable& table, double& save_seconds,
                  const Draw& draw) {
  for (int turn = 0; turn < table.count(); ++turn) {
    const Result<Image> image = draw(table.camera(turn));
    if (!image) return image.error();
    const Stopwatch watch;
    std::optional<FileTransaction> at_once;
    if (s.turntable > 1) at_once.emplace();
    Error error = saveImage(Turntable::path(s.output, turn, s.turntable), *image);
    if (!error && at_once) error = at_once->commit();
    if (error) return error;
    save_seconds += watch.seconds();
  }
  return {};
}

/** A picture with the requested lines drawn over it. */
Result<Image> withLines(const Settings& s, SurfaceRenderer& renderer, const Camera& camera,
                        Result<Image> image, std::size_t& count) {
  if (!image || !s.lines.any()) return image;
  const Error error = s.lines.draw(renderer, camera, renderingOf(s), *image, count);
  return error ? Result<Image>(error) : image;
}

/** \return how many rays met the surface, of all pictures */
Result<std::uint64_t> renderSurfaceModel(const Settings& s, const Model& model,
                                         const Turntable& table, Report& report,
                                         double& save_seconds) {
  SurfaceRenderer renderer(model.surface, s.threads);
  const ShadingParams shading = s.picture.shadingFor(model.hasColors(), s.threads);
  RenderStatistics total;
  std::size_t lines = 0;
  Error error = renderTurns(s, table, save_seconds, [&](const Camera& turned) {
    RenderStatistics counts;
    auto image = renderPicture(renderer, turned, renderingOf(s), shading, &counts);
    total += counts;
    return withLines(s, renderer, turned, std::move(image), lines);
  });
  if (error) return error;
  if (s.lines.any()) report.set("lines", lines);
  reportSurface(model, total, report);
  return total.covered_pixels;
}

DiscRenderParams discsOf(const Settings& s) {
  DiscRenderParams params;
  params.filtered = s.filtered;
  params.sides = sidesOf(s);
  params.near_plane = s.near_plane;
  params.threads = s.threads;
  return params;
}

Result<std::uint64_t> renderSplatModel(const Settings& s, const Model& model,
                                       const Turntable& table, Report& report,
                                       double& save_seconds) {
  const DiscRenderParams params = discsOf(s);
  const ShadingParams shading = s.picture.shadingFor(model.splats.hasColors(), s.threads);
  DiscRenderStatistics total;
  Error error = renderTurns(s, table, save_seconds, [&](const Camera& turned) {
    DiscRenderStatistics counts;
    auto image = renderPicture(model.splats, turned, params, shading, &counts);
    total += counts;
    return image;
  });
  if (error) return error;
  reportSplats(model, total, report);
  return total.covered_pixels;
}

Result<std::uint64_t> renderMeshModel(const Settings& s, const Model& model, const Turntable& table,
                                      Report& report, double& save_seconds) {
  MeshRenderParams params;
  params.sides = sidesOf(s);
  params.near_plane = s.near_plane;
  params.cuts = s.region.sides;
  params.threads = s.threads;
  const ShadingParams shading = s.picture.shadingFor(model.hasColors(), s.threads);
  MeshRenderStatistics total;
  Error error = renderTurns(s, table, save_seconds, [&](const Camera& turned) {
    MeshRenderStatistics counts;
    auto image = renderPicture(model.mesh, turned, params, shading, &counts);
    total += counts;
    return image;
  });
  if (error) return error;
  reportMesh(model, total, report);
  return total.covered_pixels;
}

TraceParams tracingOf(const Settings& s) {
  constexpr int kOcclusionRays = 4;  // in each of the frames of -aa
  TraceParams params;
  params.sides = sidesOf(s);
  params.near_plane = s.near_plane;
  params.cuts = s.region.sides;
  params.filtered = s.filtered;
  params.occlusion_rays = s.picture.occlusion > 0.0 ? kOcclusionRays : 0;
  params.threads = s.threads;
  return params;
}

Result<std::uint64_t> renderTracedModel(const Settings& s, const Model& model,
                                        const Turntable& table, Report& report,
                                        double& save_seconds, Progress& progress) {
  RayTracer tracer =
      model.is_splats ? RayTracer(model.splats, s.threads) : RayTracer(model.surface, s.threads);
  TraceParams params = tracingOf(s);
  const ShadingParams shading = s.picture.shadingFor(model.hasColors(), s.threads);
  // Lines are found in what the rasteriser sees of the same camera.
  std::optional<SurfaceRenderer> renderer;
  if (s.lines.any()) renderer.emplace(model.surface, s.threads);
  std::size_t lines = 0;
  TraceStatistics total;
  Error error = renderTurns(s, table, save_seconds, [&](const Camera& turned) {
    params.lights = s.traced.lightsFor(turned);
    TraceStatistics counts;
    auto image = renderTracedPicture(tracer, turned, params, shading, &counts, &progress);
    total += counts;
    return renderer ? withLines(s, *renderer, turned, std::move(image), lines) : image;
  });
  if (error) return error;
  if (s.lines.any()) report.set("lines", lines);
  reportTraced(model, total, report);
  return total.covered_pixels;
}

/** Writes a page in place of a picture. */
Error writePage(const Settings& s, const Model& model, const ChosenView& view, Console& console,
                Report& report) {
  const Camera& camera = view.camera;
  console.begin("Writing " + shownName(s.output));
  PageParams params;
  params.title = PageRequest::titleOf(s.input);
  params.up = view.up;
  params.precision = s.page.precision;
  params.color_error = s.page.color_error;
  params.lines = s.lines.inSpace();
  ShadingParams shading = s.picture.shadingFor(model.hasColors(), s.threads);
  if (s.picture.isUncertainty()) {
    shading.mode = ShadingMode::kColor;  // of which a page has no bar
    params.title += ": " + errorRangeText(shading.range);
    shading.range = {};
  }
  const auto page = model.is_splats
                        ? encodePage(model.splats, camera, discsOf(s), shading, params)
                        : encodePage(model.surface, camera, renderingOf(s), shading, params);
  if (!page) return page.error();
  if (Error error = writeFile(s.output, page->data(), page->size())) return error;
  report.add({{model.is_splats ? "splats" : "surfels",
               model.is_splats ? model.splats.size() : model.surface.size()},
              {"page_bytes", page->size()}});
  report.time("page", console.seconds());
  console.done(std::to_string(page->size()) + " bytes");
  return s.save_camera.empty() ? Error{} : saveCamera(s.save_camera, camera);
}

/** Draws and saves, and notes how long each took. */
Error renderModel(const Settings& s, const Model& model, const Turntable& table, Console& console,
                  Report& report) {
  console.begin("Rendering " + s.view.size_text);
  double save_seconds = 0.0;
  const auto render = model.is_mesh     ? renderMeshModel
                      : model.is_splats ? renderSplatModel
                                        : renderSurfaceModel;
  const Result<std::uint64_t> covered =
      s.picture.isTraced()
          ? renderTracedModel(s, model, table, report, save_seconds, console.progress())
          : render(s, model, table, report, save_seconds);
  if (!covered) return covered.error();
  const double seconds = console.seconds() - save_seconds;
  report.time("render", seconds);
  console.done(seconds, std::to_string(*covered) + " rays met the surface");
  report.time("save", save_seconds);
  console.begin("Saving " + shownName(s.output));
  console.done(save_seconds, s.view.size_text + " pixels");
  return s.save_camera.empty() ? Error{} : saveCamera(s.save_camera, table.camera(0));
}

/** Whether one camera sees all that is drawn: rays of traced pictures, turned cameras and pages go
 * elsewhere, too. */
bool hasOneView(const Settings& s) {
  return s.turntable == 1 && !s.picture.isTraced() && !PageRequest::isPage(s.output);
}

/** The view with room for a bar of colours, where there is one. */
ViewRequest viewBesideBar(const Settings& s, const ShadingParams& shading) {
  ViewRequest view = s.view;
  if (shading.color_bar && hasColorBar(shading.mode)) view.right_margin = colorBarShare(view.size);
  return view;
}

/** Which blocks of a surface a picture may show: those that the region and a camera given meet. */
bool wantsBlock(const Settings& s, const WorldBox& box) {
  if (PageRequest::isPage(s.output)) return true;
  if (!s.region.sides.empty() && !boxesMeet(box, s.region.box())) return false;
  return !hasOneView(s) || !s.view.given || mayBeSeen(*s.view.given, box);
}

/** Which blocks of a surface with level of detail are drawn. A camera of the program's own choice
 * looks at the levels above the tiles, and is a given one from then on. \param[out] chosen by the
 * program */
Result<std::vector<bool>> blocksInDetail(Settings& s, SlimBlockReader& reader,
                                         std::optional<ChosenView>& chosen) {
  const SlimDirectory& directory = reader.directory();
  std::vector<bool> above;
  for (const SlimBlock& block : directory.blocks) above.push_back(block.isCoarse());
  Result<SLIMSurface> coarse = reader.load(above);
  if (!coarse) return coarse.error();
  if (coarse->empty()) return std::vector<bool>(above.size(), true);
  coarse->buildLinks();
  const bool colored = coarse->hasColors();
  chosen = viewBesideBar(s, s.picture.shadingFor(colored, 1)).viewOf(spheresOf(*coarse));
  s.view.given = chosen->camera;
  return blocksOfFrame(directory, *coarse, *s.view.given, s.lod);
}

/** Of a surface in blocks only what the picture may show. */
Result<Model> loadBlocks(Settings& s, SlimBlockReader& reader, std::optional<ChosenView>& chosen) {
  const SlimDirectory& directory = reader.directory();
  Result<std::vector<bool>> blocks = std::vector<bool>(directory.blocks.size(), true);
  // Of a region the part with surface has to be found before a camera can be chosen.
  if (s.lod > 0.0 && hasOneView(s) && (s.view.given || s.region.sides.empty()))
    blocks = blocksInDetail(s, reader, chosen);
  if (!blocks) return blocks.error();
  for (std::size_t b = 0; b < blocks->size(); ++b)
    (*blocks)[b] = (*blocks)[b] && wantsBlock(s, directory.boxOf(directory.blocks[b]));
  Result<SLIMSurface> surface = reader.load(*blocks);
  if (!surface) return surface.error();
  surface->buildLinks();
  Model model;
  model.surface = std::move(*surface);
  model.blocks = blocks->size();
  model.blocks_read = reader.blocksRead();
  model.box = directory.box();
  for (std::size_t b = 0; b < blocks->size(); ++b) {
    if (!(*blocks)[b]) model.unloaded.push_back(directory.boxOf(directory.blocks[b]));
  }
  return model;
}

/** Loads what is drawn, with the borders that it is to have. \param[out] chosen the view, where it
 * had to be chosen to load what it shows */
Result<Model> loadDrawn(Settings& s, std::optional<ChosenView>& chosen, Console& console,
                        Report& report) {
  console.begin("Loading " + s.input);
  SlimBlockReader reader;
  const bool in_blocks = lowerExtension(s.input) == ".slim" && !reader.open(s.input);
  Result<Model> model = in_blocks ? loadBlocks(s, reader, chosen) : loadModel(s.input);
  if (!model) return console.failed(model.error());
  if (!s.trim) model->surface.dropTrimMaps();
  model->surface.closeHoles(s.hole, s.threads);
  report.time("load", console.seconds());
  if (model->blocks > 0)
    report.set("blocks", {{"count", model->blocks}, {"read", model->blocks_read}});
  console.done(model->describe());
  if (!model->is_splats && !model->is_mesh) {
    leaveOutComponents(s.min_component, s.threads, model->unloaded, console, &report,
                       model->surface);
  }
  if (model->skipped > 0) {
    console.note("  splats left out: " + std::to_string(model->skipped) +
                 " not finite or without a normal");
  }
  return model;
}

/** Paints a surface for the mode that shows its standard error. */
Error paintForMode(Settings& s, Model& model, Console& console, Report& report) {
  if (!s.picture.isUncertainty()) return {};
  if (model.is_splats || model.is_mesh) {
    return {ErrorCode::kBadArgument,
            "splats and meshes have no standard error: give a surface of pcl_slim_fit"};
  }
  const auto shown =
      paintErrors(s.picture.range, s.picture.map == "diverging", s.threads, console, model.surface);
  if (!shown) return shown.error();
  s.picture.range = *shown;
  report.set("standard_error", {{"low", (*shown)[0]}, {"high", (*shown)[1]}});
  return {};
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(const OptionTable& options, Settings& s) {
  if (Error error = s.view.parse()) return error;
  if (Error error = s.picture.parse()) return error;
  if (Error error = PageRequest::check(options, s.output, s.picture.mode)) return error;
  s.lines.applyMode(s.picture);
  if (Error error = s.region.parse()) return error;
  if (Error error = s.lines.load()) return error;
  if (Error error = s.traced.parse()) return error;
  if (!PageRequest::isPage(s.output)) {
    if (Error error = checkImageExtension(s.output)) return error;
  }
  if (s.turntable > 1 && isStandardOutput(s.output)) {
    return {ErrorCode::kBadArgument,
            "standard output takes one picture: name a file for those of -turntable"};
  }
  const std::string first = Turntable::path(s.output, 0, s.turntable);
  if (Error error =
          checkPlaces({s.input, s.lines.file, s.view.camera}, {first, s.save_camera, s.json}))
    return error;
  return checkWritable(first);
}

/** Prints which options have no effect on what is drawn. */
void noteIdleOptions(const OptionTable& options, const Settings& s, const Model& model,
                     const ShadingParams& shading, Console& console) {
  const DrawnThing drawn{!model.is_splats && !model.is_mesh,
                         model.is_splats,
                         PageRequest::isPage(s.output),
                         s.trim,
                         s.picture,
                         s.lines,
                         shading};
  for (const std::string& note : idleOptions(options, drawn)) console.note(note);
}

/** The end of pictures that could not be drawn: a mode may not suit the model, which counts as a
 * wrong option. */
Exit exitOfDrawing(const Error& error) {
  if (error.code == ErrorCode::kBadArgument) return Exit::usage(error);
  if (error.code == ErrorCode::kCancelled) return {kExitInterrupted, error.message};
  return error;
}

/** Draws the pictures, or writes the page, and what is written beside them. */
Exit draw(const Settings& s, const Model& model, const Turntable& table, Console& console,
          Report& report) {
  FileTransaction files;
  const Camera camera = table.camera(0);
  Error error = PageRequest::isPage(s.output) ? writePage(s, model, table.first(), console, report)
                                              : renderModel(s, model, table, console, report);
  if (error) return exitOfDrawing(console.failed(error));
  report.set("camera", {{"position", camera.position},
                        {"look_at", camera.look_at},
                        {"up", camera.up},
                        {"fov", camera.fov},
                        {"width", camera.size.width},
                        {"height", camera.size.height}});
  error = report.write(s.json);
  if (!error) error = commitOutputs(files);
  return error ? exitOfDrawing(console.failed(error)) : Exit();
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.quiet);
  Report report(options, s.input, s.threads);

  std::optional<ChosenView> chosen;
  Result<Model> model = loadDrawn(s, chosen, console, report);
  if (!model) return Exit::usage(model.error());
  if (model->is_mesh && (PageRequest::isPage(s.output) || s.picture.isTraced() || s.lines.any())) {
    return Exit::usage(console.failed(
        {ErrorCode::kBadArgument,
         "a mesh has pictures alone, without lines; for pages, lines and -mode raytraced give a "
         "surface of pcl_slim_fit"}));
  }
  if (model->is_splats && s.lines.any()) {
    return Exit::usage(console.failed(
        {ErrorCode::kBadArgument,
         "splats have no curvature; drop -lines, -line_file and -mode crest, contours or sketch"}));
  }
  if (Error error = paintForMode(s, *model, console, report))
    return Exit::usage(console.failed(error));
  if (Error error = checkMemory(kBytesOfPixel * s.view.size.width * s.view.size.height,
                                "a picture of " + s.view.size_text, "ask for a smaller picture"))
    return console.failed(error);

  const ShadingParams shading = s.picture.shadingFor(model->hasColors(), 1);
  noteIdleOptions(options, s, *model, shading, console);
  const ViewRequest view = viewBesideBar(s, shading);
  const Result<BoundingSpheres> object =
      s.region.within(model->spheres(), model->blocks > 0 ? &model->box : nullptr);
  if (!object) return Exit::usage(console.failed(object.error()));
  if (model->is_splats) model->splats = splatsWithin(model->splats, s.region.sides);
  const Turntable table(view, *object, s.turntable);
  if (!chosen) chosen = table.first();
  if (!chosen->words.empty()) console.note("  " + chosen->words);
  if (s.sides == "auto" && s.region.sides.empty() && chosen->opens) {
    s.sides = "front";
    console.note("  seen from inside: drawn without its near side; -sides both draws that, too");
  }
  return draw(s, *model, table, console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(options, argc, argv,
                        {"ask for a smaller picture", [&] { return finishSettings(options, s); },
                         [&] { return run(options, s); }});
}
