// SPDX-License-Identifier: BSD-3-Clause
#include "scan/paint_job.h"

#include <cmath>
#include <cstdio>

#include "pcl_slim/fit/fit_colors.h"
#include "scan/fit_job.h"

namespace pcl_slim {

namespace {

constexpr double kBytesOfPoint = 120;  ///< that painting takes at most, beyond the loaded file

}  // namespace

void declarePaintOption(OptionTable& options, std::string& file) {
  options.text(
      "colors", &file, "FILE",
      "colours from another registered cloud, in place of the scan's own where it has points",
      FileUse::kRead);
}

Result<CloudFile> loadPaint(const std::string& file, Console& console, Report& report) {
  console.begin("Loading " + file);
  Result<CloudFile> paint = loadCloudFile(file);
  if (!paint) return console.failed(paint.error());
  if (colorsOf(*paint).bgr == nullptr) {
    return console.failed(
        badInput("'" + file + "' has no colours (rgb, rgba or red green blue); leave -colors out"));
  }
  report.add({{"colors_from", file}, {"colors_points", paint->size()}});
  report.time("load_colors", console.seconds());
  console.done(counted(paint->size(), "point"));
  return paint;
}

Error paintSurface(const CloudFile& paint, int threads, Console& console, Report& report,
                   SLIMSurface& surface) {
  const double bytes = kBytesOfPoint * static_cast<double>(paint.size());
  const std::string work = "painting with " + counted(paint.size(), "point");
  if (Error error = checkMemory(bytes, work)) return error;
  const bool had_colors = surface.hasColors();
  console.begin("Painting");
  const auto painted = paintColors(paint.view(), colorsOf(paint), threads, surface);
  if (!painted) return console.failed(painted.error());
  report.time("paint", console.seconds());
  report.add({{"colors_near", painted->points},
              {"painted_leaves", painted->painted},
              {"colors_normals_opposed", painted->normals_opposed},
              {"texture_bytes", surface.textures.size()}});
  const double percent =
      100.0 * static_cast<double>(painted->painted) / static_cast<double>(painted->leaves);
  char text[160];
  std::snprintf(text, sizeof(text), "%.1f %% of %llu leaves, by %llu points near them", percent,
                static_cast<unsigned long long>(painted->leaves),
                static_cast<unsigned long long>(painted->points));
  console.done(text);
  if (painted->painted < painted->leaves) {
    console.note(had_colors ? "  the other leaves keep the scan's own colours"
                            : "  the other leaves are grey");
  }
  if (painted->normals_opposed)
    console.note("  most normals of the painting cloud oppose the surface's: they were not used");
  for (const std::string& note : colorNotes(surface)) console.note(note);
  return {};
}

}  // namespace pcl_slim
