// SPDX-License-Identifier: BSD-3-Clause
#include "lines/chains.h"

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

}  // namespace

std::vector<Chain>
joinLinks(const std::vector<Link>& links, std::size_t num_joints)
{
  return Joiner(links, num_joints).join();
}

}  // namespace pcl_slim::detail
