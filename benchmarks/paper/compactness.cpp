// SPDX-License-Identifier: BSD-3-Clause
// Bytes of a surface beside those of its points, rounded and not (the abstract's compactness).
#include <algorithm>
#include <cmath>

#include "paper/study.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim::paper {

namespace {

constexpr const char* kFiles[] = {
    "stanford_bunny_zipper.ply",  "armadillo_50k.ply", "stanford_dragon_res2.ply",
    "angel_real_scan.ply",        "lion_takanawa.pcd", "stanford_bunny_raw_scans.pcd",
    "azure_kinect_organized.pcd",
};
constexpr double kPi = 3.14159265358979323846;
constexpr double kFloatBytes = 12.0;  ///< of a point: x, y, z

/** Median and 95th percentile of the angles between two projections' normals, degrees. */
std::array<double, 2>
turned(const Projection& before, const Projection& after)
{
  std::vector<double> angles;
  for (std::size_t i = 0; i < before.normal.size(); ++i) {
    const auto &p = before.normal[i], &q = after.normal[i];
    const Vector3 a = {p[0], p[1], p[2]}, b = {q[0], q[1], q[2]};
    angles.push_back(std::atan2(length(cross(a, b)), std::abs(dot(a, b))) * 180.0 / kPi);
  }
  std::sort(angles.begin(), angles.end());
  return {angles[angles.size() / 2], angles[angles.size() * 19 / 20]};
}

Error
addModel(const Model& model, bool compact, const StudySettings& settings, Table& table)
{
  FitParams params;
  params.threads = settings.threads;
  if (compact) params.cover_radius = 1.0;
  auto fitted = fitModel(model, params);
  if (!fitted) return fitted.error();
  const double error = projectionError(*fitted);
  const double cloud = kFloatBytes * static_cast<double>(model.points.size());
  const Projection exact = fitted->projection;
  const SLIMSurface surface = fitted->surface;
  for (const double rounding : {0.0, 0.1, 0.2, 0.3, 0.5}) {
    const auto bytes = encodeSlim(surface, rounding);
    auto decoded = decodeSlim(bytes.data(), bytes.size());
    if (!decoded) return decoded.error();
    fitted->surface = std::move(*decoded);
    ProjectionParams how;
    how.curvature = true;
    how.threads = settings.threads;
    if (Error e = projectPoints(fitted->store, fitted->surface, how, fitted->projection)) return e;
    const auto size = static_cast<double>(bytes.size());
    const auto angles = turned(exact, fitted->projection);
    table.row({model.name + (compact ? ", -compact 1" : ""), std::to_string(model.points.size()),
               std::to_string(surface.size()), number("%g", rounding), number("%.0f", size),
               number("%.1f", size / static_cast<double>(surface.size())),
               number("%.3f", size / cloud), number("%.2e", error),
               number("%.4f", projectionError(*fitted) / error), number("%.3f", angles[0]),
               number("%.3f", angles[1])});
  }
  return {};
}

}  // namespace

Error
compactness(const StudySettings& settings)
{
  Table table("Bytes of a surface (compactness)",
              {"model", "points", "surfels", "rounding", "bytes", "a surfel", "of float x y z",
               "error / L", "times the error", "normals, median, degrees", "95th percentile"});
  for (const char* file : kFiles) {
    const auto model = loadModel(settings, file);
    if (!model) return model.error();
    for (const bool compact : {false, true}) {
      if (Error error = addModel(*model, compact, settings, table)) return error;
    }
  }
  return table.save(settings, "compactness");
}

}  // namespace pcl_slim::paper
