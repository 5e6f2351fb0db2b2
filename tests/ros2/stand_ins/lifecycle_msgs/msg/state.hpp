// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstdint>

namespace lifecycle_msgs::msg {

struct State {
  static constexpr std::uint8_t PRIMARY_STATE_UNKNOWN = 0, PRIMARY_STATE_UNCONFIGURED = 1,
                                PRIMARY_STATE_INACTIVE = 2, PRIMARY_STATE_ACTIVE = 3,
                                PRIMARY_STATE_FINALIZED = 4;
};

}  // namespace lifecycle_msgs::msg
