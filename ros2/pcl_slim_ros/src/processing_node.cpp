// SPDX-License-Identifier: BSD-3-Clause
#include "processing_node.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <utility>

#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <diagnostic_msgs/msg/key_value.hpp>
#include <lifecycle_msgs/msg/state.hpp>
#include <rcl_interfaces/msg/floating_point_range.hpp>
#include <rcl_interfaces/msg/integer_range.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>

#include <pcl_slim/filters/io/point_message.h>

namespace pcl_slim_ros {

namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using rcl_interfaces::msg::ParameterDescriptor;

constexpr std::size_t kOutputDepth = 5;  ///< messages kept for slow readers, as of sensors
constexpr int kWarnEvery = 5000;         ///< least time between equal warnings [ms]

ParameterDescriptor descriptorOf(const NodeParameter& parameter) {
  ParameterDescriptor descriptor;
  descriptor.description = parameter.description;
  if (!parameter.range) return descriptor;
  const auto [low, high] = *parameter.range;
  if (std::holds_alternative<double>(parameter.value)) {
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value = low;
    range.to_value = high;
    descriptor.floating_point_range.push_back(range);
  } else {
    rcl_interfaces::msg::IntegerRange range;
    range.from_value = static_cast<std::int64_t>(low);
    range.to_value = static_cast<std::int64_t>(high);
    descriptor.integer_range.push_back(range);
  }
  return descriptor;
}

rclcpp::ParameterValue toRos(const Value& value) {
  return std::visit([](const auto& held) { return rclcpp::ParameterValue(held); }, value);
}

/** A value of the types that nodes declare; others are refused by rclcpp before. */
Value fromRos(const rclcpp::ParameterValue& value) {
  switch (value.get_type()) {
    case rclcpp::ParameterType::PARAMETER_BOOL: return value.get<bool>();
    case rclcpp::ParameterType::PARAMETER_INTEGER: return value.get<std::int64_t>();
    case rclcpp::ParameterType::PARAMETER_DOUBLE: return value.get<double>();
    case rclcpp::ParameterType::PARAMETER_DOUBLE_ARRAY: return value.get<std::vector<double>>();
    case rclcpp::ParameterType::PARAMETER_STRING: return value.get<std::string>();
    default: return std::string();
  }
}

std::string textOf(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

}  // namespace

ProcessingNode::ProcessingNode(const std::string& name, MakeWork make,
                               const rclcpp::NodeOptions& options)
    : rclcpp_lifecycle::LifecycleNode(name, options),
      make_(make),
      worker_([this](Cloud::UniquePtr message) { process(std::move(message)); }) {
  declareParameters();
  ParameterDescriptor descriptor;
  descriptor.description =
      "configure and activate the node by itself; false: a lifecycle manager does";
  descriptor.read_only = true;
  const bool starts =
      declare_parameter("autostart", rclcpp::ParameterValue(true), descriptor).get<bool>();
  // Not before: declarations call it, too, and values that contradict each other would throw there.
  on_change_ = add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter>& changed) { return change(changed); });
  if (!starts) return;
  start_timer_ = create_wall_timer(std::chrono::milliseconds(1), [this] { startByItself(); });
}

ProcessingNode::~ProcessingNode() {
  stop();
}

void ProcessingNode::declareParameters() {
  for (const NodeParameter& parameter : make_()->parameters()) {
    declare_parameter(parameter.name, toRos(parameter.value), descriptorOf(parameter));
    names_.push_back(parameter.name);
  }
}

/** The work's parameters: those that change, and the others as they are. */
NamedValues ProcessingNode::valuesWith(const std::vector<rclcpp::Parameter>& changed) const {
  NamedValues values;
  for (const std::string& name : names_) {
    const auto at = std::find_if(
        changed.begin(), changed.end(),
        [&](const rclcpp::Parameter& parameter) { return parameter.get_name() == name; });
    const rclcpp::Parameter parameter = at != changed.end() ? *at : get_parameter(name);
    values.emplace_back(name, fromRos(parameter.get_parameter_value()));
  }
  return values;
}

rcl_interfaces::msg::SetParametersResult ProcessingNode::change(
    const std::vector<rclcpp::Parameter>& changed) {
  rcl_interfaces::msg::SetParametersResult result;
  const auto is_ours = [this](const rclcpp::Parameter& parameter) {
    return std::count(names_.begin(), names_.end(), parameter.get_name()) > 0;
  };
  result.successful = std::none_of(changed.begin(), changed.end(), is_ours);
  if (result.successful) return result;  // of rclcpp itself, as use_sim_time
  auto made = makeWork(make_, valuesWith(changed));
  result.successful = static_cast<bool>(made);
  if (!made) {
    result.reason = made.error().message;
    return result;
  }
  const std::lock_guard lock(work_mutex_);
  work_ = std::move(*made);
  return result;
}

std::shared_ptr<const CloudWork> ProcessingNode::work() const {
  const std::lock_guard lock(work_mutex_);
  return work_;
}

void ProcessingNode::startByItself() {
  start_timer_->cancel();
  if (configure().id() == lifecycle_msgs::msg::State::PRIMARY_STATE_INACTIVE) activate();
}

ProcessingNode::CallbackReturn ProcessingNode::on_configure(const rclcpp_lifecycle::State&) {
  auto made = makeWork(make_, valuesWith({}));
  if (!made) {
    RCLCPP_ERROR(get_logger(), "%s", made.error().message.c_str());
    return CallbackReturn::FAILURE;
  }
  {
    const std::lock_guard lock(work_mutex_);
    work_ = std::move(*made);
  }
  // Reliable, as it suits readers of either kind; the input takes what sensors send, best effort.
  output_ = create_publisher<Cloud>("output", rclcpp::QoS(kOutputDepth));
  diagnostics_ = create_publisher<Diagnostics>("/diagnostics", rclcpp::QoS(1));
  return CallbackReturn::SUCCESS;
}

ProcessingNode::CallbackReturn ProcessingNode::on_activate(const rclcpp_lifecycle::State& state) {
  LifecycleNode::on_activate(state);
  statistics_.reset();
  reported_drops_ = 0;
  progress_.reset();
  worker_.start();
  input_ = create_subscription<Cloud>(
      "input", rclcpp::SensorDataQoS(),
      [this](Cloud::UniquePtr message) { statistics_.receive(worker_.put(std::move(message))); });
  diagnostics_timer_ = create_wall_timer(std::chrono::seconds(1), [this] { publishDiagnostics(); });
  return CallbackReturn::SUCCESS;
}

ProcessingNode::CallbackReturn ProcessingNode::on_deactivate(const rclcpp_lifecycle::State& state) {
  stop();
  LifecycleNode::on_deactivate(state);
  return CallbackReturn::SUCCESS;
}

ProcessingNode::CallbackReturn ProcessingNode::on_cleanup(const rclcpp_lifecycle::State&) {
  output_.reset();
  diagnostics_.reset();
  return CallbackReturn::SUCCESS;
}

ProcessingNode::CallbackReturn ProcessingNode::on_shutdown(const rclcpp_lifecycle::State& state) {
  stop();
  return on_cleanup(state);
}

/** Takes no more messages, and cancels the one in work. */
void ProcessingNode::stop() {
  input_.reset();
  diagnostics_timer_.reset();
  progress_.cancel();
  worker_.stop();
}

/** Works on a message, in the worker's thread. */
void ProcessingNode::process(Cloud::UniquePtr message) try {
  const auto begin = std::chrono::steady_clock::now();
  auto made = std::make_unique<Cloud>();
  made->header = message->header;
  const std::uint64_t points = std::uint64_t{message->width} * message->height;
  auto table = pcl_slim::tableOf(std::move(*message));
  auto result = table ? work()->process(std::move(*table), &progress_)
                      : pcl_slim::Result<CloudOutput>(table.error());
  if (!result) {
    if (result.error().code == pcl_slim::ErrorCode::kCancelled) return;
    statistics_.fail(result.error().message);
    RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kWarnEvery, "%s",
                         result.error().message.c_str());
    return;
  }
  pcl_slim::putPoints(std::move(result->points), result->is_dense, *made);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  statistics_.publish(points, seconds.count(), result->warning);
  output_->publish(std::move(made));
} catch (const std::exception& error) {  // memory that is not there must not end the process
  statistics_.fail(error.what());
  RCLCPP_ERROR(get_logger(), "a cloud was left out: %s", error.what());
}

void ProcessingNode::publishDiagnostics() {
  const WorkCounts counts = statistics_.counts();
  DiagnosticStatus status;
  status.name = std::string(get_fully_qualified_name()) + ": clouds";
  status.hardware_id = "none";
  status.level = DiagnosticStatus::OK;
  status.message = "clouds are worked on";
  if (!counts.last_warning.empty() || counts.dropped > reported_drops_) {
    status.level = DiagnosticStatus::WARN;
    status.message = counts.last_warning.empty() ? "clouds come faster than they are worked on"
                                                 : counts.last_warning;
  }
  if (!counts.last_error.empty()) {
    status.level = DiagnosticStatus::ERROR;
    status.message = counts.last_error;
  }
  reported_drops_ = counts.dropped;
  const auto add = [&status](const std::string& key, const std::string& value) {
    diagnostic_msgs::msg::KeyValue pair;
    pair.key = key;
    pair.value = value;
    status.values.push_back(pair);
  };
  add("received", std::to_string(counts.received));
  add("published", std::to_string(counts.published));
  add("dropped", std::to_string(counts.dropped));
  add("failed", std::to_string(counts.failed));
  add("points of the last cloud", std::to_string(counts.last_points));
  add("us a point, last cloud", textOf(counts.lastMicrosecondsPerPoint()));
  add("us a point, all clouds", textOf(counts.microsecondsPerPoint()));
  Diagnostics message;
  message.header.stamp = now();
  message.status.push_back(status);
  diagnostics_->publish(message);
}

}  // namespace pcl_slim_ros
