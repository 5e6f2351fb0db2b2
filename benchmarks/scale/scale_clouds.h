// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pcl_slim {

/** \brief Surfaces with formulas, as large scans have them: a bumpy body with fine relief on one
 * half (statue, skew) or terrain (sheet). */
class ScaleSurface {
 public:
  enum class Kind { kStatue, kSheet, kSkew };

  explicit ScaleSurface(Kind kind) : kind_(kind) {}

  /** \brief Point i of a scan without noise: 64 overlapping views, uneven density; of kSkew 60 % of
   * the points are on the top tenth. */
  std::array<double, 3> point(std::uint64_t i, std::uint64_t count) const;
  /** \brief Unit normal at a point near the surface, outward or upward. */
  std::array<double, 3> normal(const std::array<double, 3>& p) const;
  /** \brief Signed distance from the surface, to first order. */
  double distance(const std::array<double, 3>& p) const;
  /** \brief Whether a place is at one of the body's ends, where views beyond them put a clump of
   * points. */
  bool isClump(const std::array<double, 3>& p) const;
  /** \brief About the diagonal of the bounding box. */
  double diagonal() const;

 private:
  double height(const std::array<double, 3>& p) const;
  std::array<double, 3> gradient(const std::array<double, 3>& p) const;

  Kind kind_;
};

/** \brief Independent uniform numbers in [0, 1) of point i; k picks one of them. */
double uniformAt(std::uint64_t i, std::uint64_t k);

/** \brief A normal deviate likewise. */
double gaussianAt(std::uint64_t i, std::uint64_t k);

}  // namespace pcl_slim
