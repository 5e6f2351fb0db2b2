// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lifecycle_msgs/msg/state.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>

namespace rclcpp_lifecycle {

class State {
 public:
  explicit State(std::uint8_t id) : id_(id) {}
  std::uint8_t id() const { return id_; }

 private:
  std::uint8_t id_;
};

namespace node_interfaces {

class LifecycleNodeInterface {
 public:
  enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };

  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_error(const State&) { return CallbackReturn::FAILURE; }
};

}  // namespace node_interfaces

class LifecycleNode : public node_interfaces::LifecycleNodeInterface {
 public:
  LifecycleNode(const std::string& name, const rclcpp::NodeOptions& options)
      : name_("/" + name), options_(options) {}

  const char* get_fully_qualified_name() const { return name_.c_str(); }
  rclcpp::Logger get_logger() const { return rclcpp::Logger(name_.substr(1)); }
  rclcpp::Clock::SharedPtr get_clock() { return clock_; }
  rclcpp::Time now() const { return clock_->now(); }

  const rclcpp::ParameterValue& declare_parameter(
      const std::string& name, const rclcpp::ParameterValue& default_value,
      const rcl_interfaces::msg::ParameterDescriptor& descriptor = {}) {
    rclcpp::ParameterValue value = default_value;
    for (const rclcpp::Parameter& given : options_.parameter_overrides())
      if (given.get_name() == name) value = given.get_parameter_value();
    if (value.get_type() != default_value.get_type())
      throw rclcpp::exceptions::InvalidParameterTypeException(name);
    if (!isInRange(value, descriptor))
      throw rclcpp::exceptions::InvalidParameterValueException(name);
    if (const auto handle = on_set_.lock(); handle && !handle->callback({{name, value}}).successful)
      throw rclcpp::exceptions::InvalidParameterValueException(name);
    descriptors_[name] = descriptor;
    return parameters_[name] = value;
  }
  rclcpp::Parameter get_parameter(const std::string& name) const {
    const auto at = parameters_.find(name);
    if (at == parameters_.end()) throw rclcpp::exceptions::ParameterNotDeclaredException(name);
    return {name, at->second};
  }
  rcl_interfaces::msg::ParameterDescriptor describe_parameter(const std::string& name) const {
    return descriptors_.at(name);
  }
  rcl_interfaces::msg::SetParametersResult set_parameter(const rclcpp::Parameter& parameter) {
    const std::string& name = parameter.get_name();
    rclcpp::ParameterValue& value = parameters_.at(name);
    if (descriptors_.at(name).read_only) return {false, "the parameter is read-only"};
    if (value.get_type() != parameter.get_type()) return {false, "Wrong parameter type"};
    if (!isInRange(parameter.get_parameter_value(), descriptors_.at(name)))
      return {false, "Parameter doesn't comply with range"};
    if (const auto handle = on_set_.lock()) {
      const auto result = handle->callback({parameter});
      if (!result.successful) return result;
    }
    value = parameter.get_parameter_value();
    return {true, ""};
  }
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<rclcpp::Parameter>&)>
          callback) {
    auto handle = std::make_shared<rclcpp::node_interfaces::OnSetParametersCallbackHandle>();
    handle->callback = std::move(callback);
    on_set_ = handle;
    return handle;
  }

  template <typename Message>
  typename LifecyclePublisher<Message>::SharedPtr create_publisher(const std::string& topic,
                                                                   const rclcpp::QoS& qos) {
    auto made = std::make_shared<LifecyclePublisher<Message>>(topic, qos);
    managed_.push_back(made);
    return made;
  }
  template <typename Message, typename Callback>
  typename rclcpp::Subscription<Message>::SharedPtr create_subscription(const std::string& topic,
                                                                        const rclcpp::QoS& qos,
                                                                        Callback&& callback) {
    return rclcpp::stand_in::Topics::instance().subscribe<Message>(
        topic, qos, std::forward<Callback>(callback));
  }
  template <typename Rep, typename Ratio>
  rclcpp::TimerBase::SharedPtr create_wall_timer(std::chrono::duration<Rep, Ratio>,
                                                 std::function<void()> callback) {
    auto made = std::make_shared<rclcpp::TimerBase>(std::move(callback));
    rclcpp::stand_in::Process& process = rclcpp::stand_in::Process::instance();
    const std::lock_guard lock(process.mutex);
    process.timers.push_back(made);
    return made;
  }

  CallbackReturn on_activate(const State&) override {
    for (const auto& entity : managed_)
      if (const auto alive = entity.lock()) alive->on_activate();
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_deactivate(const State&) override {
    for (const auto& entity : managed_)
      if (const auto alive = entity.lock()) alive->on_deactivate();
    return CallbackReturn::SUCCESS;
  }

  const State& get_current_state() const { return state_; }
  const State& configure() {
    return change(States::PRIMARY_STATE_UNCONFIGURED, States::PRIMARY_STATE_INACTIVE,
                  [this] { return on_configure(state_); });
  }
  const State& activate() {
    return change(States::PRIMARY_STATE_INACTIVE, States::PRIMARY_STATE_ACTIVE,
                  [this] { return on_activate(state_); });
  }
  const State& deactivate() {
    return change(States::PRIMARY_STATE_ACTIVE, States::PRIMARY_STATE_INACTIVE,
                  [this] { return on_deactivate(state_); });
  }
  const State& cleanup() {
    return change(States::PRIMARY_STATE_INACTIVE, States::PRIMARY_STATE_UNCONFIGURED,
                  [this] { return on_cleanup(state_); });
  }
  const State& shutdown() {
    return change(state_.id(), States::PRIMARY_STATE_FINALIZED,
                  [this] { return on_shutdown(state_); });
  }

 private:
  using States = lifecycle_msgs::msg::State;

  const State& change(std::uint8_t from, std::uint8_t to,
                      const std::function<CallbackReturn()>& transition) {
    if (state_.id() == from && transition() == CallbackReturn::SUCCESS) state_ = State(to);
    return state_;
  }
  static bool isInRange(const rclcpp::ParameterValue& value,
                        const rcl_interfaces::msg::ParameterDescriptor& descriptor) {
    for (const auto& range : descriptor.floating_point_range) {
      const double x = value.get<double>();
      if (!(x >= range.from_value && x <= range.to_value)) return false;
    }
    for (const auto& range : descriptor.integer_range) {
      const std::int64_t x = value.get<std::int64_t>();
      if (x < range.from_value || x > range.to_value) return false;
    }
    return true;
  }

  std::string name_;
  rclcpp::NodeOptions options_;
  rclcpp::Clock::SharedPtr clock_ = std::make_shared<rclcpp::Clock>();
  std::map<std::string, rclcpp::ParameterValue> parameters_;
  std::map<std::string, rcl_interfaces::msg::ParameterDescriptor> descriptors_;
  std::weak_ptr<rclcpp::node_interfaces::OnSetParametersCallbackHandle> on_set_;
  std::vector<std::weak_ptr<ManagedEntityInterface>> managed_;
  State state_{States::PRIMARY_STATE_UNCONFIGURED};
};

}  // namespace rclcpp_lifecycle
