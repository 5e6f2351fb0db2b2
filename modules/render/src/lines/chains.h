// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_slim::detail {

/** \brief A piece of a line between two joints, which are named by numbers. */
struct Link {
  std::array<std::uint32_t, 2> joint{};
};

/** \brief Joints in the order in which a line passes them. */
struct Chain {
  std::vector<std::uint32_t> joints;
  bool closed = false;
};

/** \brief Joins links that share a joint into chains; joints of more than two links end chains.
 * O(links + joints).
 * \param[in] num_joints joints are below it */
std::vector<Chain>
joinLinks(const std::vector<Link>& links, std::size_t num_joints);

/** \brief Which chains are long enough, a flag each: those of least_length joints, and shorter ones
 * between two joints of others if all that hangs together is as long. What is short and ends in
 * nothing is a burr. O(chains + joints). */
std::vector<std::uint8_t>
longEnough(const std::vector<Chain>& chains, std::size_t num_joints, double least_length);

}  // namespace pcl_slim::detail
