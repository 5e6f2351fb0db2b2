// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/query/standard_errors.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief How points are moved onto the blended surface. */
struct ProjectionParams {
  bool curvature = false;    ///< also blend Hessians (eq. 8, left)
  bool directions = false;   ///< also principal curvatures and directions; implies curvature
  bool extremality = false;  ///< also their derivatives along the directions; implies directions
  bool errors = false;       ///< also standard errors; of curvature where curvature is requested
  /// of a cloud's projection, also the plane through each projected point's neighbours: surface
  /// variation, and normals of points without support
  bool planes = false;
  /// with planes: surface variation of all points; false: the planes of points without support alone
  bool variation = true;
  bool sharp_features =
      false;  ///< as the fit's: leaves count at points of normals within 60 degrees
  /// > 0: the points are places, not measurements of the surface: leaves up to this share of a
  /// ball's radius away count, whatever the residuals
  double reach = 0;
  int threads = 0;  ///< 0: all cores; never changes the result
};

/** \brief Greatest and least normal curvature, 1/local length, and the unit tangents along which
 * they occur.
 *
 * k1 >= k2; directions are perpendicular to each other and to the normal, each with an arbitrary
 * sign. Where k1 = k2 any pair of tangents is right, and some pair is given. The extremalities
 * dk1/dt1 and dk2/dt2, from blended third derivatives (those of cubics and quartics), change sign
 * on crest lines. All zero where unsupported.
 */
struct PrincipalFrame {
  float k1 = 0, k2 = 0;
  std::array<float, 3> direction1{}, direction2{};
  float extremality1 = 0, extremality2 = 0;  ///< 1/local length^2, if requested
};

/** \brief Result per stored point, the store's local units. */
struct Projection {
  std::vector<std::array<double, 3>> position;  ///< unchanged where unsupported
  std::vector<std::array<float, 3>> normal;     ///< unit; zero where unsupported
  std::vector<std::array<float, 2>> curvature;  ///< mean and Gaussian, 1/local length, 1/length^2
  std::vector<PrincipalFrame> principal;        ///< if requested
  std::vector<StandardErrors> errors;           ///< if requested; zero where unsupported
  std::vector<std::uint8_t> supported;  ///< 0: no surfel supports the point, it kept its place
  std::vector<std::uint8_t>
      inside;  ///< 0: unsupported, or beyond the surface's borders (trim maps)
  std::uint64_t num_unsupported = 0;
};

/** \brief Moves every stored point along the blended direction of its leaves onto the surface.
 *
 * Equations (6) and (7) of Ohtake, Belyaev, Alexa 2005 with q^ = p, guarded: the weight is taken at
 * the larger of |p - c| and |q - c|, a root counts only within 5 e and r / 4 of p, and where both
 * sides have normals a leaf counts only at points with a similar normal; where the fit found the
 * sides, points without such a leaf take all. Weights carry the inverse variance v / (v + e^2) of
 * each leaf, v = lambda + (r / 1000)^2 being what is expected. Surfels without orientation are
 * aligned in sign to each other, point by point. Never emits NaN. Curvature is positive where the
 * surface bends away from its normal (a sphere with outward normals has mean 1/R). The points need
 * not be those the surface was fitted to: both are in world coordinates through their origins and
 * scales, and points away from it are unsupported. A surface of info.paper_mode is projected onto
 * by formula (6) as printed, without the guards. Trim maps move no point and drop none: they only
 * decide which of them are inside the borders.
 */
PCL_SLIM_EXPORT Error projectPoints(const PointStore& store, const SLIMSurface& surface,
                                    const ProjectionParams& params, Projection& result,
                                    Progress* progress = nullptr);

}  // namespace pcl_slim
