// SPDX-License-Identifier: BSD-3-Clause
// Signs that are mostly right: regions that contradict their neighbours turn (docs/sides.md, "Which
// side is out").
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pcl_slim/cloud/detail/signed_graph.h"

namespace pcl_slim::detail {

SignedRegions::SignedRegions(std::size_t nodes) : region_(nodes) {
  std::iota(region_.begin(), region_.end(), 0u);
}

std::uint32_t SignedRegions::rootOf(std::uint32_t node) {
  while (region_[node] != node) node = region_[node] = region_[region_[node]];
  return node;
}

void SignedRegions::join(std::uint32_t a, std::uint32_t b) {
  a = rootOf(a);
  b = rootOf(b);
  region_[std::max(a, b)] = std::min(a, b);
}

std::size_t SignedRegions::number() {
  std::vector<std::uint32_t> numbers(region_.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < region_.size(); ++i) {
    const std::uint32_t root = rootOf(i);
    numbers[i] = root == i ? count++ : numbers[root];  // a root is the least node of its region
  }
  region_ = std::move(numbers);
  return count;
}

void Opposition::add(const SidePatch& p, const SidePatch& q) {
  constexpr double kOpposed = -0.5;   // agreement: of one sheet
  constexpr double kOpposite = -0.9;  // cosine: the two faces of a sharp edge are not opposite
  constexpr double kLevel = 0.02;     // sine of a step off a plane that is rounding
  if (!(dot(p.normal, q.normal) < kOpposite && agreementOf(p, q) < kOpposed)) return;
  const Vector3 between = subtract(q.center, p.center);
  const double step = kLevel * length(between);
  const double of_p = dot(p.normal, between), of_q = -dot(q.normal, between);
  (of_p > step && of_q > step ? ahead : of_p < -step && of_q < -step ? behind : level) += 1;
}

namespace {

/** Turns the parts most of whose patches have turned; outward where it is no clear majority. */
void followMost(const std::vector<SidePatch>& patches, const std::vector<SignedEdge>& edges,
                SignedParts& found) {
  constexpr double kLeastMean = 0.5;  // that of three quarters of one sign
  std::vector<double> sum(patches.size(), 0.0), count(patches.size(), 0.0);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    sum[found.part[i]] += found.signs[i];
    ++count[found.part[i]];
  }
  std::vector<signed char> outward;  // made where a part needs it
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const double mean = sum[found.part[i]] / count[found.part[i]];
    const bool undecided = std::abs(mean) < kLeastMean;
    if (undecided && outward.empty()) outward = signsOutward(patches, edges);
    if (undecided)
      found.signs[i] = outward[i];
    else if (mean < 0)
      found.signs[i] = static_cast<signed char>(-found.signs[i]);
  }
}

}  // namespace

std::vector<signed char> signsOfGiven(const std::vector<SidePatch>& patches,
                                      const std::vector<SignedEdge>& edges,
                                      const std::vector<double>& votes) {
  constexpr double kOneSheet = 0.8;  // least agreement of patches of one region
  constexpr double kBehind = 0.5;    // what patches behind each other have of a pair that agrees
  constexpr std::uint32_t kFew = 4;  // patches of a region that is no sheet
  SignedRegions regions(patches.size());
  for (const SignedEdge& e : edges) {
    if (e.agreement > kOneSheet) regions.join(e.a, e.b);
  }
  const std::size_t count = regions.number();
  std::vector<std::uint32_t> sizes(count, 0);
  for (std::uint32_t i = 0; i < patches.size(); ++i) ++sizes[regions.of(i)];
  std::vector<SignedEdge> between;
  for (const SignedEdge& e : edges) {
    const std::uint32_t a = regions.of(e.a), b = regions.of(e.b);
    if (a == b) continue;
    Opposition pair;
    pair.add(patches[e.a], patches[e.b]);
    // A few points behind others are points that noise has moved, no thin part.
    const double behind = std::min(sizes[a], sizes[b]) < kFew ? -1 : kBehind;
    const double agreement =
        std::max(0.0f, e.agreement) + behind * pair.behind - pair.level - pair.ahead;
    if (agreement != 0) between.push_back({a, b, agreement});
  }
  SignedParts found;
  if (!votes.empty()) {
    std::vector<double> sums(count, 0.0);
    for (std::uint32_t i = 0; i < votes.size(); ++i) sums[regions.of(i)] += votes[i];
    found.signs = signsByVotes(std::move(between), sums);
  } else {
    found = contractSigned(count, between);
  }
  SignedParts result;
  result.signs.resize(patches.size());
  result.part.resize(patches.size());
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    result.signs[i] = found.signs[regions.of(i)];
    if (votes.empty()) result.part[i] = found.part[regions.of(i)];
  }
  if (votes.empty()) followMost(patches, edges, result);
  return std::move(result.signs);
}

}  // namespace pcl_slim::detail
