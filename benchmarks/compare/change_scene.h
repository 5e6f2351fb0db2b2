// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/vector3.h"
#include "support/lab/scenes.h"

/** \brief Scans of one exact surface, and of that surface with a dent of known depth. */
namespace pcl_slim::change {

/** \brief A dent: the surface is moved against its normal by depth within a ball about a place of it,
 * less by a cosine over the outer part of the ball. */
struct Dent {
  double depth = 0, radius = 0;         ///< scene units
  Vector3 near{0.36, 0.48, 0.8};        ///< the middle is the point nearest to it
  static constexpr double kCore = 0.8;  ///< [radius] full depth within
};

/** \brief Points with noise, and the truth at each. */
struct Scan {
  std::vector<Vector3> points;
  std::vector<Vector3> normals;  ///< exact, of the surface without the dent
  std::vector<double> change;    ///< exact signed distance of the surface there from that one
  std::vector<bool> rim;         ///< next to an open border
  double diagonal = 0;

  CloudView view() const;
};

/** \brief count points of a shape. \param[in] noise isotropic deviation, share of the diagonal */
Scan scanOf(measure::Shape shape, std::size_t count, double noise, std::uint64_t seed,
            const Dent& dent);

/** \brief An estimate of the change at some of a scan's points. */
struct Estimate {
  std::vector<double> distance;   ///< signed along the exact normal; NaN: none
  std::vector<double> detection;  ///< 95 % level of detection; empty: the method has none
  double seconds = 0;             ///< CPU, for the whole scan
};

/** \brief How good an estimate is. */
struct Score {
  double rms = 0;        ///< of the error of distance
  double within = 0;     ///< share of points whose error is within the level of detection
  double detected = 0;   ///< share of the dent's core beyond the level of detection
  double volume = 0;     ///< of the dent over the true one
  double known = 0;      ///< share of points that have a distance
  double detection = 0;  ///< median level of detection
};

/** \brief Points next to the rim do not count. \param[in] chosen the points of the estimate
 * \param[in] threshold in place of levels of detection where the method has none */
Score scoreOf(const Scan& scan, const std::vector<std::size_t>& chosen, const Estimate& estimate,
              double threshold);

}  // namespace pcl_slim::change
