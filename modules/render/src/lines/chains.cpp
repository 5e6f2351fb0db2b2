// SPDX-License-Identifier: BSD-3-Clause
#include "lines/chains.h"

#include <unordered_set>

namespace pcl_slim::detail {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

class Joiner {
 public:
  Joiner(const std::vector<Link>& links, std::size_t num_joints)
      : links_(links), meetings_(num_joints), used_(links.size(), 0)
  {
    for (std::uint32_t i = 0; i < links.size(); ++i) {
      for (const std::uint32_t joint : links[i].joint) {
        Meeting& meeting = meetings_[joint];
        if (meeting.count < 2) meeting.link[meeting.count] = i;
        ++meeting.count;
      }
    }
  }

  std::vector<Chain> join()
  {
    std::vector<Chain> chains;
    // First the lines that have ends, then what is left: rings.
    for (const bool rings : {false, true}) {
      for (std::uint32_t i = 0; i < links_.size(); ++i) {
        for (const std::uint32_t joint : links_[i].joint) {
          if (used_[i] || (!rings && meetings_[joint].count == 2)) continue;
          chains.push_back(follow(i, joint));
          if (!rings) continue;
          chains.back().closed = true;
          chains.back().joints.pop_back();
        }
      }
    }
    return chains;
  }

 private:
  struct Meeting {
    std::array<std::uint32_t, 2> link{kNone, kNone};
    std::uint32_t count = 0;
  };

  Chain follow(std::uint32_t link, std::uint32_t joint)
  {
    Chain chain;
    chain.joints.push_back(joint);
    while (!used_[link]) {
      used_[link] = 1;
      const auto& ends = links_[link].joint;
      joint = ends[0] == joint ? ends[1] : ends[0];
      chain.joints.push_back(joint);
      const Meeting& meeting = meetings_[joint];
      if (meeting.count != 2) break;
      link = meeting.link[0] == link ? meeting.link[1] : meeting.link[0];
    }
    return chain;
  }

  const std::vector<Link>& links_;
  std::vector<Meeting> meetings_;
  std::vector<std::uint8_t> used_;
};

/** Sets of chains that meet at their ends. */
class Meetings {
 public:
  Meetings(const std::vector<Chain>& chains, std::size_t num_joints)
      : first_(num_joints, kNone), parent_(chains.size()), length_(chains.size())
  {
    for (std::uint32_t i = 0; i < chains.size(); ++i) {
      parent_[i] = i;
      length_[i] = chains[i].joints.size();
    }
    for (std::uint32_t i = 0; i < chains.size(); ++i) {
      if (chains[i].closed) continue;
      for (const std::uint32_t joint : {chains[i].joints.front(), chains[i].joints.back()}) {
        std::uint32_t& other = first_[joint];
        if (other == kNone) {
          other = i;
        } else {
          join(i, other);
          shared_.insert(joint);
        }
      }
    }
  }

  bool isShared(std::uint32_t joint) const { return shared_.count(joint) != 0; }
  std::size_t lengthAround(std::uint32_t chain) { return length_[rootOf(chain)]; }

 private:
  std::uint32_t rootOf(std::uint32_t i)
  {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::uint32_t a, std::uint32_t b)
  {
    a = rootOf(a);
    b = rootOf(b);
    if (a == b) return;
    parent_[a] = b;
    length_[b] += length_[a];
  }

  std::vector<std::uint32_t> first_, parent_;
  std::vector<std::size_t> length_;
  std::unordered_set<std::uint32_t> shared_;
};

}  // namespace

std::vector<std::uint8_t>
longEnough(const std::vector<Chain>& chains, std::size_t num_joints, double least_length)
{
  Meetings meetings(chains, num_joints);
  std::vector<std::uint8_t> keep(chains.size());
  for (std::uint32_t i = 0; i < chains.size(); ++i) {
    const Chain& chain = chains[i];
    keep[i] = static_cast<double>(chain.joints.size()) >= least_length;
    if (keep[i] || chain.closed) continue;
    keep[i] = meetings.isShared(chain.joints.front()) && meetings.isShared(chain.joints.back()) &&
              static_cast<double>(meetings.lengthAround(i)) >= least_length;
  }
  return keep;
}

std::vector<Chain>
joinLinks(const std::vector<Link>& links, std::size_t num_joints)
{
  return Joiner(links, num_joints).join();
}

}  // namespace pcl_slim::detail
