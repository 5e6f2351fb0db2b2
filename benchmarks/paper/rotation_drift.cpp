// SPDX-License-Identifier: BSD-3-Clause
// What a rigid motion of the points changes (the paper: blending along rays is not invariant).
#include <algorithm>
#include <cmath>

#include "paper/study.h"

namespace pcl_slim::paper {

namespace {

/** Turns by 33 degrees about an axis askew. */
Vector3 turned(const Vector3& v, double sign) {
  const Vector3 axis = normalized({0.36, 0.48, 0.8});
  const double angle = sign * 33 * M_PI / 180, c = std::cos(angle), s = std::sin(angle);
  return along(along(scaled(v, c), s, cross(axis, v)), (1 - c) * dot(axis, v), axis);
}

Model turnedModel(const Model& model) {
  Model made = model;
  for (Vector3& p : made.points) p = turned(p, 1);
  for (std::size_t i = 0; i < made.normals.size(); i += 3) {
    const Vector3 n = turned({made.normals[i], made.normals[i + 1], made.normals[i + 2]}, 1);
    for (std::size_t a = 0; a < 3; ++a) made.normals[i + a] = static_cast<float>(n[a]);
  }
  return made;
}

/** What a point became, in the model's units. */
struct Placed {
  Vector3 position{}, normal{};
  double mean_curvature = 0;
  bool supported = false;
};

std::vector<Placed> placed(const Fitted& fitted) {
  const auto stored = fitted.store.storeOfInput();
  std::vector<Placed> made(stored.size());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i] == PointStore::kSkipped || fitted.projection.supported[stored[i]] == 0) continue;
    const auto& n = fitted.projection.normal[stored[i]];
    made[i].position =
        along(fitted.store.origin(), fitted.store.scale(), fitted.projection.position[stored[i]]);
    made[i].normal = {n[0], n[1], n[2]};
    made[i].mean_curvature = fitted.projection.curvature[stored[i]][0] / fitted.store.scale();
    made[i].supported = true;
  }
  return made;
}

/** Differences between two runs: RMS of positions over a length, median angle, median of relative
 * mean curvature. */
std::vector<std::string> differences(const std::vector<Placed>& a, const std::vector<Placed>& b,
                                     double diagonal) {
  double sum = 0;
  std::vector<double> angles, curvatures, sizes;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!a[i].supported || !b[i].supported) continue;
    const Vector3 step = subtract(a[i].position, turned(b[i].position, -1));
    sum += dot(step, step);
    const double cosine = dot(a[i].normal, turned(b[i].normal, -1));
    angles.push_back(57.29577951308232 * std::acos(std::clamp(cosine, -1.0, 1.0)));
    curvatures.push_back(std::abs(a[i].mean_curvature - b[i].mean_curvature));
    sizes.push_back(std::abs(a[i].mean_curvature));
  }
  const auto middle = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  const double rms = std::sqrt(sum / static_cast<double>(angles.size()));
  return {number("%.1e", rms / diagonal), number("%.3f", middle(angles)),
          number("%.1f %%", 100 * middle(curvatures) / middle(sizes))};
}

}  // namespace

Error rotationDrift(const StudySettings& settings) {
  Table table("What turning the points by 33 degrees changes (section 3)",
              {"model", "fit", "degree", "error of the fit / L", "positions, RMS / L",
               "normals, median, degrees", "mean curvature, median of its median"});
  for (const char* file : {"stanford_bunny_zipper.ply", "stanford_dragon_res2.ply"}) {
    const auto model = loadModel(settings, file);
    if (!model) return model.error();
    const Model other = turnedModel(*model);
    for (const int degree : {2, 3, 0}) {
      FitParams params;
      params.paper_mode = degree != 0;
      params.degree = unlessZero(degree);
      if (degree != 0) params.size = MDLThreshold{0.01};
      params.threads = settings.threads;
      const auto a = fitModel(*model, params), b = fitModel(other, params);
      if (!a) return a.error();
      if (!b) return b.error();
      const double diagonal = a->store.diagonal() * a->store.scale();
      std::vector<std::string> cells = {model->name, degree != 0 ? "paper, T .01" : "default",
                                        std::to_string(degree != 0 ? degree : 4),
                                        number("%.1e", projectionError(*a))};
      for (const auto& cell : differences(placed(*a), placed(*b), diagonal)) cells.push_back(cell);
      table.row(cells);
    }
  }
  return table.save(settings, "s37");
}

}  // namespace pcl_slim::paper
