// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <builtin_interfaces/msg/time.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <rclcpp/parameters.hpp>
#include <rclcpp/topics.hpp>

namespace rclcpp {

class Time {
 public:
  explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  operator builtin_interfaces::msg::Time() const {
    constexpr std::int64_t kSecond = 1000000000;
    return {static_cast<std::int32_t>(nanoseconds_ / kSecond),
            static_cast<std::uint32_t>(nanoseconds_ % kSecond)};
  }

 private:
  std::int64_t nanoseconds_;
};

class Clock {
 public:
  using SharedPtr = std::shared_ptr<Clock>;

  Time now() const {
    using namespace std::chrono;
    return Time(duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count());
  }
};

class Logger {
 public:
  explicit Logger(std::string name) : name_(std::move(name)) {}
  const char* get_name() const { return name_.c_str(); }

 private:
  std::string name_;
};

class TimerBase {
 public:
  using SharedPtr = std::shared_ptr<TimerBase>;

  explicit TimerBase(std::function<void()> callback) : callback_(std::move(callback)) {}
  void cancel() { cancelled_ = true; }
  bool is_canceled() const { return cancelled_; }
  void execute_callback() const { callback_(); }

 private:
  std::function<void()> callback_;
  bool cancelled_ = false;
};

class NodeOptions {
 public:
  NodeOptions& parameter_overrides(const std::vector<Parameter>& overrides) {
    overrides_ = overrides;
    return *this;
  }
  const std::vector<Parameter>& parameter_overrides() const { return overrides_; }

 private:
  std::vector<Parameter> overrides_;
};

namespace node_interfaces {

struct OnSetParametersCallbackHandle {
  using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;

  std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<Parameter>&)> callback;
};

}  // namespace node_interfaces

namespace stand_in {

/** What the process's nodes share besides topics. */
struct Process {
  std::mutex mutex;
  std::vector<std::weak_ptr<TimerBase>> timers;
  std::vector<std::string> log;
  std::map<std::string, std::function<std::shared_ptr<void>(const NodeOptions&)>> components;

  static Process& instance() {
    static Process process;
    return process;
  }
};

inline bool registerNode(const std::string& name,
                         std::function<std::shared_ptr<void>(const NodeOptions&)> make) {
  return Process::instance().components.emplace(name, std::move(make)).second;
}

/** Runs each timer once, as an executor does when it is due. */
inline void fireTimers() {
  std::vector<TimerBase::SharedPtr> due;
  {
    Process& process = Process::instance();
    const std::lock_guard lock(process.mutex);
    for (const auto& timer : process.timers)
      if (auto alive = timer.lock(); alive && !alive->is_canceled()) due.push_back(alive);
  }
  for (const auto& timer : due) timer->execute_callback();
}

[[gnu::format(printf, 2, 3)]] inline void log(const Logger& logger, const char* format, ...) {
  char text[500];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof(text), format, values);
  va_end(values);
  Process& process = Process::instance();
  const std::lock_guard lock(process.mutex);
  process.log.push_back(std::string(logger.get_name()) + ": " + text);
}

}  // namespace stand_in
}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) rclcpp::stand_in::log(logger, __VA_ARGS__)
#define RCLCPP_WARN_THROTTLE(logger, clock, duration, ...)  \
  do {                                                      \
    static_cast<void>((clock).now());                       \
    static_cast<void>(std::chrono::milliseconds(duration)); \
    rclcpp::stand_in::log(logger, __VA_ARGS__);             \
  } while (0)
