// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_view: a window for SLIM surfaces, splats and scans.
#include <string>

#include "common/file_program.h"
#include "common/options.h"
#include "common/program.h"
#include "common/programs.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/visualization/display_mode.h"
#include "render/model.h"
#include "render/painted_errors.h"
#include "scan/fit_job.h"
#include "scan/small_components.h"
#include "view/viewer.h"

using namespace pcl_slim;

namespace {

constexpr const char* kProgram = "pcl_slim_view";

struct Settings {
  std::string input, screenshot;
  std::vector<std::string> further;  ///< more frames of a sensor, after the input
  ViewerSettings viewer;
  FitJob fit;
  double min_component = kLeastComponentPoints;
  bool quiet = false;
};

OptionTable declareOptions(Settings& s) {
  OptionTable table = programOptions(kProgram);
  table.input("IN.pcd|.ply|.vtp|.slim", &s.input,
              "surface of pcl_slim_fit, splats of pcl_color_splat_sampling, or a scan; several "
              "scans: the frames of a sensor, one after the other");
  table.furtherInputs(&s.further);
  s.viewer.view.declareSize(table);
  std::vector<std::string> modes = displayModeNames();
  modes.insert(modes.begin(), "auto");
  modes.emplace_back("uncertainty");
  table.choice("mode", &s.viewer.mode, modes,
               "what the colours show; uncertainty: the standard error of the position, dark to "
               "light; auto: "
               "surfaces and splats that have colours in these, others shaded");
  table.number("range", &s.viewer.range, 0.0, 1e300, "curvature or error of full colour",
               "automatic");
  table.text("unit", &s.viewer.unit, "NAME",
             "unit of length that the scale and the readout name, such as mm");
  table.toggle("lighting", &s.viewer.lighting, "light on the model; 0: bare colours");
  table.toggle("balls", &s.viewer.balls, "balls of the leaves, coloured by size");
  table.toggle("points", &s.viewer.points, "points of a scan, also once it is fitted");
  table.toggle("normals", &s.viewer.normals, "normals of leaves or splats");
  table.toggle("help_overlay", &s.viewer.help, "begin with the help over the picture");
  table.number("frame_budget", &s.viewer.frame_budget, 0.0, 1e6,
               "milliseconds a frame may take while the mouse moves, else it is coarser; 0: any");
  table.number("lod", &s.viewer.lod, 0.0, 1024.0,
               "draw coarser surfels where they are seen smaller than this many pixels");
  table.choice("lines", &s.viewer.lines, {"none", "crest", "suggestive", "contour", "all"},
               "lines over a surface; none with -mode sketch: all");
  table.number("line_width", &s.viewer.line_width, 0.1, 100, "width of strong lines, pixels");
  table.choice("backend", &s.viewer.backend, {"auto", "cpu", "opengl"},
               "what intersects rays with a surface; auto: the graphics card, or the CPU where it "
               "is faster");
  s.viewer.view.declareCamera(table);
  s.viewer.region.declare(table);
  table.text("camera_file", &s.viewer.camera_file, "FILE",
             "where the keys c and C save and load the camera");
  table.text("screenshot", &s.screenshot, "FILE.png", "save a picture instead of opening a window",
             FileUse::kWritten);
  declareFitOptions(table, s.fit);
  declareTrimOptions(table, s.fit);
  declareComponentOption(table, s.min_component);
  declareColorOption(table, s.fit);
  table.toggle("quiet", &s.quiet, "print nothing");
  return table;
}

/** \brief Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(Settings& s) {
  if (Error error = s.viewer.view.parse()) return error;
  if (Error error = s.viewer.region.parse()) return error;
  if (Error error = finishFitOptions(s.fit)) return error;
  if (!s.screenshot.empty() && lowerExtension(s.screenshot) != ".png") {
    return {ErrorCode::kBadArgument, "the picture '" + s.screenshot + "' must be named .png"};
  }
  ShadingParams named;
  named.unit = s.viewer.unit;
  if (Error error = named.validate()) return error;
  s.viewer.threads = s.fit.params.threads;
  s.viewer.title = s.input + " - " + kProgram;
  return {};
}

/** \brief Prints the view that is chosen of an object. */
void noteView(const Settings& s, const BoundingSpheres& object, Console& console) {
  const ChosenView view = s.viewer.view.viewOf(object);
  if (!view.words.empty()) console.note("  " + view.words);
}

/** \brief Paints a surface for the mode that shows its standard error. */
Error paintForMode(const Settings& s, SLIMSurface& surface, Console& console) {
  if (!s.viewer.isUncertainty()) return {};
  const auto shown = paintErrors({0.0, s.viewer.range}, false, s.viewer.threads, console, surface);
  return shown ? Error() : shown.error();
}

/** \brief A window for a scan, whose surface comes while the points are shown. */
Error showScan(const Settings& s, const CloudFile& cloud, Console& console, Report& report) {
  Viewer viewer(s.viewer, s.screenshot.empty());
  viewer.scene().setPoints(cloud.view(s.fit.use_normals),
                           s.fit.color ? colorsOf(cloud) : ColorView());
  if (s.screenshot.empty()) {
    viewer.begin();
    FitTask task(s.fit, s.min_component, cloud, s.viewer.isUncertainty());
    return viewer.runFit(task);
  }
  auto surface = std::make_shared<SLIMSurface>();
  if (Error error = fitScan(s.fit, cloud, console, report, *surface)) return error;
  leaveOutComponents(s.min_component, s.viewer.threads, {}, console, nullptr, *surface);
  noteView(s, spheresOf(*surface), console);
  if (Error error = paintForMode(s, *surface, console)) return error;
  viewer.scene().setSurface(surface);
  viewer.begin();
  return viewer.saveScreenshot(s.screenshot);
}

/** \brief A window for the frames of a sensor; a picture shows the last one. */
Exit showFrames(const Settings& s, Console& console, Report& report) {
  std::vector<std::string> files = s.further;
  files.insert(files.begin(), s.input);
  FrameSequence frames(std::move(files), s.fit, s.min_component, s.viewer.isUncertainty(), console,
                       report);
  frames.start(0);
  if (frames.task() == nullptr) return Exit::usage(frames.error());
  if (Error error = checkDisplay()) return error;
  Viewer viewer(s.viewer, s.screenshot.empty());
  if (!s.screenshot.empty()) {
    if (Error error = viewer.showLast(frames)) return error;
    return viewer.saveScreenshot(s.screenshot);
  }
  viewer.scene().setPoints(frames.cloud().view(s.fit.use_normals),
                           s.fit.color ? colorsOf(frames.cloud()) : ColorView());
  viewer.begin();
  return viewer.runFrames(frames);
}

Error showModel(const Settings& s, Console& console, Model& model) {
  Viewer viewer(s.viewer, s.screenshot.empty());
  if (model.is_splats) {
    viewer.scene().setSplats(std::make_shared<SplatSet>(std::move(model.splats)));
  } else {
    auto surface = std::make_shared<SLIMSurface>(std::move(model.surface));
    leaveOutComponents(s.min_component, s.viewer.threads, {}, console, nullptr, *surface);
    if (!s.fit.params.trim) surface->dropTrimMaps();
    if (s.fit.params.hole_size != FitParams().hole_size)
      surface->closeHoles(s.fit.params.hole_size, s.fit.params.threads);
    if (Error error = paintForMode(s, *surface, console)) return error;
    viewer.scene().setSurface(surface);
  }
  viewer.begin();
  if (!s.screenshot.empty()) return viewer.saveScreenshot(s.screenshot);
  viewer.run();
  return {};
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.quiet);
  if (!s.further.empty()) {
    Report report(options, s.input, s.fit.params.threads);
    return showFrames(s, console, report);
  }
  Result<ModelFile> file = readModelFile(s.input, s.fit.input.file);
  if (!file) return Exit::usage(file.error());
  if (!holdsModel(*file)) {
    Report report(options, s.input, s.fit.params.threads);
    const Result<CloudFile> cloud =
        loadScan(s.input, s.fit, console, report, std::get_if<PointFile>(&*file));
    if (!cloud) return Exit::usage(cloud.error());
    if (Error error = checkDisplay()) return error;
    return showScan(s, *cloud, console, report);
  }
  console.begin("Loading " + s.input);
  Result<Model> model = modelOf(std::move(*file), s.input);
  if (!model) return Exit::usage(console.failed(model.error()));
  console.done(model->describe());
  const Result<BoundingSpheres> seen = s.viewer.region.within(model->spheres());
  if (!seen) return Exit::usage(seen.error());
  noteView(s, *seen, console);
  if (Error error = checkDisplay()) return error;
  return showModel(s, console, *model);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(
      options, argc, argv,
      {"show a smaller model", [&] { return finishSettings(s); }, [&] { return run(options, s); }});
}
