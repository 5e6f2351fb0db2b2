// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include <rclcpp/rclcpp.hpp>

namespace rclcpp_lifecycle {

class ManagedEntityInterface {
 public:
  virtual ~ManagedEntityInterface() = default;
  virtual void on_activate() = 0;
  virtual void on_deactivate() = 0;
};

template <typename Message>
class LifecyclePublisher : public ManagedEntityInterface {
 public:
  using SharedPtr = std::shared_ptr<LifecyclePublisher>;

  LifecyclePublisher(std::string topic, const rclcpp::QoS& qos)
      : topic_(std::move(topic)), qos_(qos) {}

  void publish(std::unique_ptr<Message> message) { publish(*message); }
  /** Drops messages while the node is not active. */
  void publish(const Message& message) {
    if (active_) rclcpp::stand_in::Topics::instance().publish(topic_, qos_, message);
  }
  void on_activate() override { active_ = true; }
  void on_deactivate() override { active_ = false; }
  bool is_activated() const { return active_; }

 private:
  std::string topic_;
  rclcpp::QoS qos_;
  std::atomic<bool> active_{false};
};

}  // namespace rclcpp_lifecycle
