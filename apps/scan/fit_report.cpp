// SPDX-License-Identifier: BSD-3-Clause
#include "scan/fit_job.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pcl_slim {

FittedPoints fittedPoints(const PointStore& store) {
  return {store.size(), store.diagonal() * store.scale(), store.memoryBytes(), store.statistics()};
}

namespace {

/** What a fit left out, and what it had no need to do. */
ReportValue skippedCounts(const FittedPoints& fitted, const FitStatistics& fit) {
  const PointStoreStatistics& points = fitted.statistics;
  return {{"non_finite", points.non_finite},
          {"far_away", points.far_away},
          {"without_normal", points.without_normal},
          {"duplicates", points.duplicates},
          {"sides",
           fit.sides.points > 0 && !fit.sides.for_cover ? 0 : fitted.stored - fit.sides.points},
          {"lone_normals", fit.skipped_normals},
          {"never_gathered", fit.never_gathered},
          {"levels", fit.levels_skipped}};
}

/** Shares of the points on leaves that face what could decide, where it is known. */
ReportValue sideShares(const SideStatistics& sides) {
  ReportValue::Object shares;
  if (sides.facing) shares.push_back({nameOf(sides.source), *sides.facing});
  if (sides.source != SideSource::kOrigin) shares.push_back({"origin", sides.facing_origin});
  shares.push_back({"outward", sides.facing_outward});
  return shares;
}

/** What was measured of the errors, and how points got their sides. */
void addMeasured(const FitStatistics& fit, Report& report) {
  report.add({{"lambda", fit.lambda},
              {"noise_error", fit.noise.error},
              {"noise_correlation", fit.noise.correlation},
              {"noise_correlation_error", fit.noise.correlation_error},
              {"noise_frames", fit.noise.frames},
              {"noise_line", fit.noise.line},
              {"noise_step", fit.noise.step},
              {"noise_neighbors", fit.noise.neighbors},
              {"noise_varies", fit.noise.varies},
              {"thin_places", fit.sides.thin_places},
              {"sides_from", nameOf(fit.sides.source)},
              {"sides_facing", sideShares(fit.sides)},
              {"opposed_normals", fit.sides.normals.opposed},
              {"overlap_edges", fit.sides.overlap_edges},
              {"sided", fit.sides.points},
              {"sided_confidence", fit.sides.confidence},
              {"sides_in_doubt", fit.sides.in_doubt},
              {"plane_neighbors", fit.sides.plane_neighbors},
              {"sheet_gap", fit.sides.gap},
              {"noise_share", fit.sides.noise_share}});
}

}  // namespace

void reportFit(const FittedPoints& fitted, const SLIMSurface& surface, const FitStatistics& fit,
               Report& report) {
  report.add({{"stored_points", fitted.stored},
              {"outliers", fit.outliers},
              {"surfels", surface.size()},
              {"leaves", fit.leaves},
              {"internals", fit.internals},
              {"levels", surface.numLevels()},
              {"first_level", fit.first_level},
              {"last_level", fit.last_level},
              {"leaves_per_level", fit.leaves_per_level},
              {"degree", surface.info.degree},
              {"penalty", fit.penalty},
              {"noise_factor", fit.noise_factor},
              {"t_mdl", fit.t_mdl},
              {"normal_error", fit.noise.normal_error}});
  addMeasured(fit, report);
  report.add({{"diagonal", fitted.diagonal},
              {"rms_error_over_diagonal", fit.rms_error},
              {"uncovered", fit.uncovered},
              {"unsupported", fit.unsupported},
              {"unresolved", fit.unresolved},
              {"support_limited", fit.support_limited},
              {"reduced_degree", fit.reduced_degree},
              {"split_sheets", fit.split_sheets},
              {"oriented", surface.info.oriented},
              {"fits", fit.fits},
              {"fell_by_support", fit.fell_by_support},
              {"fell_by_pivot", fit.fell_by_pivot},
              {"line_balls", fit.line_balls},
              {"least_pivot", fit.least_pivot},
              {"gathered", fit.gathered},
              {"open_leaves", fit.open_leaves},
              {"trim_bytes", surface.trim_maps.size()},
              {"texture_bytes", surface.textures.size()},
              {"store_bytes", fitted.store_bytes},
              {"working_bytes", fit.working_bytes}});
  report.set("skipped", skippedCounts(fitted, fit));
  report.time("outliers", fit.seconds.outliers);
  report.time("noise", fit.seconds.noise);
  report.time("sides", fit.seconds.sides);
  report.time("cover", fit.seconds.cover);
  report.time("links", fit.seconds.links);
  report.time("orient", fit.seconds.orient);
  report.time("trim", fit.seconds.trim);
}

void reportSurface(const std::string& path, const SLIMSurface& surface, Report& report) {
  report.add({{"surface", path},
              {"surfels", surface.size()},
              {"lambda", surface.info.lambda},
              {"diagonal", surface.info.diagonal * surface.info.scale}});
}

std::string counted(std::uint64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/** " +- 3 %" for a relative error; nothing where it is not known. */
static std::string errorText(double error) {
  if (!(error > 0)) return {};
  return " +- " + std::to_string(static_cast<int>(std::ceil(100 * error))) + " %";
}

std::string noiseText(double diagonal, const FitStatistics& fit) {
  char text[160];
  std::snprintf(text, sizeof(text), "noise %.3g RMS", std::sqrt(fit.lambda) * diagonal);
  std::string line = text + errorText(fit.noise.error);
  if (fit.noise.step > 0) {
    std::snprintf(text, sizeof(text), ", in steps of %.3g", fit.noise.step * diagonal);
    line += text;
  }
  const int decimals = fit.noise.correlation < 10 ? 1 : 0;
  std::snprintf(text, sizeof(text), ", correlated over %.*f points", decimals,
                fit.noise.correlation);
  line += fit.noise.correlation > 1 ? text + errorText(fit.noise.correlation_error) : ", white";
  if (fit.noise.frames > 0) line += " in each frame";
  if (fit.noise.line > 0) line += ", on scan lines";
  return line + (fit.noise.varies ? ", varying over the scan" : "");
}

std::string solvedText(const FitStatistics& fit, double diagonal) {
  char text[160];
  const bool in_unit = diagonal > 0;
  std::snprintf(text, sizeof(text),
                "solved: penalty %.3g, residual %.3g %s; -noise_factor %.6g repeats it",
                fit.penalty, fit.rms_error * (in_unit ? diagonal : 1),
                in_unit ? "RMS" : "of the diagonal", fit.noise_factor);
  return text;
}

std::string sidesText(const FitStatistics& fit) {
  if (fit.sides.points == 0) return "";
  char text[160];
  std::snprintf(
      text, sizeof(text), "thin parts: %llu points got a side %s, %.0f %% of neighbours agree",
      static_cast<unsigned long long>(fit.sides.points),
      fit.sides.for_cover ? "while leaves were fitted" : "first", 50 * (1 + fit.sides.confidence));
  std::string line = text;
  if (fit.sides.plane_neighbors > 0) {
    line += "; noisy: points were moved to planes of " + std::to_string(fit.sides.plane_neighbors) +
            " neighbours first";
  }
  if (fit.sides.noise_share < 1) {
    std::snprintf(text, sizeof(text), "; sheets %.1f spacings apart in doubt: smoothed less",
                  fit.sides.gap);
    line += text;
  }
  if (fit.sides.in_doubt) line += "; pictures show both sides";
  return line;
}

void printSideNotes(SideSource source, const NormalAgreement& normals, Console& console) {
  for (const std::string& note : sideNotes(source, normals, "-viewpoint X,Y,Z"))
    console.note("  " + note);
}

std::string skippedText(const PointStoreStatistics& points) {
  std::string text;
  const auto add = [&text](std::uint64_t count, const char* what) {
    if (count == 0) return;
    text += (text.empty() ? "points skipped: " : ", ") + std::to_string(count) + " " + what;
  };
  add(points.non_finite, "non-finite");
  add(points.far_away, "far away");
  add(points.without_normal, "without normal");
  add(points.duplicates, "duplicate");
  return text;
}

std::vector<std::string> coverNotes(const FitStatistics& fit) {
  std::vector<std::string> notes;
  if (fit.outliers > 0) {
    notes.push_back("  " + counted(fit.outliers, "outlier") +
                    " left out; -outliers 1 fits them, too");
  }
  if (fit.uncovered > 0) {
    constexpr double kMany = 0.02;  // share of the points
    const bool many = static_cast<double>(fit.uncovered) > kMany * static_cast<double>(fit.points);
    notes.push_back("  " + counted(fit.uncovered, "point") + " not covered, " +
                    std::to_string(fit.unsupported) + " of them inside no surfel: " +
                    (many ? "too few or scattered points around; -degree 1 or 2 needs fewer"
                          : "too few points around, as at rims and far from others"));
  }
  if (fit.unresolved > 0) {
    notes.push_back("  " + counted(fit.unresolved, "point") +
                    " in groups too small for the scan's width: fit them by themselves");
  }
  return notes;
}

std::vector<std::string> colorNotes(const SLIMSurface& surface) {
  const TextureStatistics textures = surface.textureStatistics();
  if (textures.leaves == 0) return {};
  const double points = static_cast<double>(std::max<std::uint64_t>(surface.info.num_points, 1));
  char text[160];
  std::snprintf(
      text, sizeof text,
      "  colours: textures on %llu of %llu leaves, %.1f texels a point, the finest %.3g wide",
      static_cast<unsigned long long>(textures.leaves),
      static_cast<unsigned long long>(surface.numLeaves()),
      static_cast<double>(textures.texels) / points, textures.finest);
  std::vector<std::string> notes = {text};
  if (textures.limited > 0) {
    notes.push_back("  colours: " + counted(textures.limited, "texture") + " at the most of " +
                    std::to_string(SurfelTexture::kMostSide) +
                    " texels a side: coarser than the points");
  }
  return notes;
}

}  // namespace pcl_slim
