// SPDX-License-Identifier: BSD-3-Clause
// Signs of normals that should agree: one graph for cells of points, discs, leaves and triangles
// (docs/sides.md, "Model").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Edge between two nodes whose signs should be equal or opposite. There are a dozen edges for
 * each node, so they take 12 bytes. */
struct SignedEdge {
  SignedEdge() : b(0), apart(false) {}
  /** \param[in] second less than 2^31 */
  SignedEdge(std::uint32_t first, std::uint32_t second, double weight, bool on_two_sheets = false)
      : a(first),
        b(second & 0x7fffffffu),
        apart(on_two_sheets),
        agreement(static_cast<float>(weight)) {}

  std::uint32_t a = 0;
  std::uint32_t b : 31;
  bool apart : 1;       ///< the nodes are on two sheets
  float agreement = 0;  ///< weight; > 0: the signs should be equal, < 0: opposite
};

/** \brief Signs of the nodes of a graph, and its connected components. */
struct SignedParts {
  std::vector<signed char> signs;   ///< relative to the component, which may be turned as a whole
  std::vector<std::uint32_t> part;  ///< least node of the component of each node
};

/** \brief Chooses signs s that make the sum of s_a s_b agreement large, by greedy additive
 * contraction (Keuper et al. 2015; signs as in correlation clustering). The two components with the
 * strongest summed agreement are joined, and one of them is turned if the sum is negative, until no
 * edge between components is left. Ties are resolved by the order of nodes. O(edges log^2 edges).
 * \param[in] edges contains each pair once */
PCL_SLIM_EXPORT SignedParts contractSigned(std::size_t nodes, const std::vector<SignedEdge>& edges);

/// Weight of the cosine between a normal and a beam, as a vote [two neighbours that agree].
constexpr double kBeamWeight = 100;

/** \brief Signs that also follow votes: more than 0 for a node whose sign is right, less for one
 * that should turn. Votes are edges to one more node, which never turns. \return 1, or -1 for the
 * nodes to turn; those of parts without votes agree among each other. */
PCL_SLIM_EXPORT std::vector<signed char> signsByVotes(std::vector<SignedEdge> edges,
                                                      const std::vector<double>& votes);

/** \brief A piece of a surface whose normal may have either sign. */
struct SidePatch {
  Vector3 center{}, normal{};  ///< normal: unit
  double weight = 0;           ///< area, or number of points
};

/** \brief Whether the normals of two near patches agree: 1 along a circular arc of any bend, creases
 * included, -1 where one must turn, near 0 where the patches face each other across a gap or a thin
 * part, which determines neither's side. n.n' - 2 (n.d)(n'.d) with the direction d between centres
 * (Xie, McDonnell, Qin 2004), times 1 - |(n.d)(n'.d)|. */
PCL_SLIM_EXPORT double agreementOf(const SidePatch& p, const SidePatch& q);

/** \brief The edge between two patches by agreementOf(). Patches across a gap or a thin part are
 * apart. */
PCL_SLIM_EXPORT SignedEdge edgeBetween(const std::vector<SidePatch>& patches, std::uint32_t a,
                                       std::uint32_t b);

/** \brief Turns every part outward: to positive flux about its middle. A part without an inside, as
 * a plate, is turned so that its sheets do not face each other; a single sheet upwards. O(patches +
 * edges). */
PCL_SLIM_EXPORT void turnOutward(const std::vector<SidePatch>& patches,
                                 const std::vector<SignedEdge>& edges, SignedParts& found);

/** \brief Signs such that neighbours agree and each connected part faces outward. */
PCL_SLIM_EXPORT std::vector<signed char> signsOutward(const std::vector<SidePatch>& patches,
                                                      const std::vector<SignedEdge>& edges);

/** \brief Pairs of near patches with opposite given normals beside each other. */
struct PCL_SLIM_EXPORT Opposition {
  double level = 0;   ///< in one plane
  double ahead = 0;   ///< ahead of each other, as across a gap
  double behind = 0;  ///< behind each other, as on a thin part

  void add(const SidePatch& p, const SidePatch& q);
  double all() const { return level + ahead + behind; }
  /** \brief Pairs that contradict each other. Where one noisy sheet has both signs, as many are ahead
   * as behind; thin parts and gaps have those of one kind, and level ones by chance. */
  double contradictions() const {
    constexpr double kByChance = 0.1;
    return std::max(0.0, level - kByChance * (ahead + behind)) +
           std::max(0.0, std::min(ahead, behind) - std::abs(ahead - behind));
  }
};

/** \brief Nodes joined into regions of one sign, numbered by their first nodes. */
class PCL_SLIM_EXPORT SignedRegions {
 public:
  explicit SignedRegions(std::size_t nodes);

  void join(std::uint32_t a, std::uint32_t b);
  /** \brief Numbers the regions; to be called after the last join(). \return how many there are. */
  std::size_t number();
  std::uint32_t of(std::uint32_t node) const { return region_[node]; }

 private:
  std::uint32_t rootOf(std::uint32_t node);

  std::vector<std::uint32_t> region_;  ///< of each node; its parent until they are numbered
};

/** \brief Turns as few regions of given normals as it takes until none contradict each other.
 * \param[in] votes on the sign of each patch; none: each connected part faces as most of its patches
 * did or, where fewer than three quarters agree, outward */
PCL_SLIM_EXPORT std::vector<signed char> signsOfGiven(const std::vector<SidePatch>& patches,
                                                      const std::vector<SignedEdge>& edges,
                                                      const std::vector<double>& votes);

}  // namespace pcl_slim::detail
