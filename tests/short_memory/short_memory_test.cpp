// SPDX-License-Identifier: BSD-3-Clause
// Every class says in one sentence that memory is short, whichever allocation fails, and works
// again afterwards. The program's own operator new fails after a number of allocations.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace {

std::atomic<long> left{-1};  ///< allocations that go well until one fails; negative: all do

void* allocated(std::size_t size, std::size_t alignment) {
  if (left.load() >= 0 && left.fetch_sub(1) == 0) throw std::bad_alloc();
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  void* const place = std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}

}  // namespace

void* operator new(std::size_t size) {
  return allocated(size, alignof(std::max_align_t));
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocated(size, static_cast<std::size_t>(alignment));
}

// GCC takes what is inlined for a free() of what another operator allocated.
[[gnu::noinline]] void operator delete(void* place) noexcept {
  std::free(place);
}

[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept {
  std::free(place);
}

[[gnu::noinline]] void operator delete(void* place, std::align_val_t) noexcept {
  std::free(place);
}

[[gnu::noinline]] void operator delete(void* place, std::size_t, std::align_val_t) noexcept {
  std::free(place);
}

namespace pcl_slim {
namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr wavyCloud(int side = 30) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  const float spacing = 0.9f / static_cast<float>(side);
  for (int i = 0; i < side * side; ++i) {
    const float x = spacing * static_cast<float>(i % side);
    const float y = spacing * static_cast<float>(i / side);
    cloud->push_back(pcl::PointXYZ(x, y, 0.1f * std::sin(6 * x) * std::cos(5 * y)));
  }
  return cloud;
}

/** Runs work(), which says whether it went well, with the k-th allocation failing, for growing k
 * until none is reached. */
template <typename Door, typename Work>
void expectSentences(Door& door, const Work& work) {
  int failures = 0;
  for (long k = 0; k < 2000000; k += 1 + k / 12) {
    left = k;
    bool done = false;
    try {
      done = work();
    } catch (const std::bad_alloc&) {
      left = -1;
      FAIL() << "allocation " << k << " of it went past the class";
    }
    const bool reached = left.load() < 0;
    left = -1;
    if (!reached) {
      EXPECT_TRUE(done) << door.getError().message;
      break;
    }
    if (done) continue;  // some allocations are done without
    ++failures;
    EXPECT_FALSE(door.getError().message.empty()) << k;
  }
  EXPECT_GT(failures, 5);
  EXPECT_TRUE(work()) << door.getError().message;
}

TEST(ShortMemory, AFitSaysSo) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(wavyCloud());
  for (const unsigned int threads : {1u, 2u, 3u}) {
    fit.setNumberOfThreads(threads);
    SLIMSurface surface;
    ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;  // the pool of threads stands
    expectSentences(fit, [&] { return fit.fit(surface); });
  }
}

TEST(ShortMemory, AFitOfManyBallsSaysSo) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(wavyCloud(120));
  fit.setNumberOfThreads(2);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  expectSentences(fit, [&] { return fit.fit(surface); });
}

/** Fits while each of the first allocations fails in turn, among them those with which the pool of
 * threads sets itself up once a process. \return how many fits there were until one went well */
int fitsUntilPoolStands() {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(wavyCloud(18));
  fit.setNumberOfThreads(2);
  SLIMSurface surface;
  for (long k = 0; k < 4000; ++k) {
    left = k;
    const bool done = fit.fit(surface);
    const bool reached = left.load() < 0;
    left = -1;
    if (!reached) return done ? static_cast<int>(k) : -1;
  }
  return 0;
}

TEST(ShortMemory, APoolOfThreadsThatCannotBeginDoesNotHang) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a process in which no loop has run yet
  EXPECT_EXIT(
      {
        alarm(60);
        std::exit(fitsUntilPoolStands() > 100 ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST(ShortMemory, ASmoothingSaysSo) {
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(wavyCloud());
  smoother.setNumberOfThreads(1);
  pcl::PointCloud<pcl::PointXYZ> smooth;
  expectSentences(smoother, [&] {
    smoother.process(smooth);
    return !smoother.getError();
  });
}

TEST(ShortMemory, SplatsSaySo) {
  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  sampler.setInputCloud(wavyCloud());
  sampler.setNumberOfThreads(1);
  SplatSet splats;
  expectSentences(sampler, [&] { return sampler.sample(splats); });
}

}  // namespace
}  // namespace pcl_slim
