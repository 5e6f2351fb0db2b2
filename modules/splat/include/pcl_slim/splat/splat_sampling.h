// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "pcl_slim/splat/splat_radius.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief Where a splat's colour comes from. */
enum class SplatColor : unsigned char {
  kMean,      ///< mean CIELAB of the cell (default)
  kGradient,  ///< the same, and how it changes across the disc
  kOwn        ///< the colour of the point that is kept
};

/** \brief What sampleSplats() does. Every default suits a scan of any size and unit. */
struct PCL_SLIM_EXPORT SplatParams {
  int initial_resolution = 0;    ///< root cells along the longest side; 0: about n / 50 occupied
  double geometric_error = 0.2;  ///< standard deviation of unit normals that a cell may have, >= 0
  double color_error = 0.1;      ///< of CIELAB / 100, >= 0; from 1 on colour is ignored
  std::uint32_t min_points = 4;  ///< cells of fewer points stay whole
  int max_depth = 20;            ///< halvings of a root cell at most, >= 0; 0: the uniform grid
  std::uint64_t max_splats = 0;  ///< solve for a count instead of tolerances; 0: off
  double target_error = 0;       ///< solve for a mean error [Delta E] instead; 0: off
  bool paper_mode = false;       ///< corner radius, own colour and position, no guard against noise
  RgbSpace rgb_space = RgbSpace::kSrgb;      ///< paper mode: kEbu
  SplatColor color = SplatColor::kMean;      ///< paper mode: kOwn
  RadiusRule radius = RadiusRule::kDensity;  ///< paper mode: kCorner
  bool remove_noise = true;   ///< take the noise of colours and normals off deviations
  int normal_neighbors = 16;  ///< about, of each point of a cloud without normals; >= 3
  /// what estimated normals face; none: what findSideEvidence() finds, or outward
  std::optional<std::array<double, 3>> viewpoint;
  int threads = 0;  ///< 0: all cores; never changes the result

  /** \brief The first parameter out of range, or no error. */
  Error validate() const;
};

/** \brief What sampleSplats() did. */
struct SplatStatistics {
  std::uint64_t points = 0;      ///< points used
  std::uint64_t duplicates = 0;  ///< points skipped: another is equal in place, normal and colour
  std::uint64_t non_finite = 0;  ///< points skipped: a coordinate is NaN or infinite
  std::uint64_t far_away = 0;    ///< points skipped: strays, as PointStore leaves them out
  std::uint64_t roots = 0;       ///< occupied root cells
  std::uint64_t splats = 0;
  std::uint64_t single_points = 0;   ///< splats of one point
  std::uint64_t without_normal = 0;  ///< splats none of whose points had a normal
  std::uint64_t tree_cells = 0;      ///< budgets: cells of the whole octree
  int resolution = 0;                ///< root cells along the longest side
  double cell = 0;                   ///< edge of a root cell [world]
  double spacing = 0;                ///< middle distance between neighbours [world]
  double color_noise = 0;            ///< standard deviation [Delta E], as taken off
  double normal_noise = 0;           ///< standard deviation of unit normals, as taken off
  double error = 0;                  ///< budgets: mean Delta E between points and their cells
  bool normals_estimated = false;
  SideSource sides = SideSource::kNone;  ///< what decided which way the splats face
  NormalAgreement normals;               ///< of neighbouring splats, if normals were given
  double seconds_order = 0, seconds_normals = 0, seconds_divide = 0, seconds_splats = 0;
};

/** \brief Turns a cloud into coloured discs that cover its surface: one for each cell of an octree
 * divided where normals or colours vary.
 *
 * Colours and normals are optional: without colours shape alone divides, without normals they come
 * from neighbours. Points without a normal among others are used without one. The order of the
 * points, those that are not finite, strays and those that repeat another change nothing. \param[out]
 * splats cleared first; empty on error. \param[out] statistics may be null. \param[in] progress may
 * be null. O(N). The same splats for any number of threads.
 */
PCL_SLIM_EXPORT Error sampleSplats(const CloudView& cloud, const ColorView& colors,
                                   const SplatParams& params, SplatSet& splats,
                                   SplatStatistics* statistics = nullptr,
                                   Progress* progress = nullptr);

}  // namespace pcl_slim
