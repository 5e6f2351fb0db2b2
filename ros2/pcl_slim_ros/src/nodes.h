// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "processing_node.h"

namespace pcl_slim_ros {

/** \brief Moves the points of each cloud onto their SLIM surface; adds normals and curvature. */
class SmootherNode : public ProcessingNode {
 public:
  explicit SmootherNode(const rclcpp::NodeOptions& options)
      : ProcessingNode("slim_smoother", makeSmoothing, options) {}
};

/** \brief Adds normals, curvature and, if wanted, curvatures of the surface; no point moves. */
class NormalsNode : public ProcessingNode {
 public:
  explicit NormalsNode(const rclcpp::NodeOptions& options)
      : ProcessingNode("slim_normals", makeNormals, options) {}
};

/** \brief Turns each cloud into discs that cover its surface. */
class SplatNode : public ProcessingNode {
 public:
  explicit SplatNode(const rclcpp::NodeOptions& options)
      : ProcessingNode("slim_splats", makeSplats, options) {}
};

}  // namespace pcl_slim_ros
