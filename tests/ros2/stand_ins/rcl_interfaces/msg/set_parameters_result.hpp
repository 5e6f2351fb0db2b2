// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <string>

namespace rcl_interfaces::msg {

struct SetParametersResult {
  bool successful = false;
  std::string reason;
};

}  // namespace rcl_interfaces::msg
