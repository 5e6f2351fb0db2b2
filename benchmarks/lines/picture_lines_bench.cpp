// SPDX-License-Identifier: BSD-3-Clause
// Lines in a picture: milliseconds a frame, and how far they drift over the surface when the camera
// turns. Drift is measured on lines of any length and strength: how long a line is seen changes with
// the view.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/run_program.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/surface/surface_io.h"
#include "picture_views.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::lines_bench;

struct Settings {
  std::string surface, picture;
  int width = 1000, height = 800, repeat = 7, threads = 2;
  PictureLineParams lines;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("picture_lines_bench", "1", "Measures lines in pictures.");
  options.positional("SURFACE.slim", &s.surface, "surface of pcl_slim_fit");
  options.integer("width", &s.width, 16, 8192, "pixels");
  options.integer("height", &s.height, 16, 8192, "pixels");
  options.integer("repeat", &s.repeat, 1, 1000, "frames to take the median of");
  options.integer("threads", &s.threads, 1, 256, "threads");
  options.number("crest", &s.lines.crest_curvature, 0, 1e6, "least curvature [1/L]; 0: automatic");
  options.number("suggestive", &s.lines.suggestive_derivative, 0, 1e9,
                 "least derivative [1/L^2]; 0: automatic");
  options.text("picture", &s.picture, "FILE.png", "draw the lines");
  return options;
}

/** The lines on white paper. */
Error savePicture(const Settings& s, const PictureView& view) {
  Image image;
  image.width = s.width;
  image.height = s.height;
  image.rgb.assign(static_cast<std::size_t>(3) * s.width * s.height, 255);
  if (Error error = drawLines(view.lines, {}, image)) return error;
  return saveImage(s.picture, image);
}

Error timeLines(const SLIMSurface& surface, const Settings& s, PictureView& view) {
  std::vector<double> times, cpu;
  for (int i = 0; i < s.repeat; ++i) {
    const double start = measure::wallSeconds(), cpu_start = measure::cpuSeconds();
    auto lines = findPictureLines(view.buffer, view.camera, surface, s.lines);
    if (!lines) return lines.error();
    times.push_back(1e3 * (measure::wallSeconds() - start));
    cpu.push_back(1e3 * (measure::cpuSeconds() - cpu_start));
    view.lines = std::move(*lines);
  }
  std::size_t vertices = 0;
  for (const PictureLine& line : view.lines) vertices += line.points.size();
  std::printf("%.1f ms of wall and %.1f of CPU time a frame, %zu lines of %zu vertices\n",
              measure::median(times), measure::median(cpu), view.lines.size(), vertices);
  return {};
}

/** A camera turned about its target, about its own upward axis. */
Camera turned(const Camera& camera, double degrees) {
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
  const Vector3 axis = normalized(camera.up);
  const Vector3 arm = subtract(camera.position, camera.look_at);
  const Vector3 across = cross(axis, arm);
  const Vector3 flat = scaled(axis, (1 - c) * dot(axis, arm));
  Camera other = camera;
  for (std::size_t k = 0; k < 3; ++k)
    other.position[k] = camera.look_at[k] + c * arm[k] + s * across[k] + flat[k];
  return other;
}

/** Pixels from a place to the nearest vertex of a view's lines of one kind. */
double distanceTo(const PictureView& view, PictureLineKind kind, const std::array<float, 2>& p) {
  double least = 1e9;
  for (const PictureLine& line : view.lines) {
    if (line.kind != kind) continue;
    for (const auto& q : line.points)
      least = std::min<double>(least, std::hypot(p[0] - q[0], p[1] - q[1]));
  }
  return least;
}

/** How far crest vertices of one view are from the nearest line of another one, pixels. */
std::vector<double> distancesTo(const PictureView& to, const std::vector<PictureLine>& seen) {
  std::vector<double> distances;
  for (const PictureLine& line : seen) {
    for (const auto& p : line.points) distances.push_back(distanceTo(to, line.kind, p));
  }
  return distances;
}

double percentNear(const std::vector<double>& distances) {
  const auto near =
      std::count_if(distances.begin(), distances.end(), [](double d) { return d <= 3.0; });
  return 100.0 * static_cast<double>(near) /
         static_cast<double>(std::max<std::size_t>(1, distances.size()));
}

/** The same view with the lines that the parameters keep. */
Error findLines(const SLIMSurface& surface, const PictureLineParams& params, PictureView& view) {
  auto lines = findPictureLines(view.buffer, view.camera, surface, params);
  if (!lines) return lines.error();
  view.lines = std::move(*lines);
  return {};
}

/** Drift is measured on lines of any length and strength; how many vertices are on a line that is
 * kept in the other view, too, is printed as well. */
Error printDrift(const SLIMSurface& surface, const Settings& s, const PictureView& from,
                 double degrees, PictureView& to) {
  const auto seen = projectLines(crestLinesInSpace(surface, from), to.buffer, to.camera, surface);
  if (!seen) return seen.error();
  if (Error error = findLines(surface, s.lines, to)) return error;
  const double kept = percentNear(distancesTo(to, *seen));
  PictureLineParams whole = s.lines;
  whole.min_length = 0;
  if (whole.crest_curvature == 0.0) whole.crest_curvature = 2.0;
  if (Error error = findLines(surface, whole, to)) return error;
  const std::vector<double> distances = distancesTo(to, *seen);
  std::printf(
      "turned by %g: %.1f %% of %zu crest vertices within 3 pixels of a line there, median %.2f "
      "pixels; %.1f %% of a line that is kept\n",
      degrees, percentNear(distances), distances.size(), measure::median(distances), kept);
  return {};
}

Exit run(Settings& s) {
  const auto surface = loadSlim(s.surface);
  if (!surface) return surface.error();
  s.lines.threads = s.threads;
  s.lines.crest = s.lines.suggestive = s.lines.contour = true;
  const BoundingSpheres object = spheresOf(*surface);
  PictureView view;
  view.camera = cameraFor(chooseView(object), object, {s.width, s.height});
  SurfaceRenderer renderer(*surface, s.threads);
  if (Error error = renderView(renderer, s.lines, view)) return error;
  if (Error error = timeLines(*surface, s, view)) return error;
  if (!s.picture.empty()) {
    if (Error error = savePicture(s, view)) return error;
  }
  for (const double degrees : {1.0, 3.0, 10.0}) {
    PictureView other;
    other.camera = turned(view.camera, degrees);
    if (Error error = renderView(renderer, s.lines, other)) return error;
    if (Error error = printDrift(*surface, s, view, degrees, other)) return error;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "use a smaller picture", [&] { return run(s); });
}
