// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

namespace rclcpp {

enum class ReliabilityPolicy { BestEffort, Reliable };

class QoS {
 public:
  explicit QoS(std::size_t history_depth) : depth_(history_depth) {}
  QoS& best_effort() {
    reliability_ = ReliabilityPolicy::BestEffort;
    return *this;
  }
  QoS& reliable() {
    reliability_ = ReliabilityPolicy::Reliable;
    return *this;
  }
  std::size_t depth() const { return depth_; }
  ReliabilityPolicy reliability() const { return reliability_; }

 private:
  std::size_t depth_;
  ReliabilityPolicy reliability_ = ReliabilityPolicy::Reliable;
};

class SensorDataQoS : public QoS {
 public:
  SensorDataQoS() : QoS(5) { best_effort(); }
};

class SubscriptionBase {
 public:
  SubscriptionBase(std::type_index type, const QoS& qos) : type_(type), qos_(qos) {}
  virtual ~SubscriptionBase() = default;

  std::type_index type() const { return type_; }
  /** Whether messages of such a publisher come here. */
  bool accepts(const QoS& publisher) const {
    return qos_.reliability() == ReliabilityPolicy::BestEffort ||
           publisher.reliability() == ReliabilityPolicy::Reliable;
  }

 private:
  std::type_index type_;
  QoS qos_;
};

template <typename Message>
class Subscription : public SubscriptionBase {
 public:
  using SharedPtr = std::shared_ptr<Subscription>;
  using Callback = std::function<void(std::unique_ptr<Message>)>;

  Subscription(const QoS& qos, Callback callback)
      : SubscriptionBase(typeid(Message), qos), callback_(std::move(callback)) {}
  void deliver(const Message& message) const { callback_(std::make_unique<Message>(message)); }

 private:
  Callback callback_;
};

namespace stand_in {

/** The topics of the process: a message is delivered where and when it is published. */
class Topics {
 public:
  static Topics& instance() {
    static Topics topics;
    return topics;
  }

  template <typename Message>
  typename Subscription<Message>::SharedPtr subscribe(
      const std::string& topic, const QoS& qos, typename Subscription<Message>::Callback callback) {
    auto made = std::make_shared<Subscription<Message>>(qos, std::move(callback));
    const std::lock_guard lock(mutex_);
    subscriptions_.emplace(fullName(topic), made);
    return made;
  }

  template <typename Message>
  void publish(const std::string& topic, const QoS& qos, const Message& message) {
    std::vector<std::shared_ptr<SubscriptionBase>> readers;
    {
      const std::lock_guard lock(mutex_);
      const auto [first, last] = subscriptions_.equal_range(fullName(topic));
      for (auto at = first; at != last; ++at)
        if (auto reader = at->second.lock()) readers.push_back(reader);
    }
    for (const auto& reader : readers) {
      if (reader->type() == typeid(Message) && reader->accepts(qos))
        static_cast<const Subscription<Message>&>(*reader).deliver(message);
    }
  }

 private:
  static std::string fullName(const std::string& topic) {
    return topic.front() == '/' ? topic : "/" + topic;
  }

  std::mutex mutex_;
  std::multimap<std::string, std::weak_ptr<SubscriptionBase>> subscriptions_;
};

}  // namespace stand_in
}  // namespace rclcpp
