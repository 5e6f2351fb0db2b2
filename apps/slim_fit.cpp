// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fit: turns a scan into a SLIM surface.
#include "slim_fit.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/file_program.h"
#include "common/program.h"
#include "common/programs.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "scan/fit_job.h"
#include "scan/paint_job.h"
#include "scan/scan_files.h"
#include "scan/tile_fit.h"

namespace pcl_slim {

namespace {

namespace fs = std::filesystem;

struct Settings {
  ScanFiles files;
  FitJob job;
  std::string paint;  ///< another cloud whose colours the surface gets, or none
  TileRequest tiles;
  SlimRounding rounding;  ///< of a .slim
};

constexpr int kRoundedColors = 2;  ///< greatest error of colours in rounded files, of 255

OptionTable declareOptions(const char* program, Settings& s) {
  OptionTable options = programOptions(program);
  options.input("IN", &s.files.input, kScanHelp);
  options.output("OUT.pcd|.ply|.vtp|.pvtp|.slim", &s.files.output, "the surface", ".slim");
  declareFitOptions(options, s.job);
  declareTrimOptions(options, s.job);
  declareColorOption(options, s.job);
  if (s.tiles.ranks == nullptr) declarePaintOption(options, s.paint);
  declareTileOptions(options, s.tiles);
  if (s.tiles.ranks == nullptr) declarePlanOptions(options, s.tiles);
  options.number("quantize", &s.rounding.share, 0.001, 1,
                 "round a .slim to a sixth of its bytes: the surface moves by this share of its "
                 "residual; .1 suits most",
                 "off");
  options.integer("color_error", &s.rounding.color_error, 0, 32,
                  "greatest error of the colours in a .slim's textures, of 255",
                  "0, or 2 with -quantize");
  declareReport(options, s.files, s.tiles.ranks == nullptr);
  return options;
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(const OptionTable& options, Settings& s) {
  s.tiles.asked = options.given("tile_points");
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkSurfaceExtension(s.files.output)) return error;
  const bool in_slim = lowerExtension(s.files.output) == ".slim";
  if (s.rounding.share > 0.0 && !in_slim)
    return {ErrorCode::kBadArgument, "-quantize rounds .slim files alone; name one as output"};
  if (s.rounding.color_error > 0 && !in_slim)
    return {ErrorCode::kBadArgument, "-color_error is of .slim files alone; name one as output"};
  if (s.rounding.share > 0.0 && !options.given("color_error"))
    s.rounding.color_error = kRoundedColors;
  if (Error error = checkFilesDiffer(s.files, filesRead(s.job, {s.paint}))) return error;
  s.tiles.painted = !s.paint.empty();
  if (s.tiles.ranks != nullptr && s.tiles.ranks->rank() != 0) {
    s.files.quiet = true;  // only the first rank prints and writes
    s.files.output.clear();
    s.files.json.clear();
  }
  return {};
}

/** A name for the blocks of a surface that is written in another form. */
std::string scratchFile(const std::string& folder) {
  std::error_code code;
  const fs::path place = folder.empty() ? fs::temp_directory_path(code) : fs::path(folder);
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  return (place / ("pcl_slim-" + std::to_string(now) + ".slim")).string();
}

/** Brings blocks from a scratch file, which is removed, into pieces for ParaView. */
Exit savePieces(const Settings& s, const std::string& scratch, SlimBlockWriter& blocks,
                Console& console, Report& report) {
  Error error = blocks.finish();
  if (error) return exitOfTiles(error);
  SlimBlockReader reader;
  error = reader.open(scratch);
  std::error_code code;
  fs::remove(scratch, code);
  if (error) return exitOfTiles(error);
  return saveOutput(
      s.files.output, s.files.json, [&] { return saveSurfacePieces(s.files.output, reader); },
      std::to_string(blocks.surfels()) + " surfels, " +
          counted(reader.directory().blocks.size(), "piece"),
      console, report);
}

/** Fits by tiles; where the output is made of blocks, each tile is written once it is fitted. */
Exit fitTiles(const Settings& s, PointSource& source, Console& console, Report& report) {
  const std::string extension = lowerExtension(s.files.output);
  const bool pieces = extension == ".pvtp", in_blocks = pieces || extension == ".slim";
  const std::string file = pieces ? scratchFile(s.tiles.scratch) : s.files.output;
  SlimBlockWriter blocks;
  TiledSurface made;
  Error error;
  if (in_blocks) error = blocks.open(file, s.rounding);
  if (!error) {
    error =
        fitByTiles(source, s.job, s.tiles, console, report, in_blocks ? &blocks : nullptr, made);
  }
  if (error) return exitOfTiles(error);
  if (made.partial) return report.write(s.files.json);
  const auto save = [&] {
    return in_blocks ? blocks.finish() : saveSurface(s.files.output, made.surface);
  };
  const std::uint64_t surfels = in_blocks ? blocks.surfels() : made.surface.size();
  const Exit saved = pieces ? savePieces(s, file, blocks, console, report)
                            : saveOutput(s.files.output, s.files.json, save,
                                         std::to_string(surfels) + " surfels", console, report);
  if (saved.status == kExitDone && !s.tiles.plan.empty()) removePlan(s.tiles.plan);
  return saved;
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.files.quiet);
  Report report(options, s.files.input, s.job.params.threads);

  std::unique_ptr<PointSource> source;  // of a scan that is fitted by tiles
  if (Error error = openForTiles(s.files.input, s.job, s.tiles, console, source))
    return Exit::usage(error);
  if (source) return fitTiles(s, *source, console, report);

  const Result<CloudFile> scan = loadScan(s.files.input, s.job, console, report);
  if (!scan) return Exit::usage(scan.error());
  std::optional<CloudFile> paint;
  if (!s.paint.empty()) {
    Result<CloudFile> loaded = loadPaint(s.paint, console, report);
    if (!loaded) return Exit::usage(loaded.error());
    paint = std::move(*loaded);
  }
  SLIMSurface surface;
  if (Error error = fitScan(s.job, *scan, console, report, surface)) return error;
  if (paint) {
    if (Error error = paintSurface(*paint, s.job.params.threads, console, report, surface))
      return error.code == ErrorCode::kBadInput ? Exit::usage(error) : Exit(error);
  }
  if (surface.hasTextures() && lowerExtension(s.files.output) != ".slim")
    console.note("colours: one gradient a surfel in this format; .slim keeps the textures");
  return saveOutput(
      s.files.output, s.files.json,
      [&] { return saveSurface(s.files.output, surface, s.rounding); },
      std::to_string(surface.size()) + " surfels", console, report);
}

}  // namespace

int runFit(const char* program, int argc, const char* const* argv, Ranks* ranks) {
  Settings s;
  s.tiles.ranks = ranks;
  if (ranks != nullptr) s.job.params.threads = 1;
  OptionTable options = declareOptions(program, s);
  return runFileProgram(options, argc, argv,
                        {"use a smaller scan", [&] { return finishSettings(options, s); },
                         [&] { return run(options, s); }});
}

}  // namespace pcl_slim

#ifndef PCL_SLIM_FIT_MPI  // there the job's main(), in slim_fit_mpi.cpp, calls runFit()
int main(int argc, char** argv) {
  return pcl_slim::runFit("pcl_slim_fit", argc, argv, nullptr);
}
#endif
