// SPDX-License-Identifier: BSD-3-Clause
// What ellipsoids would save in place of balls (future work of the paper).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "paper/study.h"

namespace pcl_slim::paper {

namespace {

constexpr int kDegree = 2;
constexpr double kExtraFloats =
    3;  ///< of an ellipsoid: aspect ratios and a direction, beside a ball

/** Points of a cylinder of radius 1 and height 6, with exact normals and noise. */
Model cylinderModel(std::size_t count, double noise) {
  Model model;
  model.name = "cylinder";
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, noise);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * uniform(random), r = 1 + normal(random);
    const Vector3 n = {std::cos(angle), std::sin(angle), 0};
    model.points.push_back({r * n[0], r * n[1], 6 * uniform(random)});
    for (const double x : n) model.normals.push_back(static_cast<float>(x));
  }
  return model;
}

double diagonalOf(const Model& model) {
  Vector3 low = model.points.front(), high = low;
  for (const Vector3& p : model.points) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  return length(subtract(high, low));
}

Model stretched(const Model& model, std::size_t axis, double factor) {
  Model made = model;
  for (Vector3& p : made.points) p[axis] *= factor;
  for (std::size_t i = 0; i < made.normals.size(); i += 3) {
    Vector3 n = {made.normals[i], made.normals[i + 1], made.normals[i + 2]};
    n[axis] /= factor;
    n = normalized(n);
    for (std::size_t a = 0; a < 3; ++a) made.normals[i + a] = static_cast<float>(n[a]);
  }
  return made;
}

/** RMS distance of the points from the surface's tangent planes, measured where nothing is
 * stretched. */
double errorUnstretched(const Fitted& fitted, std::size_t axis, double factor) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < fitted.store.size(); ++i) {
    if (fitted.projection.supported[i] == 0) continue;
    Vector3 step = subtract(fitted.projection.position[i], fitted.store.position(i));
    const auto& found = fitted.projection.normal[i];
    Vector3 normal = {found[0], found[1], found[2]};
    step[axis] /= factor;
    normal[axis] *= factor;
    const double distance = dot(step, normalized(normal));
    sum += distance * distance;
    ++count;
  }
  return fitted.store.scale() * std::sqrt(sum / static_cast<double>(count));
}

Error sweepStretched(const Model& model, std::size_t axis, double factor, double least, int threads,
                     LeafSweep& sweep) {
  const Model made = stretched(model, axis, factor);
  for (int i = 0; i < 14; ++i) {
    FitParams params;
    params.degree = kDegree;
    params.threads = threads;
    params.lambda = std::pow(0.0064 / std::pow(2.0, i), 2);
    const auto fitted = fitModel(made, params);
    if (!fitted) return fitted.error();
    const double error = errorUnstretched(*fitted, axis, factor);
    if (!sweep.error.empty() && error > 0.97 * sweep.error.back()) continue;
    sweep.error.push_back(error);
    sweep.leaves.push_back(static_cast<double>(fitted->statistics.leaves));
    if (error < least) break;
  }
  return {};
}

/** Leaves at equal error with every ball stretched alike along one axis. */
Error addStretched(const Model& model, std::size_t axis, const std::vector<double>& errors,
                   const StudySettings& settings, Table& table) {
  std::vector<LeafSweep> sweeps;
  const std::vector<double> supports = {0.5, 1, 1.5, 2, 4};
  for (const double support : supports) {
    sweeps.emplace_back();
    if (Error error = sweepStretched(model, axis, 1 / support, errors.front() * diagonalOf(model),
                                     settings.threads, sweeps.back())) {
      return error;
    }
  }
  for (const double error : errors) {
    std::vector<std::string> cells = {model.name, std::string(1, "xyz"[axis]), number("%g", error)};
    for (const LeafSweep& sweep : sweeps) {
      const double leaves = sweep.leavesAt(error * diagonalOf(model));
      cells.push_back(leaves < 0 ? "out of reach" : number("%.0f", leaves));
    }
    table.row(cells);
  }
  return {};
}

/** Cubic and quartic terms of a height over the unit disc: coefficients of u^a v^b by b. */
struct Terms {
  std::array<double, 4> cubic{};
  std::array<double, 5> quartic{};
};

/** The terms over an ellipse of the unit disc's area, brought back to a disc: u, v by matrix m. */
Terms mapped(const Terms& terms, double aspect, double angle) {
  const double a = std::sqrt(aspect), c = std::cos(angle), s = std::sin(angle);
  const std::array<double, 2> u = {c * a, -s / a}, v = {s * a, c / a};
  const auto times = [](const std::vector<double>& p, const std::array<double, 2>& q) {
    std::vector<double> made(p.size() + 1, 0.0);
    for (std::size_t i = 0; i < p.size(); ++i) {
      made[i] += p[i] * q[0];
      made[i + 1] += p[i] * q[1];
    }
    return made;
  };
  const auto add = [&](const auto& from, auto& to) {
    for (std::size_t b = 0; b < from.size(); ++b) {
      std::vector<double> power = {from[b]};
      for (std::size_t k = b + 1; k < from.size(); ++k) power = times(power, u);
      for (std::size_t k = 0; k < b; ++k) power = times(power, v);
      for (std::size_t i = 0; i < to.size(); ++i) to[i] += power[i];
    }
  };
  Terms made;
  add(terms.cubic, made.cubic);
  add(terms.quartic, made.quartic);
  return made;
}

/** Mean squares of what the best quadric leaves of the terms over the unit disc: cubic, quartic
 * part. In polar harmonics r^3 cos 3t has 1/8, (r^3 - 2/3 r) cos t 1/72, r^4 cos 4t 1/10, (r^4 -
 * 3/4 r^2) cos 2t 1/160 and r^4 - r^2 + 1/6 1/180. */
std::array<double, 2> leftByQuadric(const Terms& t) {
  const auto& c = t.cubic;
  const auto& q = t.quartic;
  const auto squares = [](double x, double y) { return x * x + y * y; };
  const double third = squares((c[0] - c[2]) / 4, (c[1] - c[3]) / 4);
  const double first = squares((3 * c[0] + c[2]) / 4, (3 * c[3] + c[1]) / 4);
  const double fourth = squares((q[0] - q[2] + q[4]) / 8, (q[1] - q[3]) / 8);
  const double second = squares((q[0] - q[4]) / 2, (q[1] + q[3]) / 4);
  const double none = (3 * q[0] + q[2] + 3 * q[4]) / 8;
  return {third / 8 + first / 72, fourth / 10 + second / 160 + none * none / 180};
}

/** How much larger the ellipse may be than the disc for the same residual, at most four times. */
double areaGained(const Terms& terms, double aspect, double angle) {
  const auto disc = leftByQuadric(terms), ellipse = leftByQuadric(mapped(terms, aspect, angle));
  double low = 0.05, high = 4;
  for (int step = 0; step < 40; ++step) {
    const double g = 0.5 * (low + high);
    const bool fits = (ellipse[0] + ellipse[1] * g) * g * g * g <= disc[0] + disc[1];
    (fits ? low : high) = g;
  }
  return low;
}

/** Aspect and angle of the ellipse that gains most. */
std::array<double, 2> bestEllipse(const Terms& terms) {
  std::array<double, 2> best = {1, 0};
  double most = 1;
  for (const double aspect : {1.25, 1.5, 2.0, 2.5, 3.0, 4.0}) {
    for (int k = 0; k < 24; ++k) {
      const double angle = k * M_PI / 24, gained = areaGained(terms, aspect, angle);
      if (gained <= most) continue;
      most = gained;
      best = {aspect, angle};
    }
  }
  return best;
}

/** Terms of the quartic that fits the rows first, first + stride, ... of u, v, w best. */
Terms fitTerms(const std::vector<Vector3>& points, std::size_t first, std::size_t stride) {
  const auto rows = static_cast<Eigen::Index>((points.size() - first + stride - 1) / stride);
  Eigen::MatrixXd powers(rows, 15);
  Eigen::VectorXd heights(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Vector3& p = points[first + static_cast<std::size_t>(i) * stride];
    Eigen::Index column = 0;
    for (int degree = 0; degree <= 4; ++degree) {
      for (int b = 0; b <= degree; ++b) {
        powers(i, column++) = std::pow(p[0], degree - b) * std::pow(p[1], b);
      }
    }
    heights(i) = p[2];
  }
  const Eigen::VectorXd found = powers.colPivHouseholderQr().solve(heights);
  Terms terms;
  for (std::size_t k = 0; k < 4; ++k) terms.cubic[k] = found(static_cast<Eigen::Index>(6 + k));
  for (std::size_t k = 0; k < 5; ++k) terms.quartic[k] = found(static_cast<Eigen::Index>(10 + k));
  return terms;
}

/** The points in a leaf's ball, in its frame and in radii. */
std::vector<Vector3> pointsOf(const Fitted& fitted, std::uint32_t leaf) {
  const SLIMSurface& s = fitted.surface;
  const Vector3 center = {s.cx[leaf], s.cy[leaf], s.cz[leaf]};
  const Vector3 w = {s.nx[leaf], s.ny[leaf], s.nz[leaf]};
  const Vector3 across = std::abs(w[0]) < 0.6 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
  const Vector3 u = normalized(cross(across, w)), v = cross(w, u);
  const double r = s.radius[leaf];
  std::vector<Vector3> made;
  for (std::size_t i = 0; i < fitted.store.size(); ++i) {
    const Vector3 d = subtract(fitted.store.position(i), center);
    if (dot(d, d) < r * r) made.push_back({dot(d, u) / r, dot(d, v) / r, dot(d, w) / r});
  }
  return made;
}

/** What each leaf's own best ellipse gains, by all of its points, and by half of them as judged by
 * the rest. */
Error addLeaves(const Model& model, double t_mdl, const StudySettings& settings, Table& table) {
  FitParams params;
  params.degree = kDegree;
  params.threads = settings.threads;
  params.paper_mode = t_mdl > 0;
  if (t_mdl > 0) params.size = MDLThreshold{t_mdl};
  const auto fitted = fitModel(model, params);
  if (!fitted) return fitted.error();
  const auto leaves = fitted->surface.leaves();
  const std::size_t stride = std::max<std::size_t>(1, leaves.size() / 600);
  std::vector<double> all, judged;
  std::size_t looked = 0;
  std::mt19937_64 random(3);
  for (std::size_t k = 0; k < leaves.size(); k += stride) {
    ++looked;
    auto points = pointsOf(*fitted, leaves[k]);
    if (points.size() < 40) continue;
    std::shuffle(points.begin(), points.end(), random);
    const Terms whole = fitTerms(points, 0, 1), half = fitTerms(points, 0, 2),
                rest = fitTerms(points, 1, 2);
    const auto best = bestEllipse(whole), guess = bestEllipse(half);
    all.push_back(areaGained(whole, best[0], best[1]));
    judged.push_back(areaGained(rest, guess[0], guess[1]));
  }
  const auto needed = [](const std::vector<double>& gains) {
    double sum = 0;
    for (const double g : gains) sum += 1 / g;
    return sum / static_cast<double>(gains.size());
  };
  if (all.empty()) return {};
  std::sort(all.begin(), all.end());
  const double own = floatsOf(kDegree), more = (own + kExtraFloats) / own;
  table.row(
      {model.name, t_mdl > 0 ? "paper, T " + number("%g", t_mdl) : "default",
       std::to_string(leaves.size()),
       number("%.0f %%", 100.0 * static_cast<double>(all.size()) / static_cast<double>(looked)),
       number("%.2f", all[all.size() / 4]), number("%.2f", all[all.size() / 2]),
       number("%.2f", all[3 * all.size() / 4]), number("%.2f", needed(all)),
       number("%.2f", needed(judged)), number("%.2f", more * needed(all)),
       number("%.2f", more * needed(judged))});
  return {};
}

}  // namespace

Error ellipsoidalSupports(const StudySettings& settings) {
  std::vector<Model> models = {cylinderModel(100000, 0.002)};
  for (const char* file :
       {"terrain_isprs_csite1_utm.pcd", "lone_star_geyser_tls.pcd", "armadillo_50k.ply",
        "stanford_dragon_res2.ply", "lion_takanawa.pcd", "stanford_bunny_raw_scans.pcd"}) {
    auto model = loadModel(settings, file);
    if (!model) return model.error();
    models.push_back(std::move(*model));
  }
  Table own("Area that each leaf's own ellipse gains at equal residual, quadratics (S46)",
            {"model", "fit", "leaves", "looked at", "area gained, lower quartile", "median",
             "upper quartile", "leaves, of balls'", "judged by other points", "floats",
             "judged by other points"});
  for (const Model& model : models) {
    if (Error error = addLeaves(model, 0, settings, own)) return error;
    if (Error error = addLeaves(model, 0.05, settings, own)) return error;
  }
  if (Error error = own.save(settings, "s46_leaves")) return error;
  Table one(
      "Leaves at equal error with all balls stretched along one axis, quadratics (S46)",
      {"model", "axis", "error / L", "half as long", "balls", "1.5 times", "2 times", "4 times"});
  models.front() = cylinderModel(100000, 0);
  for (const std::size_t which : {0, 1, 3, 4}) {
    // The cylinder's axis and the terrain's heights; which axis does best is not known of the
    // others.
    for (const std::size_t axis : {2, 1, 0}) {
      if (axis != 2 && which < 3) continue;
      const auto errors = which == 0 ? std::vector{1e-5, 5e-5} : std::vector{3e-4, 1e-3};
      if (Error error = addStretched(models[which], axis, errors, settings, one)) return error;
    }
  }
  return one.save(settings, "s46_axis");
}

}  // namespace pcl_slim::paper
