// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/fit/sensor_noise.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A price of coefficients: E = e^2 n/(n-P) + kappa lambda P / n (Mallows' Cp). */
struct PenaltyWeight {
  std::optional<double> kappa;  ///< > 0, larger is smoother; unset: 3, or 1 with sharp features
};
/** \brief The paper's penalty lambda (T L / r)^2 (eq. 3). */
struct MDLThreshold {
  double t = 0.0;  ///< T_MDL > 0
};
/** \brief Solves for the noise factor that gives an RMS residual. */
struct TargetError {
  double rms = 0.0;  ///< (0, 1] [L]
};
/** \brief The same for an RMS residual in the cloud's unit. */
struct TargetDistance {
  double rms = 0.0;  ///< > 0 [world units]
};
/** \brief Solves for the noise factor that gives at most this number of leaves. */
struct MaxSurfels {
  std::uint64_t leaves = 0;  ///< 1 or more
};
/** \brief Residuals and penalty as if the noise variance were a multiple of lambda: what the three
 * above solve for. */
struct NoiseFactor {
  double factor = 0.0;  ///< > 0
};
/** \brief What decides how fine a surface is. */
using SizeRule =
    std::variant<PenaltyWeight, MDLThreshold, TargetError, MaxSurfels, NoiseFactor, TargetDistance>;

/** \brief A parameter from a number of which 0 means that it is not set. */
template <typename Number>
std::optional<Number> unlessZero(Number value) {
  return value != 0 ? std::optional<Number>(value) : std::nullopt;
}

/** \brief Parameters of a SLIM fit. The defaults need no tuning; lengths marked [L] are shares of
 * the bounding-box diagonal. fit_parameters.h has their names, ranges and help. */
struct PCL_SLIM_EXPORT FitParams {
  std::optional<int> degree;     ///< of polynomials, 1..4; unset: 4, or 2 with sharp features
  SizeRule size;                 ///< how fine the surface is
  std::optional<double> lambda;  ///< > 0 [L^2]: noise variance; unset: estimated
  /// RMS error of the points, > 0 [world units], at most L: in place of lambda, the variance
  /// (noise / L)^2
  std::optional<double> noise;
  /// alpha in (0, 1]: leaves cover the points within alpha r, 1 is the compact setting; unset: 2/3,
  /// and .55 for leaves of a large effective count
  std::optional<double> cover_radius;
  double cover_threshold = 0.1;  ///< gamma > 0: a point is covered from this sum of weights on
  /// > 0, world units: no ball is narrower, so that no finer detail is kept and the rims of sharp
  /// edges are as wide
  std::optional<double> least_radius;
  /// keep sharp edges: only points with n . n_c > 1/2; no effect without normals
  bool sharp_features = false;
  bool robust = false;         ///< reweight residuals against outliers (two more passes a leaf)
  bool keep_outliers = false;  ///< fit points that are far from all others, too (findOutliers())
  /// lambda varies over the cloud: noisy parts are smoothed more than clean ones; unset: where
  /// neighbouring points share errors, or noise differs by more than chance
  std::optional<bool> local_noise;
  /// number of points that share an error, as the pixels of a depth camera do; 1: independent
  /// errors; unset: estimated
  std::optional<double> noise_correlation;
  /// a, b, c: RMS error a + b z + c z^2 along the ray from the viewpoint at distance z, world
  /// units; needs a viewpoint or the store's sensors
  std::optional<std::array<double, 3>> noise_model;
  /// noise of the sensor, as an earlier frame showed it: it is used if this frame's residuals agree
  /// with it, else the noise is measured
  std::optional<SensorNoise> sensor_noise;
  /// return NoiseStatistics::sensor_noise for the next frames, if the noise is measured
  bool keep_sensor_noise = false;
  /// fit positions and normals together, by their errors; needs normals measured independently of
  /// the points, as by photometric stereo or a simulation
  bool normals_as_data = false;
  /// with it: the normals' RMS error, (0, pi/2] radians; unset: measured, and normals that follow
  /// the points' own noise are no data (NoiseStatistics::normals_follow_points)
  std::optional<double> normal_error;
  bool paper_mode = false;  ///< the choices of Ohtake et al. 2005 throughout
  /// make trim maps, which end the surface where the data end or leave holes; never with paper_mode
  bool trim = true;
  /// with it: diameter of the smallest hole kept, in spacings of the points, 2 to 50
  double hole_size = 5.0;
  /// without normals and viewpoint: give points sides before the cover where balls would meet both
  /// sides of thin parts
  bool sides = true;
  bool orient = true;  ///< without normals: sign the output by the leaves' graph
  /// sign the output towards this place instead, world coordinates; unset: towards the sensors of
  /// the store's points, or its only sensor
  std::optional<std::array<double, 3>> viewpoint;
  std::uint64_t seed = 1;  ///< of the order in which centres are tried
  int threads = 0;         ///< 0: all cores; never changes the result

  bool hasThreshold() const { return std::holds_alternative<MDLThreshold>(size); }

  /** \brief The same with degree and penalty settled: faces between sharp edges are small, which
   * low degrees and narrow balls follow better (docs/theory.md). */
  FitParams resolved() const;
  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What became of FitParams::sensor_noise. */
enum class SensorCheck : unsigned char {
  kNone,     ///< none was given
  kAgrees,   ///< the frame's residuals agree with it: it was used
  kDiffers,  ///< they do not: the noise was measured
  kNotSeen   ///< too few patches show the residuals, or frames are merged: the noise was measured
};

/** \brief What was measured of a cloud's errors. */
struct NoiseStatistics {
  std::uint64_t patches = 0;     ///< of points, on which noise was measured
  double error = 0;              ///< relative standard error of sqrt(lambda); 0: lambda was given
  double correlation = 1;        ///< points that share their errors; 1: white noise
  double correlation_error = 0;  ///< relative standard error of that number
  std::uint64_t frames = 0;  ///< of a merged cloud whose noise was measured; 0: that of all points
  std::uint64_t line = 0;    ///< points along a scan line that count as one; 0: no lines
  double step = 0;           ///< of a quantised coordinate, the median [L]; 0: none found
  std::uint64_t neighbors = 0;  ///< points of a patch that shows all of the noise
  double patch_radius = 0;      ///< median radius of those patches [L]
  bool varies = false;          ///< lambda is the cloud's, the noise a profile about it
  double normal_error = 0;      ///< of normals used as data [rad]; 0: they were not
  /// normals were to be data, but repeat the points' noise, or the points are too few to show it
  bool normals_follow_points = false;
  SensorCheck sensor_check = SensorCheck::kNone;
  /// RMS residual over that of the sensor's noise given, of the patches that differ most; 0: unknown
  double sensor_ratio = 0;
  /// for the next frames, with FitParams::keep_sensor_noise: the one given where it was used, else
  /// the one measured; none where noise was given or frames are merged
  std::optional<SensorNoise> sensor_noise;
};

/** \brief How points and surface got their sides. */
struct SideStatistics {
  double thin_places = 0;    ///< share of the places looked at where a ball meets two sides
  std::uint64_t points = 0;  ///< that were given a side before the cover
  bool for_cover = false;    ///< ... for the cover alone; after it all points have one
  double confidence = 0;     ///< agreement of neighbouring sides: 1 in full, 0 as chance has it
  bool in_doubt = false;     ///< all points got sides, of which many may be wrong
  /// points were moved to the planes of this many neighbours first; 0: they were not
  std::uint64_t plane_neighbors = 0;
  double gap = 0;  ///< median distance of sheets that face apart [spacings]; 0: none do
  /// below 1: leaves follow the points to within this share of lambda, where few spacings are
  /// between sheets and sides are in doubt
  double noise_share = 1;
  SideSource source = SideSource::kNone;
  NormalAgreement normals;  ///< of the given ones; they were settled where they contradict
  // Shares of the points on leaves that face ...
  std::optional<double> facing;     ///< ... the sensors or the viewpoint that decided
  double facing_origin = 0;         ///< ... the world's origin
  double facing_outward = 0;        ///< ... away from the middle of all leaves
  std::uint64_t overlap_edges = 0;  ///< of the graph of overlapping leaves; 0: there was no need
};

/** \brief Wall time of the stages of a fit [s]. */
struct FitSeconds {
  double outliers = 0, noise = 0, sides = 0, cover = 0, links = 0, orient = 0, trim = 0;
};

/** \brief What a fit did, what it skipped and how long its stages took. */
struct FitStatistics {
  std::uint64_t points = 0;    ///< fitted: finite, distinct, no outliers
  std::uint64_t outliers = 0;  ///< stored points that are far from all others: not fitted ...
  std::vector<std::uint32_t> outlier_points;  ///< ... and which these are; empty of tiles

  NoiseStatistics noise;
  double lambda = 0;              ///< noise variance [L^2]
  double penalty = 0, t_mdl = 0;  ///< as used (solved for with a target)
  double noise_factor = 0;        ///< NoiseFactor, or the one solved for; 0: none
  SideStatistics sides;

  int first_level = 1, levels_skipped = 0, last_level = 0;
  std::uint64_t leaves = 0, internals = 0;
  std::vector<std::uint64_t> leaves_per_level;  ///< index k
  double rms_error = 0;               ///< RMS residual of covered points against their leaves [L]
  std::uint64_t support_limited = 0;  ///< leaves that ended by minimum support
  std::uint64_t reduced_degree = 0;   ///< surfels of a lower degree than required
  std::uint64_t open_leaves = 0;      ///< leaves with a trim map: data end or leave a hole in them

  std::uint64_t uncovered = 0;    ///< points whose coverage stays below gamma
  std::uint64_t unsupported = 0;  ///< of those, points inside no leaf's support at all
  std::uint64_t unresolved = 0;   ///< points whose detail is too fine for the cloud's width, 1e-6 L
  std::uint64_t skipped_normals = 0;  ///< centres skipped because no neighbour shares their normal
  std::uint64_t never_gathered = 0;   ///< centres never tried: points covered by another's leaf

  std::uint64_t gathered = 0;         ///< points gathered into balls, all balls together
  std::uint64_t split_sheets = 0;     ///< balls in which two sheets were separated
  std::uint64_t line_balls = 0;       ///< balls divided because their many points are along a line
  std::uint64_t fits = 0;             ///< least-squares systems solved
  std::uint64_t fell_by_support = 0;  ///< of those, of a lower degree for lack of points
  std::uint64_t fell_by_pivot = 0;    ///< likewise: the points do not determine its coefficients
  double least_pivot =
      1;  ///< of the leaves' normal equations, over its diagonal entry; 1: orthogonal
  std::uint64_t trim_candidates = 0;  ///< surfels whose gaps were measured; the others have none

  FitSeconds seconds;
  int threads = 1;
  std::uint64_t working_bytes = 0;  ///< memory of the fit, store and surface not counted
};

/** \brief Fits a SLIM surface to a cloud in Morton order (Ohtake, Belyaev, Alexa 2005, section 2).
 *
 * Levels k = k0, k0+1, ...: ball centres are chosen among the points not yet covered; each ball
 * seeks the radius in [gamma^2, 1] r_r that minimises E(r); balls with a minimum become leaves and
 * cover points, the others internal nodes, until every point is covered or reported. Surfels in
 * whose ball the data end or leave a hole get a trim map. Same bytes for any number of threads.
 *
 * \return an error for bad parameters, no points, points that are nowhere a surface
 * (ErrorCode::kNoSurface; statistics are then filled), or cancellation; surface is then empty.
 */
PCL_SLIM_EXPORT Error fitSurface(const PointStore& store, const FitParams& params,
                                 SLIMSurface& surface, FitStatistics* statistics = nullptr,
                                 Progress* progress = nullptr);

/** \brief The same; where points were given sides, the store keeps them, and projectPoints() puts
 * each point onto its own side. Where noise is wider than the spacing and sides are in doubt, the
 * store's points are moved to local planes (SideStatistics::plane_neighbors): a further fit starts
 * from there. Sides of an earlier fit are dropped first. */
PCL_SLIM_EXPORT Error fitSurface(PointStore& store, const FitParams& params, SLIMSurface& surface,
                                 FitStatistics* statistics = nullptr, Progress* progress = nullptr);

}  // namespace pcl_slim
