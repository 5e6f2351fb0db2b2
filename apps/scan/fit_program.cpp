// SPDX-License-Identifier: BSD-3-Clause
#include "scan/fit_program.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "scan/scan_program.h"
#include "scan/tile_fit.h"

namespace pcl_slim {

namespace {

namespace fs = std::filesystem;

struct Settings {
  ScanFiles files;
  FitJob job;
  TileRequest tiles;
  double rounding = 0.0;                ///< of a .slim
  std::unique_ptr<PointSource> source;  ///< of a scan that is fitted by tiles
};

OptionTable declareOptions(const char* program, const char* version, Settings& s) {
  OptionTable options(program, version,
                      "Fits a sparse set of local polynomials (a SLIM surface) to a scan.");
  options.positional("IN", &s.files.input, kScanHelp);
  options.positional("OUT.pcd|.ply|.vtp|.pvtp|.slim", &s.files.output, "the surface");
  declareFitOptions(options, s.job);
  declareTrimOptions(options, s.job);
  declareColorOption(options, s.job);
  declareTileOptions(options, s.tiles);
  if (s.tiles.ranks == nullptr) declarePlanOptions(options, s.tiles);
  options.number("quantize", &s.rounding, 0.001, 1,
                 "round a .slim to a sixth of its bytes: the surface moves by this share of its "
                 "residual; .1 suits most",
                 "off");
  declareReport(options, s.files);
  return options;
}

/** Checks the options that can be checked before the input is read. */
Error checkSettings(Settings& s) {
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkSurfaceExtension(s.files.output)) return error;
  if (s.rounding > 0.0 && lowerExtension(s.files.output) != ".slim")
    return {ErrorCode::kBadArgument, "-quantize rounds .slim files alone; name one as output"};
  if (Error error = checkFilesDiffer(s.files, filesRead(s.job))) return error;
  if (s.tiles.ranks == nullptr || s.tiles.ranks->rank() == 0) return {};
  s.files.quiet = true;  // only the first rank prints and writes
  s.files.output.clear();
  s.files.json.clear();
  return {};
}

Error makeSurface(const Settings& s, const CloudFile& cloud, Console& console, Report& report,
                  ScanResult& result) {
  const auto surface = std::make_shared<SLIMSurface>();
  if (Error error = fitScan(s.job, cloud, console, report, *surface)) return error;
  result.save = [&s, surface] { return saveSurface(s.files.output, *surface, s.rounding); };
  result.detail = std::to_string(surface->size()) + " surfels";
  return {};
}

Result<bool> openScan(Settings& s, bool asked, Console& console) {
  s.tiles.asked = asked;
  s.tiles.max_memory = s.files.max_memory;
  if (Error error = openForTiles(s.files.input, s.job, s.tiles, console, s.source)) return error;
  return s.source != nullptr;
}

/** A name for the blocks of a surface that is written in another form. */
std::string scratchFile(const std::string& folder) {
  std::error_code code;
  const fs::path place = folder.empty() ? fs::temp_directory_path(code) : fs::path(folder);
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  return (place / ("pcl_slim-" + std::to_string(now) + ".slim")).string();
}

/** Brings blocks from a scratch file, which is removed, into pieces for ParaView. */
Error makePieces(const Settings& s, const std::string& file, SlimBlockWriter& blocks,
                 ScanResult& result) {
  if (Error error = blocks.finish()) return error;
  const auto reader = std::make_shared<SlimBlockReader>();
  Error error = reader->open(file);
  std::error_code code;
  fs::remove(file, code);
  if (error) return error;
  result.save = [&s, reader] { return saveSurfacePieces(s.files.output, *reader); };
  result.detail = std::to_string(blocks.surfels()) + " surfels, " +
                  counted(reader->directory().blocks.size(), "piece");
  return {};
}

Error streamSurface(const Settings& s, Console& console, Report& report, ScanResult& result) {
  const auto made = std::make_shared<TiledSurface>();
  const auto blocks = std::make_shared<SlimBlockWriter>();
  const std::string extension = lowerExtension(s.files.output);
  const bool pieces = extension == ".pvtp", in_blocks = pieces || extension == ".slim";
  const std::string file = pieces ? scratchFile(s.tiles.scratch) : s.files.output;
  if (in_blocks) {
    if (Error error = blocks->open(file, s.rounding)) return error;
  }
  if (Error error = fitByTiles(*s.source, s.job, s.tiles, console, report,
                               in_blocks ? blocks.get() : nullptr, *made))
    return error;
  result.report_only = made->partial;
  if (pieces && !made->partial) {
    if (Error error = makePieces(s, file, *blocks, result)) return error;
  } else if (in_blocks) {
    result.save = [blocks] { return blocks->finish(); };
    result.detail = std::to_string(blocks->surfels()) + " surfels";
  } else {
    result.save = [&s, made] { return saveSurface(s.files.output, made->surface); };
    result.detail = std::to_string(made->surface.size()) + " surfels";
  }
  if (!s.tiles.plan.empty() && !made->partial) result.done = [&s] { removePlan(s.tiles.plan); };
  return {};
}

}  // namespace

int runFitProgram(const char* program, const char* version, int argc, const char* const* argv,
                  Ranks* ranks) {
  Settings s;
  s.tiles.ranks = ranks;
  if (ranks != nullptr) s.job.params.threads = 1;
  OptionTable options = declareOptions(program, version, s);
  return runScanProgram(
      options, argc, argv, s.files, s.job, s.job.params.threads,
      {[&] { return checkSettings(s); },
       {},
       [&](const CloudFile* cloud, auto&... stage) { return makeSurface(s, *cloud, stage...); },
       [&](Console& console) { return openScan(s, options.given("tile_points"), console); },
       [&](auto&... stage) { return streamSurface(s, stage...); }});
}

}  // namespace pcl_slim
