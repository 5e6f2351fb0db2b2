// SPDX-License-Identifier: BSD-3-Clause
#include "projection/error_polynomials.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

using Matrix = Eigen::MatrixXd;

constexpr int kNodes = 48;       ///< a side, of the sums over a leaf's disc
constexpr double kRidge = 1e-4;  ///< of the diagonal: terms that the data leave open stay finite
constexpr std::uint32_t kRound = ~std::uint32_t{0};

/** \brief A polynomial in u and v up to a degree, by the powers of its terms. */
class Bivariate {
 public:
  explicit Bivariate(int degree)
      : degree_(degree), terms_(static_cast<std::size_t>((degree + 1) * (degree + 1))) {}

  int degree() const { return degree_; }
  double& at(int i, int j) { return terms_[static_cast<std::size_t>(i * (degree_ + 1) + j)]; }

  /** \brief The terms in the order of Horner's rule. */
  std::vector<float> forHorner() {
    std::vector<float> terms;
    for (int i = degree_; i >= 0; --i) {
      for (int j = degree_ - i; j >= 0; --j) terms.push_back(static_cast<float>(at(i, j)));
    }
    return terms;
  }

  /** \brief Those in u^2 + v^2 of a polynomial that is the same in all directions, likewise. */
  std::vector<float> alongRadius() {
    std::vector<float> terms;
    for (int i = degree_; i >= 0; i -= 2) terms.push_back(static_cast<float>(at(i, 0)));
    return terms;
  }

 private:
  int degree_;
  std::vector<double> terms_;
};

/** \brief A term of a derivative of sum c_k m_k: factor u^i v^j times c_k. */
struct DerivedTerm {
  int k, i, j;
  double factor;
};

/** The derivative d^a/du^a d^b/dv^b of all monomials. */
std::vector<DerivedTerm> derivative(int degree, int a, int b) {
  const auto falling = [](int power, int times) {
    double factor = 1;
    for (int t = 0; t < times; ++t) factor *= power - t;
    return factor;
  };
  std::vector<DerivedTerm> terms;
  for (int d = 0, k = 0; d <= degree; ++d) {
    for (int j = 0; j <= d; ++j, ++k) {
      const int i = d - j;
      if (i >= a && j >= b) terms.push_back({k, i - a, j - b, falling(i, a) * falling(j, b)});
    }
  }
  return terms;
}

/** Adds the variance of a derivative, its terms^T C terms. */
void addForm(const std::vector<DerivedTerm>& terms, const Matrix& covariance, Bivariate& sum) {
  for (const DerivedTerm& p : terms) {
    for (const DerivedTerm& q : terms) {
      sum.at(p.i + q.i, p.j + q.j) += p.factor * q.factor * covariance(p.k, q.k);
    }
  }
}

ErrorPolynomials polynomialsOf(int degree, const Matrix& covariance, bool round) {
  const auto stored = [round](Bivariate& sum) {
    return round ? sum.alongRadius() : sum.forHorner();
  };
  ErrorPolynomials made;
  Bivariate height(2 * degree), slope(2 * degree - 2);
  addForm(derivative(degree, 0, 0), covariance, height);
  made.height = stored(height);
  addForm(derivative(degree, 1, 0), covariance, slope);
  addForm(derivative(degree, 0, 1), covariance, slope);
  made.slope = stored(slope);
  if (degree < 2) return made;
  Bivariate bend(2 * degree - 4);
  std::vector<DerivedTerm> both = derivative(degree, 2, 0);
  const std::vector<DerivedTerm> other = derivative(degree, 0, 2);
  both.insert(both.end(), other.begin(), other.end());
  addForm(both, covariance, bend);
  made.bend = stored(bend);
  return made;
}

/** Covariance of the coefficients for noise of variance 1 and one effective point. \param[in] map
 * where the data are; closed: everywhere */
Matrix covarianceOf(int degree, WeightKernel kernel, const TrimMap& map) {
  const int terms = numCoefficients(degree);
  Matrix a = Matrix::Zero(terms, terms), b = a;
  double weight = 0, weight_sq = 0;
  Eigen::VectorXd m(terms);
  for (int row = 0; row < kNodes; ++row) {
    for (int column = 0; column < kNodes; ++column) {
      const double u = (2 * column + 1.0) / kNodes - 1, v = (2 * row + 1.0) / kNodes - 1;
      double w = evaluateKernel(kernel, u * u + v * v);
      if (w > 0 && !map.closed()) w *= 1 - outsideShare(map, u, v);
      if (!(w > 0)) continue;
      for (int d = 0, k = 0; d <= degree; ++d) {
        for (int j = 0; j <= d; ++j, ++k) m[k] = std::pow(u, d - j) * std::pow(v, j);
      }
      a.selfadjointView<Eigen::Lower>().rankUpdate(m, w);
      b.selfadjointView<Eigen::Lower>().rankUpdate(m, w * w);
      weight += w;
      weight_sq += w * w;
    }
  }
  if (!(weight > 0)) return covarianceOf(degree, kernel, {});
  a.diagonal() *= 1 + (map.closed() ? 0.0 : kRidge);
  const Matrix full_b = b.selfadjointView<Eigen::Lower>();
  const Eigen::LDLT<Matrix> factor(a.selfadjointView<Eigen::Lower>());
  const Matrix half = factor.solve(full_b);
  return factor.solve(half.transpose()) * (weight * weight / weight_sq);
}

/** The weights of a leaf's fit: at the minimum support they are those of a flatter kernel. */
WeightKernel fitKernelOf(const SLIMSurface& surface, std::uint32_t i) {
  const bool flat = (surface.flags[i] & kSurfelSupportLimited) != 0 && !surface.info.paper_mode;
  return flat ? WeightKernel::kPower2 : surface.info.fit_kernel;
}

}  // namespace

LeafErrorTable::LeafErrorTable(const SLIMSurface& surface, int threads) {
  for (int degree = 1; degree <= surface.info.degree; ++degree) {
    const WeightKernel kernels[2] = {surface.info.fit_kernel, WeightKernel::kPower2};
    for (std::size_t k = 0; k < 2; ++k) {
      round_[static_cast<std::size_t>(degree)][k] =
          polynomialsOf(degree, covarianceOf(degree, kernels[k], {}), true);
    }
  }
  if (!surface.hasTrimMaps()) return;
  std::vector<std::uint32_t> open;
  at_.assign(surface.size(), kRound);
  for (std::uint32_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i) || !surface.isOpen(i)) continue;
    at_[i] = static_cast<std::uint32_t>(open.size());
    open.push_back(i);
  }
  open_.resize(open.size());
  parallelFor(open.size(), threads, 16, [&](std::size_t k, int) {
    const std::uint32_t i = open[k];
    const int degree = surface.degree[i];
    open_[k] = polynomialsOf(
        degree, covarianceOf(degree, fitKernelOf(surface, i), surface.trimMap(i)), false);
  });
}

const ErrorPolynomials& LeafErrorTable::round(const SLIMSurface& surface, std::uint32_t i) const {
  const bool flat = fitKernelOf(surface, i) != surface.info.fit_kernel;
  return round_[surface.degree[i]][flat ? 1 : 0];
}

LeafErrors LeafErrorTable::of(const SLIMSurface& surface, std::uint32_t i) const {
  const SurfaceInfo& info = surface.info;
  const double count = std::max(1.0, double{surface.effective_count[i]});
  const double shared = std::clamp(info.correlation, 1.0, count);
  const double followed = std::min(1.0, shared * numCoefficients(surface.degree[i]) / count);
  const double noise = std::max(0.0, info.lambda) * info.diagonal * info.diagonal;
  const double residual = surface.error[i];
  LeafErrors errors;
  errors.deviation = static_cast<float>(
      std::sqrt((residual * residual + noise * followed) * shared / count) / surface.radius[i]);
  errors.round = at_.empty() || at_[i] == kRound;
  errors.variances = errors.round ? &round(surface, i) : &open_[at_[i]];
  return errors;
}

}  // namespace pcl_slim::detail
