// SPDX-License-Identifier: BSD-3-Clause
#include "lines/chains.h"

#include <gtest/gtest.h>

namespace pcl_slim::detail {
namespace {

using Joints = std::vector<std::uint32_t>;

TEST(Chains, LinksInAnyOrderMakeOneLine)
{
  const auto chains = joinLinks({{{3, 4}}, {{1, 2}}, {{3, 2}}}, 8);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_FALSE(chains[0].closed);
  EXPECT_EQ(chains[0].joints, (Joints{4, 3, 2, 1}));
}

TEST(Chains, ARingIsClosed)
{
  const auto chains = joinLinks({{{0, 1}}, {{1, 2}}, {{2, 0}}}, 3);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_TRUE(chains[0].closed);
  EXPECT_EQ(chains[0].joints.size(), 3u);
}

TEST(Chains, AJunctionEndsLines)
{
  const auto chains = joinLinks({{{0, 1}}, {{1, 2}}, {{1, 3}}}, 4);
  EXPECT_EQ(chains.size(), 3u);
  for (const Chain& chain : chains) EXPECT_EQ(chain.joints.size(), 2u);
}

TEST(Chains, NothingMakesNothing)
{
  EXPECT_TRUE(joinLinks({}, 0).empty());
}

}  // namespace
}  // namespace pcl_slim::detail
