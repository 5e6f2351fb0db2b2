// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>

#include <pcl_slim/core/progress.h>

#include "cloud_work.h"
#include "newest_worker.h"
#include "work_statistics.h"

namespace pcl_slim_ros {

/** \brief A lifecycle node that works on each cloud of the topic input and publishes the result on
 * output, with the same header.
 *
 * While active it keeps the newest message: one that waits is dropped when another comes. Parameters
 * may be set at any time and are used from the next message on. Counts are published once a second on
 * /diagnostics. */
class ProcessingNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

  ProcessingNode(const std::string& name, MakeWork make, const rclcpp::NodeOptions& options);
  ~ProcessingNode() override;

  CallbackReturn on_configure(const rclcpp_lifecycle::State& state) override;
  CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override;
  CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override;
  CallbackReturn on_cleanup(const rclcpp_lifecycle::State& state) override;
  CallbackReturn on_shutdown(const rclcpp_lifecycle::State& state) override;

  /** \brief What was done since the node was activated. */
  WorkCounts counts() const { return statistics_.counts(); }

 private:
  using Cloud = sensor_msgs::msg::PointCloud2;
  using Diagnostics = diagnostic_msgs::msg::DiagnosticArray;

  void declareParameters();
  NamedValues valuesWith(const std::vector<rclcpp::Parameter>& changed) const;
  rcl_interfaces::msg::SetParametersResult change(const std::vector<rclcpp::Parameter>& changed);
  std::shared_ptr<const CloudWork> work() const;
  void startByItself();
  void stop();
  void process(Cloud::UniquePtr message);
  void publishDiagnostics();

  MakeWork make_;
  std::vector<std::string> names_;  ///< of the work's parameters
  mutable std::mutex work_mutex_;
  std::shared_ptr<const CloudWork> work_;
  WorkStatistics statistics_;
  std::uint64_t reported_drops_ = 0;
  pcl_slim::Progress progress_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_change_;
  rclcpp::TimerBase::SharedPtr start_timer_, diagnostics_timer_;
  rclcpp_lifecycle::LifecyclePublisher<Cloud>::SharedPtr output_;
  rclcpp_lifecycle::LifecyclePublisher<Diagnostics>::SharedPtr diagnostics_;
  rclcpp::Subscription<Cloud>::SharedPtr input_;
  NewestWorker<Cloud::UniquePtr> worker_;  ///< the last member: its thread uses the others
};

}  // namespace pcl_slim_ros
