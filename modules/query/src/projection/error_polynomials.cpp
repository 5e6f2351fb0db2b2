// SPDX-License-Identifier: BSD-3-Clause
#include "projection/error_polynomials.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/leaf_noise.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

constexpr std::uint32_t kRound = ~std::uint32_t{0};

/** \brief A polynomial in u and v up to a degree, by the powers of its terms. */
class Bivariate {
 public:
  explicit Bivariate(int degree) : degree_(degree) {}

  double& at(int i, int j) { return terms_[static_cast<std::size_t>(i * kStride + j)]; }

  /** \brief The terms in the order of Horner's rule. */
  std::vector<float> forHorner() {
    std::vector<float> terms;
    terms.reserve(static_cast<std::size_t>((degree_ + 1) * (degree_ + 2) / 2));
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
  static constexpr int kStride = 2 * kMaxDegree + 1;

  int degree_;
  std::array<double, kStride * kStride> terms_{};
};

/** \brief A term of a derivative of sum c_k m_k: factor u^i v^j times c_k. */
struct DerivedTerm {
  int k, i, j;
  double factor;
};
using DerivedTerms = std::vector<DerivedTerm>;

/** The derivative d^a/du^a d^b/dv^b of all monomials. */
DerivedTerms derivative(int degree, int a, int b) {
  const auto falling = [](int power, int times) {
    double factor = 1;
    for (int t = 0; t < times; ++t) factor *= power - t;
    return factor;
  };
  DerivedTerms terms;
  for (int d = 0, k = 0; d <= degree; ++d) {
    for (int j = 0; j <= d; ++j, ++k) {
      const int i = d - j;
      if (i >= a && j >= b) terms.push_back({k, i - a, j - b, falling(i, a) * falling(j, b)});
    }
  }
  return terms;
}

/** \brief What the errors of all leaves of one degree and kernel share: the terms of their
 * derivatives, and the moments of each node of a grid over the disc. */
class DegreeErrors {
 public:
  /** \param[in] nodes a side of the grid */
  DegreeErrors(int degree, WeightKernel kernel, int nodes);

  /** \brief The polynomials of a leaf. \param[in] map where the data are; closed: everywhere, and the
   * polynomials are those in u^2 + v^2 */
  ErrorPolynomials of(const TrimMap& map) const;

 private:
  using Matrix = Eigen::MatrixXd;

  Matrix covariance(const TrimMap& map) const;

  int degree_, terms_;
  DerivedTerms height_, along_u_, along_v_, bend_;
  std::vector<std::array<double, 2>> nodes_;  ///< u, v
  /// a column a node: its share of sum w u^i v^j for i + j <= 2D, rows of fixed i, then of the same
  /// sums with w^2
  Matrix moments_;
};

constexpr double kRidge = 1e-4;  ///< of the diagonal: terms that the data leave open stay finite

/** Place of u^i v^j among the moments up to a degree, in rows of fixed i. */
int momentAt(int degree, int i, int j) {
  return i * (degree + 1) - i * (i - 1) / 2 + j;
}

DegreeErrors::DegreeErrors(int degree, WeightKernel kernel, int nodes)
    : degree_(degree),
      terms_(numCoefficients(degree)),
      height_(derivative(degree, 0, 0)),
      along_u_(derivative(degree, 1, 0)),
      along_v_(derivative(degree, 0, 1)),
      bend_(derivative(degree, 2, 0)) {
  const DerivedTerms other = derivative(degree, 0, 2);
  bend_.insert(bend_.end(), other.begin(), other.end());
  const int most = 2 * degree, count = numCoefficients(most);
  moments_.resize(2 * count, nodes * nodes);
  for (int k = 0; k < nodes * nodes; ++k) {
    const double u = (2 * (k % nodes) + 1.0) / nodes - 1, v = (2 * (k / nodes) + 1.0) / nodes - 1;
    const double w = evaluateKernel(kernel, u * u + v * v);
    if (!(w > 0)) continue;
    const auto column = static_cast<Eigen::Index>(nodes_.size());
    nodes_.push_back({u, v});
    for (int i = 0, m = 0; i <= most; ++i) {
      for (int j = 0; i + j <= most; ++j, ++m) {
        moments_(m, column) = w * std::pow(u, i) * std::pow(v, j);
        moments_(count + m, column) = w * moments_(m, column);
      }
    }
  }
  moments_.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(nodes_.size()));
}

/** Covariance of the coefficients for noise of variance 1 and one effective point. */
DegreeErrors::Matrix DegreeErrors::covariance(const TrimMap& map) const {
  Eigen::VectorXd share = Eigen::VectorXd::Ones(moments_.cols());
  for (std::size_t k = 0; k < nodes_.size() && !map.closed(); ++k) {
    share[static_cast<Eigen::Index>(k)] = 1 - outsideShare(map, nodes_[k][0], nodes_[k][1]);
  }
  const Eigen::VectorXd sums = moments_ * share;
  if (!(sums[0] > 0)) return covariance({});
  const int most = 2 * degree_, count = numCoefficients(most);
  Matrix a(terms_, terms_), b(terms_, terms_);
  for (const DerivedTerm& p : height_) {
    for (const DerivedTerm& q : height_) {
      const int m = momentAt(most, p.i + q.i, p.j + q.j);
      a(p.k, q.k) = sums[m];
      b(p.k, q.k) = sums[count + m];
    }
  }
  if (!map.closed()) a.diagonal() *= 1 + kRidge;
  const Eigen::LDLT<Matrix> factor(a);
  const Matrix half = factor.solve(b);
  return factor.solve(half.transpose()) * (sums[0] * sums[0] / sums[count]);
}

/** Adds the variance of a derivative, its terms^T C terms. */
void addForm(const DerivedTerms& terms, const Eigen::MatrixXd& covariance, Bivariate& sum) {
  for (const DerivedTerm& p : terms) {
    for (const DerivedTerm& q : terms) {
      sum.at(p.i + q.i, p.j + q.j) += p.factor * q.factor * covariance(p.k, q.k);
    }
  }
}

ErrorPolynomials DegreeErrors::of(const TrimMap& map) const {
  const Matrix c = covariance(map);
  const auto stored = [&map](Bivariate& sum) {
    return map.closed() ? sum.alongRadius() : sum.forHorner();
  };
  ErrorPolynomials made;
  Bivariate height(2 * degree_), slope(2 * degree_ - 2);
  addForm(height_, c, height);
  made.height = stored(height);
  addForm(along_u_, c, slope);
  addForm(along_v_, c, slope);
  made.slope = stored(slope);
  if (degree_ < 2) return made;
  Bivariate bend(2 * degree_ - 4);
  addForm(bend_, c, bend);
  made.bend = stored(bend);
  return made;
}

/** The weights of a leaf's fit: at the minimum support they are those of a flatter kernel. */
WeightKernel fitKernelOf(const SLIMSurface& surface, std::uint32_t i) {
  const bool flat = (surface.flags[i] & kSurfelSupportLimited) != 0 && !surface.info.paper_mode;
  return flat ? WeightKernel::kPower2 : surface.info.fit_kernel;
}

}  // namespace

LeafErrorTable::LeafErrorTable(const SLIMSurface& surface, int threads) {
  constexpr int kRoundNodes = 96, kOpenNodes = 24;  // a side of the grid over a disc
  std::vector<DegreeErrors> of_open;  // by degree, each by the fit's kernel and the flat one
  for (int degree = 1; degree <= surface.info.degree; ++degree) {
    for (std::size_t k = 0; k < 2; ++k) {
      const WeightKernel kernel = k == 0 ? surface.info.fit_kernel : WeightKernel::kPower2;
      round_[static_cast<std::size_t>(degree)][k] =
          DegreeErrors(degree, kernel, kRoundNodes).of({});
      if (surface.hasTrimMaps()) of_open.emplace_back(degree, kernel, kOpenNodes);
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
    const std::size_t flat = fitKernelOf(surface, i) != surface.info.fit_kernel ? 1 : 0;
    open_[k] = of_open[2 * (surface.degree[i] - std::size_t{1}) + flat].of(surface.trimMap(i));
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
  LeafErrors errors;
  errors.deviation =
      static_cast<float>(std::sqrt(leafNoise(surface, i) * shared / count) / surface.radius[i]);
  errors.round = at_.empty() || at_[i] == kRound;
  errors.variances = errors.round ? &round(surface, i) : &open_[at_[i]];
  return errors;
}

}  // namespace pcl_slim::detail
