// SPDX-License-Identifier: BSD-3-Clause
// splat_quality: how pictures of so many splats differ from pictures of all points, by method.
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "splats/methods.h"
#include "splats/picture_quality.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::measure;

struct Settings {
  std::string input;
  double share = 0.05;
  int size = 600;
  bool filtered = true, give_normals = true;
  std::vector<double> focus;
  std::string save, again;
};

/** Writes splats as <folder>/<method>.ply. */
bool save(const Settings& s, const std::string& method, const SplatSet& splats) {
  if (s.save.empty()) return true;
  std::string name;
  for (const char c : method) {
    if (c != ',') name += c == ' ' ? '_' : c;
  }
  const Error error =
      savePointFile(s.save + "/" + name + ".ply", toPointFile(splats, splatShift(splats)));
  if (error) std::fprintf(stderr, "splat_quality: %s\n", error.message.c_str());
  return !error;
}

/** One row of the table. */
void print(const std::string& method, const SplatSet& splats, const PictureDifference& d) {
  std::printf("| %s | %zu | %.3f | %.1f | %.4f | %.2f | %.2f | ", method.c_str(), splats.size(),
              d.mean, d.p95, 100.0 * d.holes, 100.0 * d.lost, 100.0 * d.extra);
  if (d.focus >= 0.0) std::printf("%.3f ", d.focus);
  std::printf("|\n");
  std::fflush(stdout);
}

bool measureMethods(const Settings& s, const ColoredScan& scan, const PictureComparison& pictures) {
  const auto wanted = static_cast<std::size_t>(s.share * static_cast<double>(scan.size()));
  std::printf("%s: %zu points, %.3g %% wanted, %zu views of %d x %d\n\n", s.input.c_str(),
              scan.size(), 100.0 * s.share, pictures.numViews(), s.size, s.size);
  std::printf("| method | splats | Delta E | 95 %% | holes %% | lost %% | extra %% | focus |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  DiscRenderParams render;
  render.filtered = s.filtered;
  for (const Method& method : comparedMethods()) {
    const SplatSet splats = splatsOf(scan, solvedFor(scan, method, wanted));
    print(method.name, splats, pictures.compare(splats, render));
    if (!save(s, method.name, splats)) return false;
  }
  return true;
}

/** The same object scanned again: pictures of two scans are no closer than this. */
bool measureAgain(const Settings& s, const PictureComparison& pictures) {
  if (s.again.empty()) return true;
  const Result<ColoredScan> scan = loadColoredScan(s.again);
  if (!scan) {
    std::fprintf(stderr, "splat_quality: %s\n", scan.error().message.c_str());
    return false;
  }
  const SplatSet every_point = everyPoint(*scan);
  print("scanned again", every_point, pictures.compare(every_point, DiscRenderParams()));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("splat_quality", "1",
                      "Pictures of splats beside those of all points, by method, at one count.");
  options.positional("IN.pcd|.ply", &s.input, "a coloured scan");
  options.number("share", &s.share, 1e-4, 1, "splats wanted, share of the points");
  options.integer("size", &s.size, 16, 8192, "pixels a side");
  options.toggle("filtered", &s.filtered, "blend splats; 0: the nearest as it is");
  options.toggle("give_normals", &s.give_normals,
                 "give the sampler the scan's normals, or PCL's; 0: it estimates its own");
  options.numbers("focus", &s.focus, "X,Y,Z,R", "a ball in which to measure besides");
  options.text("again", &s.again, "FILE", "the object scanned again: another row, its points");
  options.text("save", &s.save, "FOLDER", "write all splats, and all points as discs, there");
  if (const auto status = options.parse(argc, argv)) return *status;
  Result<ColoredScan> scan = loadColoredScan(s.input);
  if (!scan) {
    std::fprintf(stderr, "splat_quality: %s\n", scan.error().message.c_str());
    return kExitUsage;
  }
  scan->give_normals = s.give_normals;
  std::optional<Ball> focus;
  if (!s.focus.empty()) focus = Ball{{s.focus[0], s.focus[1], s.focus[2]}, s.focus[3]};
  const SplatSet every_point = everyPoint(*scan);
  const PictureComparison pictures(every_point, s.size, focus);
  const bool done = save(s, "all points", every_point) && measureMethods(s, *scan, pictures) &&
                    measureAgain(s, pictures);
  return done ? kExitDone : kExitFailed;
}
