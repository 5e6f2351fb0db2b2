// SPDX-License-Identifier: BSD-3-Clause
// A point type of the user's own needs one include.
#include "pcl_slim/filters/impl/slim_fit.hpp"

#include <gtest/gtest.h>

#include "door_suite.h"

namespace pcl_slim_test {

struct EIGEN_ALIGN16 LabelledPoint {
  float weight = 0.0f;  // before the coordinates, so that nothing may count on their place
  PCL_ADD_POINT4D;
  std::uint16_t label = 0;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace pcl_slim_test

POINT_CLOUD_REGISTER_POINT_STRUCT(pcl_slim_test::LabelledPoint,
                                  (float, weight,
                                   weight)(float, x, x)(float, y, y)(float, z, z)(std::uint16_t,
                                                                                  label, label))

namespace pcl_slim {
namespace {

TEST(CustomPoint, FitsWithAndWithoutEstimatedNormals) {
  SLIMFit<pcl_slim_test::LabelledPoint> fit;
  fit.setInputCloud(pcl_slim_test::bumpySphere<pcl_slim_test::LabelledPoint>(2000));
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_NEAR(surface.info.diagonal * surface.info.scale, 2.0 * std::sqrt(3.0), 0.2);
  fit.setNormalEstimationNeighbors(12);
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_TRUE(surface.info.oriented);
}

}  // namespace
}  // namespace pcl_slim
