// SPDX-License-Identifier: BSD-3-Clause
// What a fit finds in a scan and in the same scan turned, moved, scaled, rounded, thinned, cropped
// and merged: noise, correlation, leaves and smoothed points should be those of the scan.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "common/run_program.h"
#include "continuity/variants.h"

namespace {

using namespace pcl_slim;
using continuity::Scan;
using continuity::Variant;
using continuity::Varied;
using measure::SmoothedPoints;

constexpr double kSigmaTolerance = 0.1, kTolerance = 0.15, kMoveTolerance = 0.5;
constexpr double kLeastUnit = 1e-5;  ///< of moves, for scans without noise [L]

struct Settings {
  std::string scans, data, sensors, only;
  int points = 0, threads = 0, seed = 1;
  bool outside = false;
  double correlation = 0;

  FitParams params() const {
    FitParams params;
    params.threads = threads;
    if (correlation > 0) params.noise_correlation = correlation;
    return params;
  }
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("continuity_bench", "1",
                      "Compares fits of scans with fits of the same scans changed.");
  options.text("scan", &s.scans, "FILE,...", "scans, .pcd or .ply");
  options.text("data", &s.data, "FOLDER", "every scan in a folder");
  options.text("sensors", &s.sensors, "TEXT", "generated scans whose names contain this");
  options.text("only", &s.only, "TEXT", "variants whose names contain this; all if empty");
  options.integer(
      "points", &s.points, 0, 1000000000,
      "reduce scans to this many points first: images to their middle, others at random", "all");
  options.toggle("outside", &s.outside, "print only rows outside the tolerances");
  options.number("correlation", &s.correlation, 0, 1e6,
                 "points that share an error, of every fit; 0: from the data");
  options.integer("seed", &s.seed, 0, 1000000, "seed of turns, subsets and generated scans");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  return options;
}

/** RMS distance of a variant's smoothed points from the scan's, moved along [units of the scan]. */
double moved(const SmoothedPoints& original, const Varied& varied, const SmoothedPoints& smoothed) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < varied.source.size(); ++i) {
    const auto& q = original.points[varied.source[i]];
    const auto& p = smoothed.points[i];
    const Eigen::Vector3d expected = varied.map * Eigen::Map<const Eigen::Vector3d>(q.data());
    const double d = (Eigen::Map<const Eigen::Vector3d>(p.data()) - expected).squaredNorm();
    if (!std::isfinite(d)) continue;
    sum += d;
    ++count;
  }
  return std::sqrt(sum / count) / varied.scale;
}

/** 1 inside [low, high]; else the ratio to the nearer end. */
double ratioTo(double value, double low, double high) {
  return value / std::clamp(value, std::min(low, high), std::max(low, high));
}

bool isOff(double ratio, double tolerance) {
  return !(ratio < 1 + tolerance && ratio > 1 / (1 + tolerance));
}

/** "1.23", or "1.23 *" if it is off. */
std::string marked(double value, bool off) {
  char text[32];
  std::snprintf(text, sizeof(text), off ? "%.3g *" : "%.3g", value);
  return text;
}

struct Tally {
  int rows = 0, outside = 0;
};

Error printRow(const Settings& s, const Scan& scan, const SmoothedPoints& original,
               const Variant& variant, Tally& tally) {
  const Varied varied = variant.make(scan, original);
  if (varied.points.empty()) return {};
  std::optional<Eigen::Vector3d> sensor;
  if (scan.sensor) sensor = varied.map * *scan.sensor;
  if (varied.sensor) sensor = varied.sensor;
  const auto smoothed =
      continuity::smooth(varied.points, varied.floats, sensor, varied.origins, s.params());
  if (!smoothed) return smoothed.error();
  const FitStatistics &a = original.fit, &b = smoothed->fit;
  const double unit = std::max(original.sigma, kLeastUnit * scan.box().diagonal().norm());
  const double sigma =
      std::max(smoothed->sigma / varied.scale, unit * 1e-3) / std::max(original.sigma, unit * 1e-3);
  // Where it differs in this part of the scan, sigma may follow or stay.
  const double least = std::min({1.0, varied.sigma[0], varied.sigma[1]});
  const double most = std::max({1.0, varied.sigma[0], varied.sigma[1]});
  const bool sigma_off = isOff(ratioTo(sigma, least, most), kSigmaTolerance);
  // At another density N and leaves may follow the density or stay.
  const double n = ratioTo(b.noise.correlation, a.noise.correlation,
                           std::max(1.0, a.noise.correlation * varied.density));
  const double leaves =
      ratioTo(static_cast<double>(b.leaves), varied.leaves, varied.leaves * varied.density);
  const bool n_off = isOff(n, kTolerance), leaves_off = isOff(leaves, kTolerance);
  const double move = moved(original, varied, *smoothed) / unit;
  const bool move_off = !(move < kMoveTolerance);
  const bool outside = sigma_off || n_off || leaves_off || move_off;
  ++tally.rows;
  tally.outside += outside;
  if (s.outside && !outside) return {};
  std::printf("| %s | %zu | %s | %.3g to %.3g | %.1f | %s | %llu | %s | %s |\n",
              variant.name.c_str(), varied.points.size(), marked(sigma, sigma_off).c_str(),
              varied.sigma[0], varied.sigma[1], b.noise.correlation, marked(n, n_off).c_str(),
              static_cast<unsigned long long>(b.leaves), marked(leaves, leaves_off).c_str(),
              marked(move, move_off).c_str());
  std::fflush(stdout);
  return {};
}

Error printScan(const Settings& s, Scan scan, Tally& tally) {
  const auto seed = static_cast<std::uint64_t>(s.seed);
  if (s.points > 0) continuity::reduce(static_cast<std::size_t>(s.points), seed, scan);
  const auto original = continuity::smooth(scan.points, scan.floats, scan.sensor, {}, s.params());
  if (!original) return original.error();
  std::printf(
      "\n%s: %zu points, sigma %.4g (%.2e L), N %.1f, %llu leaves, %.2f s\n\n"
      "| variant | points | sigma ratio | expected | N | ratio | leaves | ratio | RMS move, sigma "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      scan.name.c_str(), scan.points.size(), original->sigma,
      original->sigma / scan.box().diagonal().norm(), original->fit.noise.correlation,
      static_cast<unsigned long long>(original->fit.leaves), original->seconds);
  for (const Variant& variant : continuity::allVariants(seed)) {
    if (variant.name.find(s.only) == std::string::npos) continue;
    if (Error error = printRow(s, scan, *original, variant, tally)) return error;
  }
  return {};
}

Result<std::vector<std::string>> scanFiles(const Settings& s) {
  std::vector<std::string> files;
  std::istringstream list(s.scans);
  for (std::string file; std::getline(list, file, ',');) files.push_back(file);
  if (s.data.empty()) return files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(s.data, failure)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".pcd" || kind == ".ply") files.push_back(entry.path().string());
  }
  if (failure) return Error{ErrorCode::kIo, s.data + ": " + failure.message()};
  std::sort(files.begin(), files.end());
  return files;
}

Exit run(const OptionTable& options, const Settings& s) {
  if (!options.given("scan") && !options.given("data") && !options.given("sensors")) {
    return {kExitUsage, "nothing to compare; give -scan, -data or -sensors"};
  }
  const auto files = scanFiles(s);
  if (!files) return files.error();
  Tally tally;
  for (const std::string& file : *files) {
    auto scan = continuity::loadScan(file);
    if (!scan) return scan.error();
    if (Error error = printScan(s, std::move(*scan), tally)) return error;
  }
  if (!s.sensors.empty()) {
    for (Scan& scan : continuity::generatedScans(s.sensors, static_cast<std::uint64_t>(s.seed))) {
      if (Error error = printScan(s, std::move(scan), tally)) return error;
    }
  }
  std::printf("\n%d of %d rows outside (*): sigma 10 %%, N and leaves 15 %%, moves .5 sigma\n",
              tally.outside, tally.rows);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer -points", [&] { return run(options, s); });
}
