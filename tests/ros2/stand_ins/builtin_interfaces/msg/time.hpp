// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstdint>

namespace builtin_interfaces::msg {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

}  // namespace builtin_interfaces::msg
