// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/signed_graph.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcl_slim::detail {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::size_t kFewEdges = 32;    ///< most edges of a node that insertion sort is used for
constexpr double kThresholdRatio = 0.5;  ///< ratio of one threshold of agreements to the last
constexpr double kLeastAgreement = 0x1p-20;  ///< a weaker agreement is none [strongest agreement]

/** Edge between two components. */
struct Edge {
  std::uint32_t a, b;
  float agreement;
};

/** An edge with its lesser node first. */
template <typename AnyEdge>
Edge ordered(const AnyEdge& e) {
  const std::uint32_t a = e.a, b = e.b;
  return {std::min(a, b), std::max(a, b), e.agreement};
}

/** Components under contraction: a forest with parities, and the edges between roots. */
class Contraction {
 public:
  Contraction(std::size_t nodes, const std::vector<SignedEdge>& edges)
      : parent_(nodes), sign_(nodes, 1), best_(nodes, kNone) {
    for (std::size_t i = 0; i < nodes; ++i) parent_[i] = static_cast<std::uint32_t>(i);
    sortByEnds(edges);
    sumSorted();
  }

  void run() {
    double threshold = strongest();
    const double least = kLeastAgreement * threshold;
    while (!edges_.empty() && threshold > least) {
      if (!joinAbove(kThresholdRatio * threshold))
        threshold = std::min(kThresholdRatio * threshold, strongest());
    }
  }

  /** The root of a node. Compresses the path. \param[out] sign of the node relative to the root */
  std::uint32_t root(std::uint32_t i, int& sign) {
    sign = 1;
    std::uint32_t r = i;
    for (; parent_[r] != r; r = parent_[r]) sign *= sign_[r];
    for (int rest = sign; i != r;) {
      const std::uint32_t next = parent_[i];
      const signed char own = sign_[i];
      sign_[i] = static_cast<signed char>(rest);
      parent_[i] = r;
      rest *= own;
      i = next;
    }
    return r;
  }

 private:
  double strongest() const {
    float most = 0;
    for (const Edge& e : edges_) most = std::max(most, std::abs(e.agreement));
    return most;
  }

  /** Makes edge e the best one of a node if it is stronger than all before; ties go to the first.
   */
  void offer(std::uint32_t node, std::uint32_t e) {
    std::uint32_t& best = best_[node];
    if (best == kNone || std::abs(edges_[e].agreement) > std::abs(edges_[best].agreement)) best = e;
  }

  /** Joins every component with its strongest neighbour if their agreement reaches a threshold.
   * \return whether any were joined */
  bool joinAbove(double threshold) {
    chosen_.clear();
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      if (std::abs(edges_[e].agreement) < threshold) continue;
      offer(edges_[e].a, e);
      offer(edges_[e].b, e);
      chosen_.push_back(e);
    }
    bool joined = false;
    for (const std::uint32_t e : chosen_) {
      const Edge& edge = edges_[e];
      if (best_[edge.a] == e || best_[edge.b] == e) joined |= join(edge);
    }
    for (const std::uint32_t e : chosen_) best_[edges_[e].a] = best_[edges_[e].b] = kNone;
    if (joined) contract();
    return joined;
  }

  bool join(const Edge& edge) {
    int sign_a, sign_b;
    const std::uint32_t a = root(edge.a, sign_a), b = root(edge.b, sign_b);
    if (a == b) return false;
    const int turn = sign_a * sign_b * (edge.agreement < 0 ? -1 : 1);
    parent_[std::max(a, b)] = std::min(a, b);
    sign_[std::max(a, b)] = static_cast<signed char>(turn);
    return true;
  }

  /** Moves edges to the roots of their ends, and drops edges within a component. */
  void contract() {
    std::size_t kept = 0;
    for (const Edge& e : edges_) {
      int sign_a, sign_b;
      const std::uint32_t a = root(e.a, sign_a), b = root(e.b, sign_b);
      const auto sign = static_cast<float>(sign_a * sign_b);
      if (a != b) edges_[kept++] = {a, b, sign * e.agreement};
    }
    edges_.resize(kept);
    sumParallel();
  }

  /** Replaces edges between the same two components by their sum. */
  void sumParallel() {
    sorted_.swap(edges_);
    sortByEnds(sorted_);
    sumSorted();
  }

  void sumSorted() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const Edge e = edges_[i];
      if (kept > 0 && edges_[kept - 1].a == e.a && edges_[kept - 1].b == e.b) {
        edges_[kept - 1].agreement += e.agreement;
      } else {
        edges_[kept++] = e;
      }
    }
    edges_.resize(kept);
  }

  /** Sorts other edges by both ends into edges_, stably: a counting sort by the first end, then each
   * node's few edges. */
  template <typename Edges>
  void sortByEnds(const Edges& from) {
    const auto before = [](const Edge& x, const Edge& y) {
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    };
    edges_.resize(from.size());
    if (kFewEdges * from.size() < parent_.size()) {
      std::transform(from.begin(), from.end(), edges_.begin(),
                     [](const auto& e) { return ordered(e); });
      std::stable_sort(edges_.begin(), edges_.end(), before);
      return;
    }
    next_.assign(parent_.size() + 1, 0);
    for (const auto& e : from) ++next_[ordered(e).a + 1];
    for (std::size_t i = 1; i < next_.size(); ++i) next_[i] += next_[i - 1];
    for (const auto& e : from) edges_[next_[ordered(e).a]++] = ordered(e);
    // Now next_ has the end of each node's edges.
    for (std::size_t i = 0, begin = 0; i + 1 < next_.size(); begin = next_[i++])
      sortFew(begin, next_[i], before);
  }

  /** Sorts a range of edges stably. Insertion sort is fastest for the few edges of most nodes. */
  template <typename Before>
  void sortFew(std::size_t begin, std::size_t end, const Before& before) {
    if (end - begin > kFewEdges) {
      std::stable_sort(edges_.begin() + begin, edges_.begin() + end, before);
      return;
    }
    for (std::size_t i = begin + 1; i < end; ++i) {
      const Edge edge = edges_[i];
      std::size_t at = i;
      for (; at > begin && before(edge, edges_[at - 1]); --at) edges_[at] = edges_[at - 1];
      edges_[at] = edge;
    }
  }

  std::vector<std::uint32_t> parent_;
  std::vector<signed char> sign_;
  std::vector<std::uint32_t> best_;  ///< strongest edge of each root
  std::vector<Edge> edges_, sorted_;
  std::vector<std::size_t> next_;  ///< where the next edge of each first node goes
  std::vector<std::uint32_t> chosen_;
};

}  // namespace

SignedParts contractSigned(std::size_t nodes, const std::vector<SignedEdge>& edges) {
  Contraction contraction(nodes, edges);
  contraction.run();
  SignedParts result;
  result.signs.resize(nodes);
  result.part.resize(nodes);
  for (std::uint32_t i = 0; i < nodes; ++i) {
    int sign;
    result.part[i] = contraction.root(i, sign);
    result.signs[i] = static_cast<signed char>(sign);
  }
  return result;
}

std::vector<signed char> signsByVotes(std::vector<SignedEdge> edges,
                                      const std::vector<double>& votes) {
  const auto outside = static_cast<std::uint32_t>(votes.size());
  edges.reserve(edges.size() + votes.size());
  for (std::uint32_t i = 0; i < outside; ++i) {
    if (votes[i] != 0) edges.push_back({i, outside, votes[i]});
  }
  SignedParts found = contractSigned(votes.size() + 1, edges);
  for (std::uint32_t i = 0; i < outside; ++i) {
    if (found.part[i] == found.part[outside])
      found.signs[i] = static_cast<signed char>(found.signs[i] * found.signs[outside]);
  }
  found.signs.pop_back();
  return std::move(found.signs);
}

}  // namespace pcl_slim::detail
