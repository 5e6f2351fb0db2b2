// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <string>

#include <builtin_interfaces/msg/time.hpp>

namespace std_msgs::msg {

struct Header {
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};

}  // namespace std_msgs::msg
