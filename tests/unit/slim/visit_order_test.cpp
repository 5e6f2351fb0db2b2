// SPDX-License-Identifier: BSD-3-Clause
// The order in which a cell's centres are tried.
#include "visit_order.h"

#include <gtest/gtest.h>

#include <vector>

namespace pcl_slim {
namespace {

TEST(VisitOrder, VisitsEveryPlaceOnceAndKnowsWhen)
{
  for (const std::uint32_t n : {1u, 2u, 3u, 4u, 5u, 8u, 13u, 21u, 100u, 210u, 1557u, 4096u}) {
    for (const std::uint32_t start : {0u, n / 3, n - 1}) {
      VisitOrder order(n, start);
      VisitOrder asked = order;
      asked.prepareWhen();
      std::vector<char> seen(n, 0);
      EXPECT_EQ(order.at(), start);
      for (std::uint32_t visit = 0; visit < n; ++visit, order.advance()) {
        ASSERT_LT(order.at(), n);
        ASSERT_EQ(seen[order.at()], 0) << n;
        seen[order.at()] = 1;
        ASSERT_EQ(asked.when(order.at()), visit) << n << " from " << start;
      }
      EXPECT_EQ(order.at(), start);
    }
  }
}

TEST(VisitOrder, CountsBeyondHalfOf32Bits)
{
  const std::uint32_t n = 4000000007u;
  VisitOrder order(n, n - 5);
  VisitOrder asked = order;
  asked.prepareWhen();
  for (std::uint32_t visit = 0; visit < 1000; ++visit, order.advance()) {
    ASSERT_LT(order.at(), n);
    ASSERT_EQ(asked.when(order.at()), visit);
  }
}

}  // namespace
}  // namespace pcl_slim
