// SPDX-License-Identifier: BSD-3-Clause
// Every class says in one sentence that memory is short, whichever allocation fails, and works again
// afterwards. The program's own operator new fails when it is told to.
#include <gtest/gtest.h>

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

void*
allocated(std::size_t size, std::size_t alignment)
{
  if (left.load() >= 0 && left.fetch_sub(1) == 0) throw std::bad_alloc();
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  void* const place = std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}

}  // namespace

void*
operator new(std::size_t size)
{
  return allocated(size, alignof(std::max_align_t));
}

void*
operator new(std::size_t size, std::align_val_t alignment)
{
  return allocated(size, static_cast<std::size_t>(alignment));
}

void
operator delete(void* place) noexcept
{
  std::free(place);
}

void
operator delete(void* place, std::size_t) noexcept
{
  std::free(place);
}

void
operator delete(void* place, std::align_val_t) noexcept
{
  std::free(place);
}

void
operator delete(void* place, std::size_t, std::align_val_t) noexcept
{
  std::free(place);
}

namespace pcl_slim {
namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr
wavyCloud()
{
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (int i = 0; i < 900; ++i) {
    const float x = 0.03f * static_cast<float>(i % 30), y = 0.03f * static_cast<float>(i / 30);
    cloud->push_back(pcl::PointXYZ(x, y, 0.1f * std::sin(6 * x) * std::cos(5 * y)));
  }
  return cloud;
}

/** Runs work(), which says whether it went well, with the k-th allocation failing, for growing k until
 * none is reached. */
template <typename Door, typename Work>
void
expectSentences(Door& door, const Work& work)
{
  int failures = 0;
  for (long k = 0; k < 2000000; k += 1 + k / 3) {
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

TEST(ShortMemory, AFitSaysSo)
{
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(wavyCloud());
  for (const unsigned int threads : {1u, 2u}) {
    fit.setNumberOfThreads(threads);
    SLIMSurface surface;
    expectSentences(fit, [&] { return fit.fit(surface); });
  }
}

TEST(ShortMemory, ASmoothingSaysSo)
{
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(wavyCloud());
  smoother.setNumberOfThreads(1);
  pcl::PointCloud<pcl::PointXYZ> smooth;
  expectSentences(smoother, [&] {
    smoother.process(smooth);
    return !smoother.getError();
  });
}

TEST(ShortMemory, SplatsSaySo)
{
  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  sampler.setInputCloud(wavyCloud());
  sampler.setNumberOfThreads(1);
  SplatSet splats;
  expectSentences(sampler, [&] { return sampler.sample(splats); });
}

}  // namespace
}  // namespace pcl_slim
