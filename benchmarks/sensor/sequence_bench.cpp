// SPDX-License-Identifier: BSD-3-Clause
// Frames of a depth camera that moves in a room whose surfaces are known: time of a frame and errors
// of its smoothed points and normals, with the noise of the sensor kept from frame to frame and
// measured in each, and by PCL's classes for depth images.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/run_program.h"
#include "pcl_slim/scan/scan.h"
#include "rivals/depth_images.h"
#include "rivals/mls.h"
#include "sensor/sensor_errors.h"
#include "support/lab/bench.h"
#include "support/lab/sensor.h"

namespace {

using namespace pcl_slim;

struct Settings {
  int frames = 100, width = 640, box = 5, threads = 1, slow_every = 25;
  double sigma = 0.06;
  std::string radii_text = "0.03,0.06,0.12";
  std::vector<double> radii;
  bool rivals = true;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("sequence_bench", "1", "Measures the frames of a moving depth camera.");
  options.integer("frames", &s.frames, 2, 10000, "number of frames");
  options.integer("width", &s.width, 64, 4096, "columns; 3/4 as many rows, of 1280 720");
  options.integer("box", &s.box, 1, 15, "errors are shared by N x N pixels");
  options.number("sigma", &s.sigma, 0.001, 1, "RMS error of the disparity [px]");
  options.integer("threads", &s.threads, 1, 4096, "threads of ours; changes no error");
  options.toggle("rivals", &s.rivals, "measure PCL's classes, too");
  options.integer("slow_every", &s.slow_every, 1, 10000, "MLS is measured on every N-th frame");
  options.text("radii", &s.radii_text, "A,B", "search radii of MLS [m]");
  return options;
}

measure::DepthCamera cameraOf(const Settings& s) {
  measure::DepthCamera camera;
  camera.width = s.width;
  camera.height = s.width == 1280 ? 720 : 3 * s.width / 4;
  camera.focal = 585.0 * s.width / 640;
  camera.correlated_x = camera.correlated_y = s.box;
  camera.sigma = s.sigma;
  return camera;
}

/** A frame: the camera goes 1.5 m back and forth, sideways and up and turns by 23 degrees. */
measure::SensorScan frameOf(const Settings& s, int number) {
  const double phase = 2 * M_PI * number / s.frames;
  const Vector3 place{0.3 * std::sin(phase), -0.1 + 0.1 * std::cos(2 * phase),
                      -0.75 + 0.75 * std::cos(phase)};
  return scanByCamera(seenFrom(measure::namedSolids("room"), place, 0.2 * std::sin(3 * phase)),
                      cameraOf(s), static_cast<std::uint64_t>(1 + number));
}

/** Mean squares of errors, and times, over the frames measured. */
struct Row {
  std::string name;
  int frames = 0, measured_anew = 0;
  double position = 0, normal = 0;
  std::vector<double> cpu = {}, wall = {};

  void add(const measure::SensorErrors& errors) {
    ++frames;
    position += errors.position * errors.position;
    normal += errors.normal * errors.normal;
  }
  void print() const {
    if (frames == 0) return;
    std::printf("| %s | %d | %.0f | %.0f |", name.c_str(), frames, 1e3 * measure::median(cpu),
                1e3 * measure::median(wall));
    const double share = 1.0 / frames;
    std::printf(position > 0 ? " %.2f |" : " |", std::sqrt(share * position));
    std::printf(normal > 0 ? " %.2f |" : " |", std::sqrt(share * normal));
    std::printf(measured_anew > 0 ? " %d |\n" : " |\n", measured_anew);
  }
};

/** Runs a body and appends its times to a row. */
template <typename Body>
auto timed(Row& row, const Body& body) {
  const double cpu = measure::cpuSeconds(), wall = measure::wallSeconds();
  auto result = body();
  row.cpu.push_back(measure::cpuSeconds() - cpu);
  row.wall.push_back(measure::wallSeconds() - wall);
  return result;
}

CloudView viewOf(const measure::SensorScan& scan) {
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  view.sensor = scan.sensor;
  return view;
}

/** Fits and projects a frame, with normals. \param[in,out] noise the sensor's; null: it is measured
 */
Error smoothFrame(const Settings& s, const measure::SensorScan& scan,
                  std::optional<SensorNoise>* noise, Row& row) {
  FitParams params;
  params.trim = false;
  params.threads = s.threads;
  params.keep_sensor_noise = noise != nullptr;
  if (noise != nullptr) params.sensor_noise = *noise;
  FittedScan fitted;
  const auto projection = timed(row, [&]() -> Result<CloudProjection> {
    if (Error error = fitScan({viewOf(scan), {}}, params, fitted)) return error;
    return projectScan(viewOf(scan), fitted.surface, SurfaceOrigin::kFitted, params, {}, nullptr,
                       &fitted.store);
  });
  if (!projection) return projection.error();
  std::vector<Vector3> places, normals;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const ProjectedPoint point = projection->point(i);
    places.push_back(point.position);
    normals.push_back({point.normal[0], point.normal[1], point.normal[2]});
  }
  row.add(errorsOf(scan, places, normals));
  if (noise == nullptr) return {};
  row.measured_anew += fitted.statistics.noise.sensor_check != SensorCheck::kAgrees;
  if (fitted.statistics.noise.sensor_noise) *noise = fitted.statistics.noise.sensor_noise;
  return {};
}

std::vector<Vector3> pointsOf(const measure::SensorScan& scan) {
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < scan.size(); ++i)
    points.push_back({scan.points[3 * i], scan.points[3 * i + 1], scan.points[3 * i + 2]});
  return points;
}

/** Rows of PCL's classes, each with some settings. */
struct Rivals {
  std::vector<Row> bilateral, integral, both, mls;
};

constexpr double kSpatial[] = {5, 10, 20};     ///< sigma_s of the bilateral filter [px]
constexpr double kDepth[] = {0.03, 0.1};       ///< its sigma_r [m]
constexpr double kSmoothing[] = {10, 20, 40};  ///< of integral images [px]

std::string textOf(const char* what, double a, const char* unit) {
  char text[80];
  std::snprintf(text, sizeof text, "%s %g %s", what, a, unit);
  return text;
}

Rivals rivalRows(const Settings& s) {
  Rivals rivals;
  for (const double spatial : kSpatial) {
    for (const double depth : kDepth)
      rivals.bilateral.push_back(
          {textOf("`FastBilateralFilter`,", spatial, "px,") + textOf("", depth, "m")});
  }
  for (const double size : kSmoothing) {
    rivals.integral.push_back({textOf("`IntegralImageNormalEstimation`,", size, "px")});
    rivals.both.push_back(
        {textOf("the same after the bilateral filter (10 px, .1 m),", size, "px")});
  }
  for (const double radius : s.radii)
    rivals.mls.push_back({textOf("`MovingLeastSquares`, radius", radius, "m")});
  return rivals;
}

void measureRivals(const Settings& s, const measure::SensorScan& scan, bool slow, Rivals& rivals) {
  const rivals::DepthImage image{pointsOf(scan), static_cast<std::size_t>(s.width)};
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vector3> none(scan.size(), {kNone, kNone, kNone});
  std::size_t at = 0;
  rivals::DepthImage filtered = image;
  for (const double spatial : kSpatial) {
    for (const double depth : kDepth) {
      Row& row = rivals.bilateral[at++];
      const std::vector<Vector3> places =
          timed(row, [&] { return rivals::smoothByBilateralFilter(image, spatial, depth); });
      row.add(errorsOf(scan, places, none));
      if (spatial == kSpatial[1] && depth == kDepth[1]) filtered.points = places;
    }
  }
  for (std::size_t i = 0; i < rivals.integral.size(); ++i) {
    Row& raw = rivals.integral[i];
    const auto normals =
        timed(raw, [&] { return rivals::normalsByIntegralImages(image, kSmoothing[i]); });
    raw.add(errorsOf(scan, image.points, normals));
    Row& after = rivals.both[i];
    const auto smooth =
        timed(after, [&] { return rivals::normalsByIntegralImages(filtered, kSmoothing[i]); });
    after.add(errorsOf(scan, filtered.points, smooth));
  }
  for (std::size_t i = 0; i < rivals.mls.size() && slow; ++i) {
    const auto smoothed =
        timed(rivals.mls[i], [&] { return rivals::smoothByMls(image.points, 2, s.radii[i]); });
    rivals.mls[i].add(errorsOf(scan, smoothed.points, smoothed.normals));
  }
}

Exit run(const Settings& s) {
  measure::keepFreedMemory();
  Row kept{"the sensor's noise kept"}, alone{"each frame's noise measured"};
  Rivals rivals = rivalRows(s);
  std::optional<SensorNoise> noise;
  for (int number = 0; number < s.frames; ++number) {
    const measure::SensorScan scan = frameOf(s, number);
    if (Error error = smoothFrame(s, scan, &noise, kept)) return error;
    if (Error error = smoothFrame(s, scan, nullptr, alone)) return error;
    if (s.rivals) measureRivals(s, scan, number % s.slow_every == 0, rivals);
  }
  std::printf(
      "| | frames | CPU ms | wall ms | RMS position, mm | RMS normal, ° | measured |\n"
      "|---|---|---|---|---|---|---|\n");
  kept.print();
  alone.print();
  for (const auto* rows : {&rivals.bilateral, &rivals.integral, &rivals.both, &rivals.mls}) {
    for (const Row& row : *rows) row.print();
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer -frames", [&]() -> Exit {
    const Error error = measure::parseLists({{"radii", &s.radii_text, 1e-9, 1e9, false, &s.radii}});
    return error ? Exit::usage(error) : run(s);
  });
}
