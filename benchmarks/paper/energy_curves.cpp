// SPDX-License-Identifier: BSD-3-Clause
// E(r) and eps(r) of the paper's equation (3) at a flat, a curved and a complex place (Fig. 4): the
// published formulas alone, in double, apart from the library's fit.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "paper/study.h"

namespace pcl_slim::paper {

namespace {

constexpr int kRadii = 60;
constexpr double kLeastRadius = 0.004, kGreatestRadius = 0.1;  ///< of the diagonal
constexpr double kThreshold = 0.01;                            ///< T_MDL

/** The spline-patched Gaussian of the weights. */
double gaussianLike(double d) {
  if (d < 0.5) return std::exp(-8 * d * d);
  return d < 1 ? 16 * std::exp(-2.0) * std::pow(1 - d, 4) : 0;
}

/** Points and normals in units of the diagonal. */
struct Samples {
  std::vector<Eigen::Vector3d> points, normals;
};

Samples samplesOf(const Model& model) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
  for (const Vector3& p : model.points) {
    const Eigen::Map<const Eigen::Vector3d> q(p.data());
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  const double diagonal = (high - low).norm();
  Samples made;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> q(model.points[i].data());
    const Eigen::Map<const Eigen::Vector3f> n(&model.normals[3 * i]);
    made.points.emplace_back((q - low) / diagonal);
    made.normals.emplace_back(n.cast<double>());
  }
  return made;
}

/** Squared local error eps(r)^2 of a polynomial of this degree, 1 or 2; negative: too few points.
 */
double squaredError(const Samples& samples, const Eigen::Vector3d& c, double r, int degree) {
  std::vector<std::size_t> inside;
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if ((samples.points[i] - c).squaredNorm() >= r * r) continue;
    inside.push_back(i);
    w += samples.normals[i];
  }
  const int terms = degree == 1 ? 3 : 6;
  if (inside.size() < 2u * static_cast<unsigned>(terms) || w.norm() == 0) return -1;
  w.normalize();
  const Eigen::Vector3d u = w.unitOrthogonal(), v = w.cross(u);
  Eigen::MatrixXd a(inside.size(), terms);
  Eigen::VectorXd h(inside.size()), weight(inside.size());
  for (std::size_t k = 0; k < inside.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Eigen::Vector3d d = (samples.points[inside[k]] - c) / r;
    const double x = d.dot(u), y = d.dot(v);
    a.row(row).head(3) << 1, x, y;
    if (degree == 2) a.row(row).tail(3) << x * x, x * y, y * y;
    h[row] = d.dot(w);
    weight[row] = gaussianLike(d.norm());
  }
  const Eigen::VectorXd root = weight.cwiseSqrt();
  const Eigen::VectorXd fit =
      (root.asDiagonal() * a).colPivHouseholderQr().solve(root.asDiagonal() * h);
  return r * r * (weight.array() * (h - a * fit).array().square()).sum() / weight.sum();
}

/** The paper's lambda: the mean smallest eigenvalue of the covariance of a point and its ten
 * nearest. */
double noiseVariance(const Samples& samples) {
  double sum = 0;
  constexpr std::size_t kProbes = 400;
  const std::size_t n = samples.points.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const Eigen::Vector3d& c = samples.points[probe * n / kProbes];
    std::nth_element(
        order.begin(), order.begin() + 10, order.end(), [&](std::size_t i, std::size_t j) {
          return (samples.points[i] - c).squaredNorm() < (samples.points[j] - c).squaredNorm();
        });
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (int k = 0; k <= 10; ++k) mean += samples.points[order[k]] / 11;
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (int k = 0; k <= 10; ++k) {
      const Eigen::Vector3d d = samples.points[order[k]] - mean;
      moments += d * d.transpose() / 11;
    }
    sum += Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvalues()[0];
  }
  return sum / kProbes;
}

/** Places by kind: the least residual of a plane; a large one that a quadratic takes away; the 95th
 * percentile of what a quadratic leaves. */
std::vector<std::size_t> choosePlaces(const Samples& samples) {
  constexpr std::size_t kCandidates = 300;
  constexpr double kRadius = 0.05;
  struct Candidate {
    std::size_t point;
    double plane, quadric;
  };
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < kCandidates; ++i) {
    const std::size_t point = i * samples.points.size() / kCandidates;
    const double plane = squaredError(samples, samples.points[point], kRadius, 1);
    const double quadric = squaredError(samples, samples.points[point], kRadius, 2);
    if (plane > 0 && quadric > 0) all.push_back({point, plane, quadric});
  }
  const auto flat = std::min_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.plane < b.plane; });
  const auto curved = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.plane / a.quadric < b.plane / b.quadric;
  });
  std::vector<std::size_t> places = {flat->point, curved->point};
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.quadric < b.quadric; });
  places.push_back(all[all.size() * 95 / 100].point);
  return places;
}

struct Curves {
  std::vector<double> r, e, energy;

  std::size_t minimum() const {
    return static_cast<std::size_t>(std::min_element(energy.begin(), energy.end()) -
                                    energy.begin());
  }
  /** Inner minima of the energy, as the bracket rule (4) may meet them. */
  int minima() const {
    int count = 0;
    for (std::size_t i = 1; i + 1 < energy.size(); ++i) {
      count += energy[i] < energy[i - 1] && energy[i] < energy[i + 1];
    }
    return count;
  }
  /** How high the energy rises between two of its minima, as a factor; 1: there is but one. */
  double rise() const {
    double most = 1;
    for (std::size_t top = 1; top + 1 < energy.size(); ++top) {
      const auto at = energy.begin() + static_cast<std::ptrdiff_t>(top);
      const double left = *std::min_element(energy.begin(), at);
      const double right = *std::min_element(at, energy.end());
      most = std::max(most, *at / std::max(left, right));
    }
    return most;
  }
};

Curves curvesAt(const Samples& samples, const Eigen::Vector3d& c, double lambda) {
  Curves made;
  for (int i = 0; i < kRadii; ++i) {
    const double r = kLeastRadius * std::pow(kGreatestRadius / kLeastRadius, i / (kRadii - 1.0));
    const double squared = squaredError(samples, c, r, 2);
    if (squared < 0) continue;
    made.r.push_back(r);
    made.e.push_back(std::sqrt(squared));
    made.energy.push_back(std::sqrt(squared + lambda * kThreshold * kThreshold / (r * r)));
  }
  return made;
}

/** The vertex of those looked at where the energy's minima are parted best. */
std::size_t placeOfTwoMinima(const Samples& samples, double lambda) {
  constexpr std::size_t kCandidates = 250;
  std::size_t best = 0;
  double most = 0;
  for (std::size_t i = 0; i < kCandidates; ++i) {
    const std::size_t point = (2 * i + 1) * samples.points.size() / (2 * kCandidates);
    const double rise = curvesAt(samples, samples.points[point], lambda).rise();
    if (rise > most) best = point;
    most = std::max(most, rise);
  }
  return best;
}

}  // namespace

Error energyCurves(const StudySettings& settings) {
  const auto model = loadModel(settings, "stanford_dragon_res2.ply");
  if (!model) return model.error();
  const Samples samples = samplesOf(*model);
  const double lambda = noiseVariance(samples);
  std::vector<std::size_t> places = choosePlaces(samples);
  places.push_back(placeOfTwoMinima(samples, lambda));
  const std::vector<std::string> titles = {"flat", "curved", "complex", "several minima"};
  Table table("E(r) and eps(r) of quadratics on the dragon, T = .01, lambda = " +
                  number("%.2e", lambda) + " (Fig. 4)",
              {"place", "point", "r of least E / L", "eps there / L", "eps at L/10 / L", "minima"});
  std::vector<std::vector<Curve>> panels;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Curves curves = curvesAt(samples, samples.points[places[k]], lambda);
    const std::size_t least = curves.minimum();
    table.row({titles[k], std::to_string(places[k]), number("%.4f", curves.r[least]),
               number("%.2e", curves.e[least]), number("%.2e", curves.e.back()),
               std::to_string(curves.minima())});
    panels.push_back({{"&#8730;E(r)", "#c33", curves.r, curves.energy},
                      {"&#949;(r)", "#36c", curves.r, curves.e}});
  }
  if (Error error = table.save(settings, "fig04")) return error;
  return savePlot(settings.out + "/fig04.svg", titles, panels, "r / L", "error / L");
}

}  // namespace pcl_slim::paper
