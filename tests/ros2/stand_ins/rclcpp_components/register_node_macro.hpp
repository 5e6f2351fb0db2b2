// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <memory>

#include <rclcpp/rclcpp.hpp>

#define PCL_SLIM_STAND_IN_NAME(counter) registered_component_##counter
#define PCL_SLIM_STAND_IN_REGISTER(NodeClass, counter)                                          \
  namespace {                                                                                   \
  [[maybe_unused]] const bool PCL_SLIM_STAND_IN_NAME(counter) = rclcpp::stand_in::registerNode( \
      #NodeClass, [](const rclcpp::NodeOptions& options) -> std::shared_ptr<void> {             \
        return std::make_shared<NodeClass>(options);                                            \
      });                                                                                       \
  }
#define PCL_SLIM_STAND_IN_COUNTED(NodeClass, counter) PCL_SLIM_STAND_IN_REGISTER(NodeClass, counter)
// A component is made from options alone, by its class.
#define RCLCPP_COMPONENTS_REGISTER_NODE(NodeClass) PCL_SLIM_STAND_IN_COUNTED(NodeClass, __COUNTER__)
