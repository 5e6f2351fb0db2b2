// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <string>

namespace diagnostic_msgs::msg {

struct KeyValue {
  std::string key, value;
};

}  // namespace diagnostic_msgs::msg
