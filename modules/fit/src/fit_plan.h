// SPDX-License-Identifier: BSD-3-Clause
// What the inner steps of a fit go by, and the steps before and after the cover, which the fit of a
// store and that of a tile share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "fit_constants.h"
#include "least_squares/least_squares.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

class LevelCover;

/** \brief What the fit knows of a cloud's errors, stated by the user or measured. Local units. */
struct CloudMeasures {
  double lambda = 0;                 ///< noise variance as the energy takes it
  double noise = 0;                  ///< variance of the points about the surface; 0: not known
  double scanned = 0;                ///< lambda of the points as scanned, if the fit has another
  double correlation = 1;            ///< points that share their errors
  std::vector<float> noise_profile;  ///< noise ratios of runs of points; empty: all 1
  double normal_error = 0;           ///< > 0: normals are data too, this many radians off
  float min_dot = 0;                 ///< the normal bound: normals nearer than this belong together
  bool skip_lone_sides = false;      ///< no leaf starts at a point whose neighbours face elsewhere
  NoiseStatistics statistics;        ///< how they were measured
};

/** \brief What a radius costs: residual plus a penalty on small balls. All in local units
 * (docs/theory.md, "One fit, step by step", 5 (Radius), and the rows "penalty", "residual" and
 * "slope" of "Where the default departs from the paper"). */
struct Energy {
  /// "Balls of a few sigma": e^2 under falling weights shows at least this share of the variance.
  static constexpr double kLeastSeenShare = 0.2;

  double lambda = 0;       ///< noise variance
  double correlation = 1;  ///< tau: this many points share one error and count as one
  double kappa = 0;        ///< Mallows' Cp: kappa lambda P / n_eff, where t_mdl is 0
  double t_mdl = 0;        ///< T_MDL L: the paper's penalty lambda (T L / r)^2
  double thick = 5.0;      ///< balls below this many sqrt(lambda) are noise-filled
  bool corrected = true;   ///< residual variance over n - P degrees of freedom (not in the paper)

  /** \brief E(r) of a fit with radius r; gather_radius is the unit the fit was made in. */
  double operator()(const LocalFit& fit, double r, double gather_radius) const {
    double e_sq = variance(fit, gather_radius);
    if (corrected) {
      // Weights fall with height, too: a thin ball measures e^2 = s^2 / (1 + a s^2 / r^2) of a
      // noise variance s^2, and a noise-filled ball little but its own size.
      const double truncation = heightTruncation(fit.kernel);
      e_sq /= std::max(kLeastSeenShare, 1.0 - truncation * e_sq / (r * r));
      if (filledByNoise(r)) e_sq = std::max(e_sq, lambda);
      const double freedom = degreesOfFreedom(fit);
      if (!(freedom > 0)) return std::numeric_limits<double>::infinity();
      e_sq *= fit.n_eff / freedom;
    }
    return e_sq + fit.slope_misfit * gather_radius * gather_radius + penalty(fit, r);
  }

  /** \brief e^2 across the surface: over a slope s noise scatters heights by 1 + s^2 times
   * its variance. What a fit misses of the shape keeps its height. */
  double variance(const LocalFit& fit, double gather_radius) const {
    const double e_sq = fit.residual_sq * gather_radius * gather_radius;
    // With T given balls may shrink until they follow the noise, whose slopes must not excuse them.
    if (!corrected || t_mdl > 0) return e_sq;
    return std::max(e_sq / (1.0 + fit.slope_sq), e_sq - lambda * fit.slope_sq);
  }

  /** \brief The part of E(r) that small balls pay. */
  double penalty(const LocalFit& fit, double r) const {
    if (t_mdl > 0) return lambda * (t_mdl / r) * (t_mdl / r);  // eq. (3)
    return kappa * lambda * correlation * numCoefficients(fit.degree) / fit.n_eff;
  }

  /** \brief Degrees of freedom of a fit's residuals: each coefficient takes as many points as share
   * one error. */
  double degreesOfFreedom(const LocalFit& fit) const {
    const double freedom = fit.n_eff - correlation * numCoefficients(fit.degree);
    return correlation > 1 ? std::max(freedom, 0.25 * fit.n_eff) : freedom;
  }

  /** \brief Whether a ball of radius r is noise-filled: its e^2 depends more on its size than on
   * the noise. */
  bool filledByNoise(double r) const { return r * r < thick * thick * lambda; }
};

/** \brief Everything the inner steps need to know, in local units: the user's parameters, settled,
 * and what was measured. Made by planFor(), const from there on. */
struct FitPlan {
  FitConstants constants;

  int degree = constants.preset.degree;
  Energy energy;
  WeightKernel fit_kernel = WeightKernel::kPower4;    ///< weights while searching and in general
  WeightKernel wall_kernel = WeightKernel::kPower2;   ///< at minimum support, where bias rules
  WeightKernel cover_kernel = WeightKernel::kPower7;  ///< G of the coverage
  double support = constants.preset.support;          ///< n_eff per coefficient that a fit takes
  double lenience = constants.preset.lenience;  ///< the largest r with E <= lenience min E is taken
  double lack_of_fit =
      constants.preset.lack_of_fit;  ///< no leaf while e > this * sqrt(lambda); 0: off
  bool find_detail = true;           ///< look for detail below the noise, and for features
  bool compare_nested = true;        ///< accept the wider ball if it fits the inner points as well
  double residual_bound = constants.cover.residual_bound;  ///< a leaf covers within this * e; 0: r
  double alpha = constants.cover.alpha;                    ///< a leaf covers within alpha r ...
  double supported_alpha =
      constants.cover.alpha;  ///< ... or this, for leaves that many points support
  double gamma = 0.1;         ///< a point is covered at this coverage
  double diagonal = 1.0;      ///< L
  double first_radius = constants.cover.paper_first_radius;  ///< r_r of level 1 over L
  double start_share = constants.cover.start_share;  ///< of the points in level 1's median ball
  double noise = 0;                                  ///< CloudMeasures::noise
  double correlation = 1;  ///< points that share an error, for whoever reads the surface
  double least_ball = 0;   ///< > 0: no leaf's ball is narrower, a local length
  double center_grid = 0x1p-22;
  std::vector<float> noise_profile;  ///< CloudMeasures::noise_profile
  bool with_normals = false;
  double normal_error = 0;  ///< CloudMeasures::normal_error
  float min_dot = 0.0f;     ///< CloudMeasures::min_dot
  bool skip_lone_normals = true;
  bool split_sheets = false;
  bool internal_only = false;  ///< every ball is kept at r_r, as a parent of finer ones
  bool robust = false;
  bool paper = false;
  std::uint64_t seed = 1;

  FitPlan() = default;
  explicit FitPlan(const FitConstants& values) : constants(values) {
    energy.thick = values.preset.thick;
  }

  /** \brief The noise ratio about point i of n: the noise variance there over the cloud's. */
  double noiseRatioAt(std::size_t i, std::size_t n) const {
    return noise_profile.empty() ? 1.0 : noise_profile[i * noise_profile.size() / n];
  }

  /** \brief Smaller balls may miss the point that they are about, for their centres are on a grid.
   */
  double leastRadius() const { return constants.cover.least_radius * center_grid; }

  /** \brief Whether balls of level k are no narrower than least_ball. */
  bool allows(int k) const { return levelRadius(k) >= least_ball; }

  /** \brief Whether balls of level k, and the narrower ones that they mark, contain their own
   * points. */
  bool resolves(int k) const { return levelRadius(k) >= 2 * leastRadius(); }

  /** \brief r_r of level k (eq. 5). */
  double levelRadius(int k) const { return first_radius * diagonal * std::pow(kGolden, k - 1); }

  /** \brief The same plan with another noise variance in its energy. */
  FitPlan withLambda(double lambda) const {
    FitPlan other = *this;
    other.energy.lambda = lambda;
    return other;
  }

  /** \brief The same plan for levels without leaves, above those of tiles. */
  FitPlan withoutLeaves() const {
    FitPlan other = *this;
    other.internal_only = true;
    return other;
  }
};

/** \brief A user's parameters with degree and penalty settled. */
FitParams resolvedParams(const FitParams& params, const PresetConstants& constants);
/** \brief The same for a store's frame: noise in the cloud's unit becomes lambda. \return an error
 * for noise wider than the cloud */
Result<FitParams> resolvedParams(const FitParams& params, const StoreFrame& frame,
                                 const PresetConstants& constants);

/** \brief The preset that a user's parameters name, with the widths that a store's frame sets: what
 * the radii of levels depend on. */
FitPlan framePlan(const StoreFrame& frame, const FitParams& params, const FitConstants& constants);

/** \brief The plan of a fit. \param[in] params resolved */
FitPlan planFor(const PointStore& store, const FitParams& params, const FitConstants& constants,
                const CloudMeasures& measures);

/** \brief A plan, and the factor that its noise variance was multiplied by; 0: none. */
struct SizedPlan {
  FitPlan plan;
  double noise_factor = 0;
};

/** \brief A plan whose noise variance is multiplied by a NoiseFactor, or by the factor that meets a
 * TargetError, TargetDistance or MaxSurfels; with another SizeRule the plan as it is.
 *
 * The error a user allows is treated as if it were noise: covers are run while the factor is moved
 * by secant steps in log-log until the RMS residual meets the target within 3 %, or the leaves
 * number at most max_surfels (and, where reachable, 95 % of it). Factors have six decimal digits,
 * so that one which is printed gives the same fit.
 * \return an error where no factor reaches the goal, naming what is reachable.
 */
Result<SizedPlan> sizedPlan(const PointStore& store, const FitPlan& plan, const SizeRule& size,
                            int threads, Progress* progress);

/** \brief First level whose median ball contains a small share of the points: the box's size gives
 * no size of the object, as one far point can stretch it. 1 in paper mode. */
int startLevel(const PointStore& store, const FitPlan& plan);

/** \brief Writes a finished cover's surfels into a surface's columns, and how it was made into its
 * info; links are still to be built. O(surfels). */
void fillSurface(const PointStore& store, const FitPlan& plan, const LevelCover& cover, int threads,
                 SLIMSurface& surface);

/** \brief A finished fit's points and surfels, what its cover did, and the penalty that it was made
 * with. Times and what was measured of the cloud are added by the caller. O(points + surfels). */
FitStatistics countFit(const PointStore& store, const LevelCover& cover,
                       const SLIMSurface& surface);

/** \brief Why a fit has no leaf, and what helps; no error where it has some. */
Error checkLeaves(const PointStore& store, const FitStatistics& stats);

}  // namespace pcl_slim::detail
