// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <memory>
#include <vector>

#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <std_msgs/msg/header.hpp>

namespace diagnostic_msgs::msg {

struct DiagnosticArray {
  std_msgs::msg::Header header;
  std::vector<DiagnosticStatus> status;
};

}  // namespace diagnostic_msgs::msg
