// SPDX-License-Identifier: BSD-3-Clause
// Shading along parabolic lines, where one curvature is 0, by degree at equal numbers of floats.
#include <cmath>

#include "paper/study.h"
#include "support/lab/scenes.h"

namespace pcl_slim::paper {

namespace {

/** RMS errors of normals, degrees, and of mean curvature, near the circles of a torus where its
 * Gaussian curvature vanishes, and elsewhere; and how far off the line is where the surface's does.
 */
struct Errors {
  double normal[2] = {0, 0}, curvature[2] = {0, 0};
  double offset = 0;  ///< RMS, radii of the tube
};

constexpr double kNear = 0.1;  ///< half the height of the band, in radii of the tube

bool byParabolicLine(const measure::Truth& truth) {
  // The parabolic circles are where the normal is the torus' axis.
  return std::abs(truth.normal[2]) > std::sqrt(1 - kNear * kNear);
}

Errors errorsOf(const Fitted& fitted) {
  Errors errors;
  double count[2] = {0, 0};
  for (std::size_t i = 0; i < fitted.store.size(); ++i) {
    if (fitted.projection.supported[i] == 0) continue;
    const Vector3 p =
        along(fitted.store.origin(), fitted.store.scale(), fitted.projection.position[i]);
    const measure::Truth truth = measure::truthAt(measure::Shape::kTorus, p);
    const auto& n = fitted.projection.normal[i];
    const double sine = length(cross(truth.normal, {n[0], n[1], n[2]}));
    const double k = fitted.projection.curvature[i][0] / fitted.store.scale();
    const int where = byParabolicLine(truth) ? 0 : 1;
    // K = cos b / (r (R + r cos b)) with R = 1, r = .4; across the circle it falls by 1/(R r) per
    // radian of b.
    const double cosine =
        std::hypot(truth.normal[0], truth.normal[1]) * (std::hypot(p[0], p[1]) < 1 ? -1 : 1);
    const double exact = cosine / (0.4 * (1 + 0.4 * cosine));
    const double gauss =
        fitted.projection.curvature[i][1] / (fitted.store.scale() * fitted.store.scale());
    if (where == 0) errors.offset += std::pow(0.4 * (gauss - exact), 2);
    errors.normal[where] += std::pow(57.29577951308232 * std::asin(std::min(1.0, sine)), 2);
    errors.curvature[where] += std::pow(k - truth.mean_curvature, 2);
    ++count[where];
  }
  errors.offset = std::sqrt(errors.offset / count[0]);
  for (int where = 0; where < 2; ++where) {
    errors.normal[where] = std::sqrt(errors.normal[where] / count[where]);
    errors.curvature[where] = std::sqrt(errors.curvature[where] / count[where]);
  }
  return errors;
}

}  // namespace

Error parabolicLines(const StudySettings& settings) {
  constexpr int kFloats = 14000;
  const measure::Scene scene = measure::makeScene(measure::Shape::kTorus, 100000, 0, 0, 7);
  Model model;
  for (std::size_t i = 0; i < scene.points.size(); i += 3) {
    model.points.push_back({scene.points[i], scene.points[i + 1], scene.points[i + 2]});
  }
  model.normals = scene.normals;
  Table table("A torus in at most " + std::to_string(kFloats) +
                  " floats: RMS errors by its parabolic circles and elsewhere",
              {"degree", "leaves", "normals by the circles, degrees", "elsewhere",
               "mean curvature by the circles", "elsewhere", "offset of K = 0, tube radii"});
  for (int degree = 1; degree <= 4; ++degree) {
    FitParams params;
    params.degree = degree;
    params.size = MaxSurfels{static_cast<std::uint64_t>(kFloats / floatsOf(degree))};
    params.threads = settings.threads;
    const auto fitted = fitModel(model, params);
    if (!fitted) return fitted.error();
    const Errors e = errorsOf(*fitted);
    table.row({std::to_string(degree), std::to_string(fitted->statistics.leaves),
               number("%.3f", e.normal[0]), number("%.3f", e.normal[1]),
               number("%.3f", e.curvature[0]), number("%.3f", e.curvature[1]),
               number("%.4f", e.offset)});
  }
  return table.save(settings, "s43");
}

}  // namespace pcl_slim::paper
