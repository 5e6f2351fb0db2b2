// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/memory.h>
#include <pcl/pcl_macros.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <boost/mpl/vector/vector30.hpp>
#include <cstdint>

namespace pcl_slim {

/** \brief One surfel as a PCL point: ball, normal and polynomial, all fields but two float.
 *
 * Lengths are in the cloud's units, coefficients carry none: with r the radius and (u, v, w) the
 * frame of the normal (LocalFrame), the surface inside the ball is
 *
 *     w / r = c0 + c1 (u/r) + c2 (v/r) + c3 (u/r)^2 + ...
 *
 * in the order of surface/polynomial.h. Coefficients are separate scalars because viewers pass over fields with more than one element.
 */
struct EIGEN_ALIGN16 PointSLIM {
  PCL_ADD_POINT4D
  PCL_ADD_NORMAL4D
  float c[15];   ///< the polynomial, fields c0 ... c14; those beyond its degree are 0
  float radius;  ///< radius of the ball, cloud units
  float degree;  ///< degree of the polynomial, 1..4
  float level;   ///< level of the hierarchy, 1 = coarsest
  float leaf;    ///< 0: internal node, 1: leaf, 3: leaf that ended by minimum support; 4 more if
                 ///< data end or leave a hole in its ball
  float error;   ///< weighted RMS residual of the fit, cloud units
  float confidence;                   ///< effective number of points behind the fit
  std::uint32_t trim_low, trim_high;  ///< then: 8 x 8 bits over the square about the ball, where
                                      ///< data are; row by row from v = -r, lowest bit u = -r

  PointSLIM()
      : data{0.0f, 0.0f, 0.0f, 1.0f},
        data_n{0.0f, 0.0f, 0.0f, 0.0f},
        c{},
        radius(0.0f),
        degree(1.0f),
        level(1.0f),
        leaf(1.0f),
        error(0.0f),
        confidence(0.0f),
        trim_low(0),
        trim_high(0) {}

  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace pcl_slim

// PCL's one-line registration ends at 20 fields (boost::mpl::vector's default limit, which a header
// must not change for its users), so its steps are repeated here. The arithmetic operators it
// would add make no sense for surfels.
// clang-format off
#define PCL_SLIM_COEFFICIENT_TAGS                                                              \
  ((float, c[0], c0))((float, c[1], c1))((float, c[2], c2))((float, c[3], c3))                 \
  ((float, c[4], c4))((float, c[5], c5))((float, c[6], c6))((float, c[7], c7))                 \
  ((float, c[8], c8))((float, c[9], c9))((float, c[10], c10))((float, c[11], c11))             \
  ((float, c[12], c12))((float, c[13], c13))((float, c[14], c14))
#define PCL_SLIM_POINT_TAGS                                                                    \
  ((float, x, x))((float, y, y))((float, z, z))((float, normal_x, normal_x))                   \
  ((float, normal_y, normal_y))((float, normal_z, normal_z))((float, radius, radius))          \
  PCL_SLIM_COEFFICIENT_TAGS((float, degree, degree))((float, level, level))                    \
  ((float, leaf, leaf))((float, error, error))((float, confidence, confidence))             \
  ((std::uint32_t, trim_low, trim_low))((std::uint32_t, trim_high, trim_high))

namespace pcl {
namespace fields {
BOOST_PP_SEQ_FOR_EACH(POINT_CLOUD_REGISTER_FIELD_TAG, pcl_slim::PointSLIM, PCL_SLIM_POINT_TAGS)
}  // namespace fields
namespace traits {
BOOST_PP_SEQ_FOR_EACH(POINT_CLOUD_REGISTER_FIELD_NAME, pcl_slim::PointSLIM, PCL_SLIM_POINT_TAGS)
BOOST_PP_SEQ_FOR_EACH(POINT_CLOUD_REGISTER_FIELD_OFFSET, pcl_slim::PointSLIM, PCL_SLIM_POINT_TAGS)
BOOST_PP_SEQ_FOR_EACH(POINT_CLOUD_REGISTER_FIELD_DATATYPE, pcl_slim::PointSLIM, PCL_SLIM_POINT_TAGS)
template <>
struct fieldList<pcl_slim::PointSLIM> {
  using type = boost::mpl::vector29<
      BOOST_PP_SEQ_ENUM(BOOST_PP_SEQ_TRANSFORM(POINT_CLOUD_TAG_OP, _, PCL_SLIM_POINT_TAGS))>;
};
}  // namespace traits
}  // namespace pcl
#undef PCL_SLIM_POINT_TAGS
#undef PCL_SLIM_COEFFICIENT_TAGS
// clang-format on
