// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ball/ball_kernels.h"
#include "fit_settings.h"
#include "radius/residual_structure.h"

namespace pcl_slim::detail {

/** \brief A radius that was tried; rho is in units of the ball's gather radius. */
struct Trial {
  double rho = 0;
  LocalFit fit;
  double energy = 0;
  bool supported = false;  ///< the full degree could be fitted with enough points
};

/** \brief Where the search over one sliding interval ended. */
struct RadiusChoice {
  enum class Kind {
    kLeaf,      ///< a radius was found
    kInternal,  ///< the minimum lies at smaller radii: a later level will find it
    kSparse     ///< too few points at r_r: see RadiusSearch::fallBack
  };
  Kind kind = Kind::kInternal;
  Trial trial;          ///< the leaf's, or the fit at r_r for an internal node
  bool forced = false;  ///< ended by minimum support
  bool plain = false;   ///< found to hide no structure
};

/** \brief Seeks the radius of one gathered ball (section 2, "Optimal surfel radius").
 *
 * Evaluates E at r_r, r_m, r_l of eq. (5) and at few radii between, each from the same gathered
 * points. One object per thread: it keeps its scratch memory.
 */
class RadiusSearch {
 public:
  explicit RadiusSearch(const FitSettings& settings) : settings_(settings), energy_(settings.energy)
  {
  }

  /** \brief The noise variance of the balls to come. */
  void setNoise(double lambda) { energy_.lambda = lambda; }
  double noise() const { return energy_.lambda; }

  /** \brief Starts on a ball in frame coordinates. \param[in] gather_radius local length;
   * \param[in] rho_right r_r in units of it. */
  void begin(const BallBuffer& ball, double gather_radius, double rho_right);

  /** \brief The fit at r_r. */
  const Trial& right();

  /** \brief The choice on [gamma^2, 1] rho_right. */
  RadiusChoice search();

  /** \brief Whether a smaller radius is needed beyond doubt, seen on a part of a ball's points. */
  bool surelyInternal();

  /** \brief For a sparse ball: the best that degree and radius up to the gather radius allow. */
  RadiusChoice fallBack();

  /** \brief The final fit of a leaf, with refinement and, where asked, robust weights. */
  Trial refine(const RadiusChoice& choice);

  std::uint64_t numFits() const { return fits_; }

 private:
  static constexpr double kNoiseLike = 1.5;  ///< e^2 up to so many lambda

  Trial evaluate(double rho, int degree, WeightKernel kernel);
  Trial evaluate(double rho) { return evaluate(rho, settings_.degree, settings_.fit_kernel); }
  const BallBuffer& pointsWithin(double rho);
  double wallRadius(double from, int degree, WeightKernel kernel);
  double radiusOfData(const Trial& trial, WeightKernel kernel);
  Trial evaluateWall(double from);
  RadiusChoice chooseByEnergy();
  RadiusChoice chooseAtWall(const Trial& right, const Trial& middle);
  RadiusChoice chooseInside(const Trial& left, const Trial& middle, const Trial& right);
  RadiusChoice paperChoice(const Trial& left, const Trial& middle, const Trial& right);
  Trial largestLenient(const Trial& best, const Trial& right);
  void narrow(Trial& a, Trial& b, Trial& c);
  RadiusChoice surfaceOrNothing(const Trial& trial) const;
  bool refit(const BallBuffer& points, WeightKernel kernel, Trial& trial);
  void setRobustWeights(const LocalFit& fit);
  bool filledByNoise(double rho) const;
  bool lacksFit(const Trial& left, const Trial& middle, double margin = 1.0) const;
  bool besideFeature(const Trial& trial) const;
  Trial lowDegree(const Trial& trial);
  bool hidesStructure(const Trial& trial);
  std::array<double, kMaxCoefficients> unbiased(const Trial& trial) const;
  double apartSq(const Trial& plain, const Trial& close) const;
  bool servesAsWell(const Trial& plain, const Trial& close, double trust = 1.0) const;
  Trial widestServing(const Trial& middle, const Trial& right);
  Trial lowered(const Trial& trial, int degree);
  Trial leastDegree(const Trial& trial);

  /** What remains is noise, not lack of fit. */
  bool isNoise(const Trial& trial) const { return variance(trial) <= kNoiseLike * energy_.lambda; }
  double variance(const Trial& trial) const { return energy_.variance(trial.fit, gather_radius_); }

  const FitSettings& settings_;
  Energy energy_;
  const BallBuffer* ball_ = nullptr;
  BallBuffer middle_, inner_, robust_;
  std::vector<float> residuals_;
  ResidualStructure structure_;
  Trial right_;
  bool has_right_ = false, has_middle_ = false, has_inner_ = false;
  double gather_radius_ = 0, rho_right_ = 1;
  std::uint64_t fits_ = 0;
};

}  // namespace pcl_slim::detail
