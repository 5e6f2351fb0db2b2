// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_sample: spreads points evenly over a scan's SLIM surface.
#include <cmath>
#include <utility>

#include "common/memory_limit.h"
#include "common/program.h"
#include "common/run_program.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/query/surface_samples.h"
#include "scan/cloud_fields.h"
#include "scan/fit_report.h"
#include "scan/scan_program.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kMostSamples = 100000000;

struct Settings {
  ScanFiles files;
  FitJob job;
  SurfaceSampleParams sampling;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("pcl_slim_sample", PCL_SLIM_VERSION,
                      "Spreads points evenly over the SLIM surface of a scan: blue noise.");
  options.positional("IN", &s.files.input, "a scan, or a surface made by pcl_slim_fit");
  options.positional("OUT.pcd|.ply|.las|.vtp", &s.files.output,
                     "the points, with normals, mean and Gaussian curvature");
  options.number("spacing", &s.sampling.spacing, 1e-300, 1e300,
                 "least distance of two points, in the scan's units", "off");
  options.integer("number", &s.sampling.count, 0, kMostSamples,
                  "how many points, in place of -spacing; 0: as the spacing says");
  declareFitOptions(options, s.job);
  declareTrimOptions(options, s.job);
  declareColorOption(options, s.job);
  declareReport(options, s.files);
  options.exclusive({"spacing", "number"});
  return options;
}

/** What can be said before the input is touched. */
Error
checkSettings(Settings& s)
{
  if (Error error = finishFitOptions(s.job)) return error;
  s.sampling.seed = s.job.params.seed;
  s.sampling.threads = s.job.params.threads;
  if (s.sampling.spacing == 0 && s.sampling.count == 0)
    return {ErrorCode::kBadArgument, "say how many points: give -spacing or -number"};
  if (Error error = s.sampling.validate()) return error;
  if (Error error = checkPointExtension(s.files.output, true)) return error;
  return checkFilesDiffer(s.files, s.job.trajectory);
}

/** The surface in a file, if it holds one; found says so. */
Error
readSurface(const std::string& path, bool& found, SLIMSurface& surface)
{
  found = lowerExtension(path) == ".slim";
  Result<SLIMSurface> made = SLIMSurface();
  if (found) {
    made = loadSurface(path);
  } else {
    const Result<PointFile> file = loadPointFile(path);
    if (!file) return file.error();
    found = findField(file->cloud, "c0") >= 0;
    if (found) made = surfaceFrom(*file);
  }
  if (!made) return made.error();
  surface = std::move(*made);
  return {};
}

/** Points are doubles where floats would move them by a share of their spacing. */
PointFile
toFile(const SurfaceSamples& samples)
{
  constexpr double kShare = 1e-4;
  double largest = 0;
  for (const auto& p : samples.position) {
    for (const double c : p) largest = std::max(largest, std::abs(c));
  }
  const bool far = std::ldexp(largest, -24) > kShare * samples.spacing;
  PointFile file;
  file.cloud.width = static_cast<pcl::uindex_t>(samples.size());
  file.cloud.height = 1;
  file.cloud.is_dense = 1;
  const std::uint8_t real = pcl::PCLPointField::FLOAT32, wide = pcl::PCLPointField::FLOAT64;
  file = withRealFields(file, {"x", "y", "z"}, far ? wide : real);
  file = withRealFields(
      file, {"normal_x", "normal_y", "normal_z", "curvature", "gaussian_curvature"}, real);
  if (!samples.color.empty()) file = withRealFields(file, {"rgb"}, real);
  std::vector<FieldWriter> fields;
  for (const auto& field : file.cloud.fields) fields.emplace_back(file.cloud, field.name);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      fields[a].set(i, samples.position[i][a]);
      fields[3 + a].set(i, samples.normal[i][a]);
    }
    fields[6].set(i, samples.curvature[i][0]);
    fields[7].set(i, samples.curvature[i][1]);
    if (samples.color.empty()) continue;
    auto* bgr = file.cloud.data.data() + i * file.cloud.point_step + file.cloud.fields[8].offset;
    for (std::size_t c = 0; c < 3; ++c) bgr[2 - c] = samples.color[i][c];
  }
  return file;
}

Error
sample(const Settings& s, const SLIMSurface& surface, Console& console, Report& report,
       SurfaceSamples& samples)
{
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

int
run(int argc, char** argv)
{
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  const auto leave = [&](int status, const Error& error) {
    return fail(options.program(), status, error.message);
  };
  Error error = checkSettings(s);
  if (!error) error = limitMemory(s.files.max_memory);
  if (error) return leave(kExitUsage, error);
  Console console(s.files.quiet);
  Report report(options.program(), options.version(), s.files.input,
                resolveThreads(s.job.params.threads));
  SLIMSurface surface;
  bool found = false;
  error = readSurface(s.files.input, found, surface);
  if (error) return leave(kExitUsage, error);
  Result<CloudFile> cloud = CloudFile();
  if (!found) cloud = loadScan(s.files.input, s.job, console, report);
  if (!cloud) return leave(kExitUsage, cloud.error());
  error = checkOutputs(s.files.output, s.files.json);
  if (error) return leave(kExitFailed, error);

  if (!found) error = fitScan(s.job, *cloud, console, report, surface);
  if (found) reportSurface(s.files.input, surface, report);
  if (found && options.given("hole")) surface.closeHoles(s.job.params.hole_size);
  if (found && !s.job.params.trim) surface.dropTrimMaps();
  SurfaceSamples samples;
  if (!error && !console.interrupted()) error = sample(s, surface, console, report, samples);
  if (console.interrupted())
    return fail(options.program(), kExitInterrupted, "stopped; nothing is written");
  if (!error) {
    error = saveOutput(
        s.files.output, s.files.json,
        [&] { return savePointFile(s.files.output, toFile(samples)); },
        std::to_string(samples.size()) + " points", console, report);
  }
  return error ? failWork(options.program(), error) : kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  return pcl_slim::guarded("pcl_slim_sample", "use a larger -spacing",
                           [&] { return run(argc, argv); });
}
