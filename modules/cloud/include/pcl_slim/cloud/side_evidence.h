// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief What decides which side of a cloud's surface is out. */
enum class SideSource : unsigned char {
  kNone,       ///< nothing
  kNormals,    ///< the points' normals
  kSensors,    ///< the place that each point was seen from
  kViewpoint,  ///< one viewpoint, or the cloud's only sensor
  kOrigin,     ///< a scanner at the origin, as the points' spacing shows
  kThinParts,  ///< sides that points were given before the cover of a fit
  kOutward     ///< the shape alone: away from the middle of each connected part
};

/** \brief "normals", "sensors", "viewpoint", "origin", "thin_parts", "outward", or "none". */
PCL_SLIM_EXPORT const char* nameOf(SideSource source);

/** \brief What is known of the side of a cloud's surface, before its shape is asked. */
struct SideEvidence {
  SideSource source = SideSource::kNone;  ///< the first five only
  /// for kViewpoint and kOrigin: what the surface faces, world coordinates
  std::optional<std::array<double, 3>> eye;
};

/** \brief Finds the strongest evidence: the points' normals; a viewpoint given by the user; the
 * points' own sensors; the sensor of the cloud; the origin, if the cloud shows that it was scanned
 * from there (scannerSpread()). The only place that orders them: fits, projections, splats, normals
 * and tiles ask it. O(points) at most; any number of threads gives the same. */
PCL_SLIM_EXPORT SideEvidence
findSideEvidence(const PointStore& store, const std::optional<std::array<double, 3>>& viewpoint);

/** \brief The same without regard to normals: for points that have none among others that do. */
PCL_SLIM_EXPORT SideEvidence
findSensorEvidence(const PointStore& store, const std::optional<std::array<double, 3>>& viewpoint);

/** \brief Whether points were scanned from a place, by their spacing.
 *
 * A scanner at distance r sees equal solid angles, so that points have areas a = w r^2 / cos with
 * the angle between beam and normal. Where that is so, log(a cos / r^2) is spread less than log(a).
 * \param[in] eye world coordinates. \return the ratio of both spreads (median absolute deviations,
 * of 128 places, or 512 where these leave doubts): .06 to .7 of lidars' and depth cameras' scans
 * from where they were made, .9 and more of objects, and of merged, turned or evenly thinned scans;
 * 1 where too few places show it, or r^2 / cos is too much alike. Noise, outliers and the number of
 * points do not matter. O(1). */
PCL_SLIM_EXPORT double scannerSpread(const PointStore& store, const std::array<double, 3>& eye);

/// Largest scannerSpread() of a place that a cloud was scanned from.
constexpr double kMostScannerSpread = 0.8;

/** \brief How far given normals of neighbouring points contradict each other. */
struct NormalAgreement {
  double opposed = 0;       ///< share of neighbours with opposed normals
  double contradicted = 0;  ///< less those of thin parts and gaps
  double axis = 1;          ///< mean |cosine| of neighbours' normals

  /** \brief In scans and meshes no pair does; on thin parts up to .0014 of all pairs do and .06 of
   * the opposed ones. */
  bool contradicts() const { return contradicted > 0.002 && contradicted > 0.25 * opposed; }
  /** \brief The normals of the roughest scans are at .8, random directions at .5. */
  bool hasAxes() const { return axis > 0.65; }
};

/** \brief Measures that at up to 1024 places. O(1). */
PCL_SLIM_EXPORT NormalAgreement measureNormals(const PointStore& store);

/** \brief Makes given normals that contradict each other agree: turns as few regions of them as that
 * takes. They face what the points were seen from where that is known, else each connected part as
 * most of its normals did or, where these are undecided, outward. Normals without a common axis are
 * dropped. O(n log n). \return what was found; nothing opposed where the normals stayed as they are */
PCL_SLIM_EXPORT NormalAgreement settleNormals(const std::optional<std::array<double, 3>>& viewpoint,
                                              int threads, PointStore& store);

/** \brief Turns normals of arbitrary sign, as estimates have: to what their points were seen from,
 * where findSensorEvidence() finds that, else so that neighbours agree and each connected part faces
 * outward. O(n log n). \param[in] cloud the points \param[in,out] normals three floats for each of
 * the points behind the view; those that are zero, not finite or not selected stay as they are */
PCL_SLIM_EXPORT void faceNormals(const CloudView& cloud,
                                 const std::optional<std::array<double, 3>>& viewpoint, int threads,
                                 std::vector<float>& normals);

/** \brief What a user may want otherwise of the sides that were chosen: a sentence each, without a
 * full stop. None where normals, sensors or a viewpoint decided and agreed.
 * \param[in] normals the given ones \param[in] remedy how a viewpoint is given, as
 * "-viewpoint X,Y,Z" */
PCL_SLIM_EXPORT std::vector<std::string> sideNotes(SideSource source,
                                                   const NormalAgreement& normals,
                                                   const std::string& remedy);

}  // namespace pcl_slim
