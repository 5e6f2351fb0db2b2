// SPDX-License-Identifier: BSD-3-Clause
// The thread that works on the newest item, without a clock: its work waits until the test lets it go on.
#include "newest_worker.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <vector>

namespace pcl_slim_ros {
namespace {

TEST(NewestWorker, ReplacesTheItemThatWaits) {
  std::mutex mutex;
  std::condition_variable changed;
  bool open = false;
  std::vector<int> begun, done;
  NewestWorker<int> worker([&](int item) {
    std::unique_lock lock(mutex);
    begun.push_back(item);
    changed.notify_all();
    changed.wait(lock, [&] { return open; });
    done.push_back(item);
    changed.notify_all();
  });
  worker.start();
  EXPECT_FALSE(worker.put(1));
  std::unique_lock lock(mutex);
  changed.wait(lock, [&] { return begun.size() == 1; });
  lock.unlock();
  EXPECT_FALSE(worker.put(2));
  EXPECT_TRUE(worker.put(3));
  EXPECT_TRUE(worker.put(4));
  lock.lock();
  open = true;
  changed.notify_all();
  changed.wait(lock, [&] { return done.size() == 2; });
  lock.unlock();
  worker.stop();
  EXPECT_EQ(done, (std::vector<int>{1, 4}));
}

TEST(NewestWorker, DropsWhatWaitsWhenItStops) {
  std::vector<int> done;
  NewestWorker<int> worker([&](int item) { done.push_back(item); });
  EXPECT_FALSE(worker.put(1));  // no thread takes it yet
  worker.stop();
  EXPECT_FALSE(worker.put(2)) << "the first was dropped";
  worker.stop();
  EXPECT_TRUE(done.empty());
}

}  // namespace
}  // namespace pcl_slim_ros
