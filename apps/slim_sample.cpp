// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_sample: spreads points evenly over a scan's SLIM surface.
#include <cmath>
#include <optional>

#include "common/file_program.h"
#include "common/program.h"
#include "common/programs.h"
#include "pcl_slim/cloud/neighbor_planes.h"
#include "pcl_slim/query/surface_samples.h"
#include "scan/cloud_file.h"
#include "scan/fit_job.h"
#include "scan/scan_files.h"
#include "scan/small_components.h"
#include "scan/surface_input.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kMostSamples = 100000000;

struct Settings {
  ScanFiles files;
  FitJob job;
  SurfaceSampleParams sampling;
  double min_component = kLeastComponentPoints;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_sample");
  options.input("IN", &s.files.input, "a scan, or a surface made by pcl_slim_fit");
  options.output("OUT.pcd|.ply|.las|.vtp", &s.files.output,
                 "the points, with normals and curvatures", ".ply");
  options.number("spacing", &s.sampling.spacing, 1e-300, 1e300,
                 "least distance of two points, in the scan's units", "off");
  options.integer("number", &s.sampling.count, 0, kMostSamples,
                  "how many points, in place of -spacing; 0: as the spacing says");
  declareFitOptions(options, s.job);
  declareTrimOptions(options, s.job);
  declareComponentOption(options, s.min_component);
  declareColorOption(options, s.job);
  declareReport(options, s.files);
  options.exclusive({"spacing", "number"});
  return options;
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(Settings& s) {
  if (Error error = finishFitOptions(s.job)) return error;
  s.sampling.seed = s.job.params.seed;
  s.sampling.threads = s.job.params.threads;
  if (s.sampling.spacing == 0 && s.sampling.count == 0)
    return {ErrorCode::kBadArgument, "say how many points: give -spacing or -number"};
  if (Error error = s.sampling.validate()) return error;
  if (Error error = checkPointExtension(s.files.output, true)) return error;
  return checkFilesDiffer(s.files, filesRead(s.job));
}

/** Points are doubles where floats would move them by a share of their spacing. */
PointFile toFile(const SurfaceSamples& samples, int threads) {
  constexpr double kShare = 1e-4;
  double largest = 0;
  for (const auto& p : samples.position) {
    for (const double c : p) largest = std::max(largest, std::abs(c));
  }
  const bool far = std::ldexp(largest, -24) > kShare * samples.spacing;
  PointFile file;
  file.cloud.width = static_cast<std::uint32_t>(samples.size());
  file.cloud.height = 1;
  const std::uint8_t real = kFloat32, wide = kFloat64;
  file = withRealFields(file, {"x", "y", "z"}, far ? wide : real);
  file = withRealFields(
      file,
      {"normal_x", "normal_y", "normal_z", "curvature", "mean_curvature", "gaussian_curvature"},
      real);
  if (!samples.color.empty()) file = withRealFields(file, {"rgb"}, real);
  std::vector<FieldWriter> fields;
  for (const auto& field : file.cloud.fields) fields.emplace_back(file.cloud, field.name);
  CloudView places;
  places.xyz = samples.position.data();
  places.xyz_stride = sizeof(samples.position[0]);
  places.scalar = CloudView::Scalar::kDouble;
  places.size = samples.size();
  const std::vector<float> variation = surfaceVariation(places, threads);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      fields[a].set(i, samples.position[i][a]);
      fields[3 + a].set(i, samples.normal[i][a]);
    }
    fields[6].set(i, std::isnan(variation[i]) ? 0.0f : variation[i]);
    fields[7].set(i, samples.curvature[i][0]);
    fields[8].set(i, samples.curvature[i][1]);
    if (samples.color.empty()) continue;
    auto* bgr = file.cloud.data.data() + i * file.cloud.point_step + file.cloud.fields[9].offset;
    for (std::size_t c = 0; c < 3; ++c) bgr[2 - c] = samples.color[i][c];
  }
  return file;
}

Error sample(const Settings& s, const SLIMSurface& surface, Console& console, Report& report,
             SurfaceSamples& samples) {
  console.begin("Sampling");
  if (Error error = sampleSurface(surface, s.sampling, samples, &console.progress()))
    return console.failed(error);
  report.time("sample", console.seconds());
  report.add({{"samples", samples.size()},
              {"spacing", samples.spacing},
              {"candidates", samples.candidates}});
  console.done(std::to_string(samples.size()) + " points");
  return {};
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.files.quiet);
  Report report(options, s.files.input, s.job.params.threads);

  ScanOrSurface input;
  if (Error error = loadScanOrSurface(s.files.input, s.job, console, report, input))
    return Exit::usage(error);
  if (input.surface) {
    if (options.given("hole")) input.surface->closeHoles(s.job.params.hole_size);
    if (!s.job.params.trim) input.surface->dropTrimMaps();
  } else if (Error error = fitScan(s.job, *input.scan, console, report, input.surface.emplace())) {
    return error;
  }
  SLIMSurface& surface = *input.surface;
  leaveOutComponents(s.min_component, s.job.params.threads, {}, console, &report, surface);

  SurfaceSamples samples;
  if (Error error = sample(s, surface, console, report, samples)) return error;
  return saveOutput(
      s.files.output, s.files.json,
      [&] { return savePointFile(s.files.output, toFile(samples, s.sampling.threads)); },
      std::to_string(samples.size()) + " points", console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(
      options, argc, argv,
      {"use a smaller scan", [&] { return finishSettings(s); }, [&] { return run(options, s); }});
}
