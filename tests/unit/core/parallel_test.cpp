// SPDX-License-Identifier: BSD-3-Clause
// Loops over several threads: every index once, whoever calls and however often.
#include "pcl_slim/core/parallel.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace pcl_slim {
namespace {

/** How often each index ran; threads out of range count as failures. */
std::vector<int> runsOf(std::size_t count, int threads, std::size_t chunk) {
  std::vector<int> runs(count);
  std::atomic<int> strangers{0};
  parallelFor(count, threads, chunk, [&](std::size_t i, int thread) {
    ++runs[i];
    strangers += thread < 0 || thread >= threads;
  });
  EXPECT_EQ(strangers, 0);
  return runs;
}

TEST(ParallelFor, RunsEveryIndexOnce) {
  for (const int threads : {1, 2, 8, 3, 1, 2}) {
    for (const std::size_t count : {0, 1, 7, 64, 1000}) {
      for (const std::size_t chunk : {1, 16, 5000}) {
        ASSERT_EQ(runsOf(count, threads, chunk), std::vector<int>(count, 1));
      }
    }
  }
}

TEST(ParallelFor, GivesNoThreadTwoBodiesAtOnce) {
  std::vector<std::atomic<int>> inside(8);
  std::atomic<bool> twice{false};
  parallelFor(2000, 8, 1, [&](std::size_t, int thread) {
    auto& mine = inside[static_cast<std::size_t>(thread)];
    if (++mine > 1) twice = true;
    std::this_thread::yield();
    --mine;
  });
  EXPECT_FALSE(twice);
}

TEST(ParallelFor, IsHelpedByAnotherThread) {
  if (resolveThreads(0) < 2) GTEST_SKIP() << "one core: nobody can help";
  // The pool may be late for one loop, but not for all.
  std::array<std::thread::id, 2> ids;
  const auto note = [&](std::size_t i, int) {
    ids[i] = std::this_thread::get_id();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  for (int loop = 0; loop < 2000 && ids[0] == ids[1]; ++loop) parallelFor(2, 2, 1, note);
  EXPECT_NE(ids[0], ids[1]);
}

TEST(ParallelFor, WakesThreadsThatFellAsleep) {
  for (int round = 0; round < 20; ++round) {
    ASSERT_EQ(runsOf(100, 4, 1), std::vector<int>(100, 1));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST(ParallelFor, ManyShortRoundsLoseNothing) {
  std::vector<std::uint64_t> sums(8);
  for (int round = 0; round < 20000; ++round) {
    parallelFor(8, 1 + round % 8, 1, [&](std::size_t i, int) { sums[i] += i; });
  }
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(sums[i], 20000 * i);
}

TEST(ParallelFor, HandsOnAnExceptionAndGoesOnWorking) {
  for (const int threads : {1, 2, 8}) {
    const auto fail = [](std::size_t i, int) {
      if (i == 37) throw std::runtime_error("37");
    };
    EXPECT_THROW(parallelFor(100, threads, 1, fail), std::runtime_error);
    EXPECT_EQ(runsOf(100, threads, 1), std::vector<int>(100, 1));
  }
}

TEST(ParallelFor, InsideAnotherRunsOnItsOwnThread) {
  std::vector<int> runs(400);
  std::atomic<bool> elsewhere{false};
  parallelFor(20, 4, 1, [&](std::size_t i, int) {
    const auto self = std::this_thread::get_id();
    parallelFor(20, 4, 1, [&](std::size_t j, int thread) {
      ++runs[20 * i + j];
      if (thread != 0 || std::this_thread::get_id() != self) elsewhere = true;
    });
  });
  EXPECT_EQ(runs, std::vector<int>(400, 1));
  EXPECT_FALSE(elsewhere);
}

TEST(ParallelFor, ServesSeveralCallersAtOnce) {
  std::vector<std::thread> callers;
  std::atomic<int> wrong{0};
  for (int c = 0; c < 4; ++c) {
    callers.emplace_back([&wrong] {
      for (int round = 0; round < 200; ++round) {
        std::vector<int> runs(50);
        parallelFor(50, 3, 1, [&](std::size_t i, int) { ++runs[i]; });
        wrong += std::accumulate(runs.begin(), runs.end(), 0) != 50;
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(wrong, 0);
}

/** Threads of this process that are alive. */
std::size_t livingThreads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task"), end;
  return static_cast<std::size_t>(std::distance(tasks, end));
}

TEST(ParallelFor, CallersShareOnePool) {
  if (!std::filesystem::exists("/proc/self/task")) GTEST_SKIP() << "the system tells no threads";
  // A team for each caller would be kCallers times as many helpers as there are cores.
  constexpr int kCallers = 8;
  const int threads = resolveThreads(0) + 2;
  const std::size_t before = livingThreads();
  std::atomic<int> done{0}, wrong{0};
  std::atomic<bool> counted{false};
  std::vector<std::thread> callers;
  for (int c = 0; c < kCallers; ++c) {
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round)
        wrong += runsOf(500, threads, 1) != std::vector<int>(500, 1);
      ++done;
      while (!counted) std::this_thread::yield();
    });
  }
  while (done < kCallers) std::this_thread::yield();
  const std::size_t living = livingThreads();
  counted = true;
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(living, before + kCallers + static_cast<std::size_t>(threads));
}

}  // namespace
}  // namespace pcl_slim
