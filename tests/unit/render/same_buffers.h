// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::test {

/** Every column of two pictures' buffers. */
inline void expectSame(const GBuffer& a, const GBuffer& b) {
  for (const auto column : {&GBuffer::depth, &GBuffer::mean_curvature, &GBuffer::gaussian_curvature,
                            &GBuffer::radius, &GBuffer::weight, &GBuffer::coverage}) {
    EXPECT_EQ(a.*column, b.*column);
  }
  for (const auto column :
       {&GBuffer::position, &GBuffer::normal, &GBuffer::gradient, &GBuffer::color}) {
    EXPECT_EQ(a.*column, b.*column);
  }
  EXPECT_EQ(a.hessian, b.hessian);
  EXPECT_EQ(a.principal, b.principal);
  EXPECT_EQ(a.surfel, b.surfel);
}

}  // namespace pcl_slim::test
