// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <rcl_interfaces/msg/floating_point_range.hpp>
#include <rcl_interfaces/msg/integer_range.hpp>

namespace rcl_interfaces::msg {

struct ParameterDescriptor {
  std::string name;
  std::uint8_t type = 0;
  std::string description, additional_constraints;
  bool read_only = false, dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;  // at most one, as below
  std::vector<IntegerRange> integer_range;
};

}  // namespace rcl_interfaces::msg
