// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace pcl_slim_ros {

/** \brief A thread that works on the newest item: one that waits is replaced by the next. */
template <typename Item>
class NewestWorker {
 public:
  explicit NewestWorker(std::function<void(Item)> work) : work_(std::move(work)) {}
  ~NewestWorker() { stop(); }
  NewestWorker(const NewestWorker&) = delete;
  NewestWorker& operator=(const NewestWorker&) = delete;

  void start() {
    stop();
    stopping_ = false;
    thread_ = std::thread([this] { run(); });
  }

  /** \brief Ends the thread after the item in work; one that waits is dropped. */
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      waiting_.reset();
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  /** \brief Gives an item to the thread. \return whether it replaced one that waited. */
  bool put(Item item) {
    bool replaced = false;
    {
      const std::lock_guard lock(mutex_);
      replaced = waiting_.has_value();
      waiting_ = std::move(item);
    }
    changed_.notify_all();
    return replaced;
  }

 private:
  void run() {
    for (;;) {
      std::optional<Item> item;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
        if (stopping_) return;
        item.swap(waiting_);
      }
      work_(std::move(*item));
    }
  }

  std::function<void(Item)> work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Item> waiting_;
  bool stopping_ = true;
  std::thread thread_;
};

}  // namespace pcl_slim_ros
