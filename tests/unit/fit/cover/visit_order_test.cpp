// SPDX-License-Identifier: BSD-3-Clause
// The order in which a cell's centres are tried.
#include "cover/cover.h"

#include <gtest/gtest.h>

#include <vector>

namespace pcl_slim {

using namespace detail;

namespace {

TEST(VisitOrder, VisitsEveryPlaceOnceAndKnowsWhen) {
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

TEST(VisitOrder, CountsBeyondHalfOf32Bits) {
  const std::uint32_t n = 4000000007u;
  VisitOrder order(n, n - 5);
  VisitOrder asked = order;
  asked.prepareWhen();
  for (std::uint32_t visit = 0; visit < 1000; ++visit, order.advance()) {
    ASSERT_LT(order.at(), n);
    ASSERT_EQ(asked.when(order.at()), visit);
  }
}

/** Every point of a cell that still wants one is visited once, in the order of golden strides,
 * however many points each visit marks: few, then all are met on the way; or many, then the rest is
 * searched for. */
TEST(CellVisits, FindsWhatIsLeftInOrder) {
  const std::uint32_t n = 3000, start = 17;
  std::vector<std::uint32_t> points(n);
  for (std::uint32_t i = 0; i < n; ++i) points[i] = 5 * i;
  for (const std::uint32_t done_per_visit : {1u, 2u, 40u, 1000u}) {
    const auto mark = [&](std::vector<char>& done, std::uint32_t i) {
      for (std::uint32_t k = 0; k < done_per_visit; ++k) done[(i + 7 * k) % n] = 1;
    };
    std::vector<std::uint32_t> expected, visited;
    std::vector<char> done(n, 0);
    VisitOrder order(n, start);
    for (std::uint32_t visit = 0; visit < n; ++visit, order.advance()) {
      if (done[order.at()]) continue;
      expected.push_back(points[order.at()]);
      mark(done, order.at());
    }
    done.assign(n, 0);
    CellVisits visits(points.data(), n, start);
    const auto is_done = [&](std::uint32_t point) { return done[point / 5] != 0; };
    for (std::uint32_t point; visits.next(is_done, point);) {
      visited.push_back(point);
      mark(done, point / 5);
    }
    EXPECT_EQ(visited, expected) << done_per_visit;
  }
}

/** A point handed out is not handed out again while nobody has done it yet. */
TEST(CellVisits, HandsOutEachPointOnce) {
  const std::uint32_t n = 2000;
  std::vector<std::uint32_t> points(n);
  for (std::uint32_t i = 0; i < n; ++i) points[i] = i;
  CellVisits visits(points.data(), n, 0);
  std::vector<int> times(n, 0);
  const auto odd = [](std::uint32_t point) { return point % 2 == 1 || point > 300; };
  for (std::uint32_t point; visits.next(odd, point);) ++times[point];
  for (std::uint32_t i = 0; i < n; ++i) EXPECT_EQ(times[i], odd(i) ? 0 : 1) << i;
}

}  // namespace
}  // namespace pcl_slim
