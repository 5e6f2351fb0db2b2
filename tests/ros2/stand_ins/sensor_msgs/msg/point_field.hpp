// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstdint>
#include <string>

namespace sensor_msgs::msg {

struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 0;
};

}  // namespace sensor_msgs::msg
