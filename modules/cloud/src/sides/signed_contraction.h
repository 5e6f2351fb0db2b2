// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace pcl_slim::detail {

/** \brief Two nodes, and how much they agree: > 0 if they should have the same sign, < 0 if opposite
 * ones. */
struct SignedEdge {
  std::uint32_t a, b;
  double agreement;
  bool apart = false;  ///< on two sheets
};

/** \brief Signs of the nodes of a graph, and the connected part that each belongs to. */
struct SignedParts {
  std::vector<signed char> signs;   ///< within a part; the whole part may be turned
  std::vector<std::uint32_t> part;  ///< for each node: the least node of its part
};

/** \brief Signs that make the sum of s_a s_b agreement large, by greedy additive contraction (Keuper
 * et al. 2015; signs as in correlation clustering): the two components with the strongest summed
 * agreement are joined, one of them turned if the sum is negative, until no edge is left between
 * components. Ties by nodes. \param[in] edges each pair once. O(edges log^2 edges). */
SignedParts
contractSigned(std::size_t nodes, const std::vector<SignedEdge>& edges);

}  // namespace pcl_slim::detail
