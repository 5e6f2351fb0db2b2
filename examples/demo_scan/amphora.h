// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

namespace pcl_slim::demo {

using Point = std::array<double, 3>;

/** \brief A painted Greek amphora as an implicit solid: hollow body of revolution with relief
 * ornament and two handles. Metres, z up, base at z = 0, 0.46 high. */
class Amphora {
 public:
  /** \param[in] dent depth of a dent in the belly, 6 cm wide [m], 0: none; its volume is
   * pi (3 cm)^2 dent / 3 */
  explicit Amphora(double dent = 0.0);

  /** \brief Signed distance, never larger than the true one by much: march with steps of 0.7. */
  double distance(const Point& p) const;
  /** \brief Outward unit normal at a surface point, by differences. */
  Point normal(const Point& p) const;
  /** \brief Paint at a surface point, sRGB in [0, 1]. */
  std::array<double, 3> color(const Point& p) const;

  static constexpr double kHeight = 0.46;
  static constexpr Point kCenter{0.0, 0.0, 0.23};  ///< centre of a bounding ball
  static constexpr double kReach = 0.29;           ///< its radius
  static constexpr double kDiagonal = 0.61;        ///< of the bounding box

 private:
  struct Profile {
    double radius, slope;
  };

  Profile profileAt(double z) const;
  double bodyDistance(double rho, double angle, double z) const;
  double handleDistance(const Point& p) const;
  /** \brief How deep the dent is at a place of the belly. */
  double dentAt(double angle, double z) const;

  double dent_;
  std::vector<Profile> profile_;               ///< table over z
  std::vector<std::array<double, 2>> handle_;  ///< polyline in the (|x|, z) plane
};

}  // namespace pcl_slim::demo
