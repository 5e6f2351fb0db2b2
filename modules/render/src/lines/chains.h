// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_slim::detail {

/** \brief Some of many integers, numbered in ascending order: a bit for each of the many, so that what is
 * kept about the few takes no more room than they. */
class NumberedSet {
 public:
  /** \param[in] limit integers are below it */
  explicit NumberedSet(std::size_t limit) : bits_(limit / 64 + 1), before_(limit / 64 + 1) {}

  void add(std::uint32_t i) { bits_[i / 64] |= std::uint64_t{1} << i % 64; }

  /** \brief To be called once, after the last add(). \return how many there are */
  std::size_t count()
  {
    std::uint32_t sum = 0;
    for (std::size_t word = 0; word < bits_.size(); ++word) {
      before_[word] = sum;
      sum += ones(bits_[word]);
    }
    return sum;
  }

  /** \brief Number of a member, from 0. */
  std::uint32_t numberOf(std::uint32_t i) const
  {
    const std::uint64_t lower = (std::uint64_t{1} << i % 64) - 1;
    return before_[i / 64] + ones(bits_[i / 64] & lower);
  }

 private:
  static std::uint32_t ones(std::uint64_t word)
  {
    return static_cast<std::uint32_t>(__builtin_popcountll(word));
  }

  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;  ///< members in the words before
};

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
 * between two joints of others if their connected component is as long. A short chain with a free
 * end is a burr. O(chains + joints). */
std::vector<std::uint8_t>
longEnough(const std::vector<Chain>& chains, std::size_t num_joints, double least_length);

}  // namespace pcl_slim::detail
