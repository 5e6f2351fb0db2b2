// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstdint>

namespace rcl_interfaces::msg {

struct IntegerRange {
  std::int64_t from_value = 0, to_value = 0;
  std::uint64_t step = 0;
};

}  // namespace rcl_interfaces::msg
