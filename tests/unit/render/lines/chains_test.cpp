// SPDX-License-Identifier: BSD-3-Clause
#include "lines/lines.h"

#include <gtest/gtest.h>

namespace pcl_slim::detail {
namespace {

using Joints = std::vector<std::uint32_t>;

TEST(Chains, LinksInAnyOrderMakeOneLine) {
  const auto chains = joinLinks({{{3, 4}}, {{1, 2}}, {{3, 2}}}, 8);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_FALSE(chains[0].closed);
  EXPECT_EQ(chains[0].joints, (Joints{4, 3, 2, 1}));
}

TEST(Chains, ARingIsClosed) {
  const auto chains = joinLinks({{{0, 1}}, {{1, 2}}, {{2, 0}}}, 3);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_TRUE(chains[0].closed);
  EXPECT_EQ(chains[0].joints.size(), 3u);
}

TEST(Chains, AJunctionEndsLines) {
  const auto chains = joinLinks({{{0, 1}}, {{1, 2}}, {{1, 3}}}, 4);
  EXPECT_EQ(chains.size(), 3u);
  for (const Chain& chain : chains) EXPECT_EQ(chain.joints.size(), 2u);
}

TEST(Chains, ShortPiecesBetweenJunctionsOfALongLineStay) {
  // 0 - 5 and 6 - 11 are long; 5 - 6 bridges them, 5 - 12 and 6 - 13 are burrs.
  std::vector<Link> links{{{5, 6}}, {{5, 12}}, {{6, 13}}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    links.push_back({{i, i + 1}});
    links.push_back({{i + 6, i + 7}});
  }
  const auto chains = joinLinks(links, 14);
  ASSERT_EQ(chains.size(), 5u);
  const auto keep = longEnough(chains, 14, 6.0);
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const Joints& joints = chains[i].joints;
    const bool is_burr = joints.front() > 11 || joints.back() > 11;
    EXPECT_EQ(keep[i] != 0, !is_burr) << joints.front() << " - " << joints.back();
  }
  // All of it hangs together, and is too short for this.
  for (const std::uint8_t flag : longEnough(chains, 14, 40.0)) EXPECT_EQ(flag, 0);
}

TEST(Chains, MembersOfASetAreNumberedInOrder) {
  NumberedSet set(1000);
  const Joints members{0, 1, 63, 64, 65, 127, 500, 999};
  for (const std::uint32_t i : {500u, 0u, 999u, 64u, 1u, 127u, 63u, 65u, 500u}) set.add(i);
  ASSERT_EQ(set.count(), members.size());
  for (std::uint32_t i = 0; i < members.size(); ++i) EXPECT_EQ(set.numberOf(members[i]), i);
}

TEST(Chains, NothingMakesNothing) {
  EXPECT_TRUE(joinLinks({}, 0).empty());
  EXPECT_TRUE(longEnough({}, 0, 12.0).empty());
}

}  // namespace
}  // namespace pcl_slim::detail
