// SPDX-License-Identifier: BSD-3-Clause
#include "nodes.h"

#include <rclcpp_components/register_node_macro.hpp>

RCLCPP_COMPONENTS_REGISTER_NODE(pcl_slim_ros::SmootherNode)
RCLCPP_COMPONENTS_REGISTER_NODE(pcl_slim_ros::NormalsNode)
RCLCPP_COMPONENTS_REGISTER_NODE(pcl_slim_ros::SplatNode)
