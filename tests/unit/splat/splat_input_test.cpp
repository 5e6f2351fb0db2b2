// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/splat_sampling.h"

#include <limits>
#include <string>

#include "painted_clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

TEST(SplatInput, OneColourOnePointOneLine) {
  PaintedCloud cloud;
  SplatSet splats;
  cloud.add({1, 2, 3}, {0, 0, 1}, {10, 20, 30});
  splats = sampled(cloud, oneThread());
  ASSERT_EQ(splats.size(), 1u);
  EXPECT_EQ(splats.rgb[0], 0x0a141eu);
  EXPECT_EQ(splats.radius[0], 0.0f);
  EXPECT_EQ(splats.origin[2] + splats.z[0], 3.0);
  for (int i = 0; i < 50; ++i) cloud.add({1, 2, 3}, {0, 0, 1}, {10, 20, 30});
  EXPECT_EQ(sampled(cloud, oneThread()).size(), 1u);
  for (int i = 0; i < 500; ++i) cloud.add({1.0 + 0.01 * i, 2, 3}, {0, 0, 1}, {10, 20, 30});
  for (const bool normals : {true, false}) {
    for (const RadiusRule rule : {RadiusRule::kDensity, RadiusRule::kNeighbors}) {
      SplatParams params = oneThread();
      params.radius = rule;
      splats = sampled(cloud, params, nullptr, normals);
      expectSound(splats, 500);
      for (const std::uint32_t rgb : splats.rgb) EXPECT_EQ(rgb, 0x0a141eu);
    }
  }
}

/** A painted cloud's coordinates and normals as floats, this many apart; nothing follows the
 * last point. */
class PackedFloats {
 public:
  PackedFloats(const PaintedCloud& cloud, std::size_t apart)
      : apart_(apart),
        cloud_(cloud),
        positions_(pack(cloud.points)),
        normals_(pack(cloud.normals)) {}

  SplatSet splats() const {
    CloudView view;
    view.xyz = positions_.data();
    view.normal = normals_.data();
    view.xyz_stride = view.normal_stride = apart_ * sizeof(float);
    view.size = cloud_.size();
    SplatSet splats;
    const Error error = sampleSplats(view, cloud_.colors(), oneThread(), splats);
    EXPECT_FALSE(error) << error.message;
    return splats;
  }

 private:
  template <typename T>
  std::vector<float> pack(const std::vector<T>& values) const {
    const std::size_t n = values.size() / 3;
    std::vector<float> packed((n - 1) * apart_ + 3, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < values.size(); ++i) {
      packed[i / 3 * apart_ + i % 3] = static_cast<float>(values[i]);
    }
    return packed;
  }

  std::size_t apart_;
  const PaintedCloud& cloud_;
  std::vector<float> positions_, normals_;
};

TEST(SplatInput, WhatStandsBetweenAndBehindPointsIsNotUsed) {
  for (const std::size_t count : {1u, 5u, 20000u}) {
    const PaintedCloud cloud = painted(count);
    const SplatSet close = PackedFloats(cloud, 3).splats();
    if (count > 1) expectSound(close, count);
    for (const std::size_t apart : {4u, 7u}) {
      const SplatSet wide = PackedFloats(cloud, apart).splats();
      expectSame(wide, close);
    }
  }
}

TEST(SplatInput, ThreadsChangeNothing) {
  const PaintedCloud cloud = painted(70000, 5.0);
  for (int mode = 0; mode < 3; ++mode) {
    SplatParams params = oneThread();
    if (mode == 1) params.max_splats = 3000;
    if (mode == 2) params.radius = RadiusRule::kNeighbors;
    params.color = SplatColor::kGradient;
    const SplatSet one = sampled(cloud, params, nullptr, mode != 2);
    for (const int threads : {2, 7}) {
      params.threads = threads;
      expectSame(one, sampled(cloud, params, nullptr, mode != 2));
    }
  }
}

/** The same cloud with its points in another order, each so many times, and so many points that are
 * nowhere. \param[out] from the point of the cloud that each is. */
PaintedCloud shuffled(const PaintedCloud& cloud, std::size_t times, std::size_t nowhere,
                      std::vector<std::uint32_t>& from) {
  from.assign(nowhere, 0xffffffffu);
  for (std::uint32_t i = 0; i < times * cloud.size(); ++i) {
    from.push_back(i % static_cast<std::uint32_t>(cloud.size()));
  }
  std::shuffle(from.begin(), from.end(), std::mt19937_64(9));
  PaintedCloud made;
  for (const std::uint32_t k : from) {
    if (k == 0xffffffffu) {
      made.add({1.0, std::nan(""), 2.0}, {0, 0, 1}, {1, 2, 3});
      continue;
    }
    made.points.insert(made.points.end(), &cloud.points[3 * k], &cloud.points[3 * k] + 3);
    made.normals.insert(made.normals.end(), &cloud.normals[3 * k], &cloud.normals[3 * k] + 3);
    made.bgr.insert(made.bgr.end(), &cloud.bgr[3 * k], &cloud.bgr[3 * k] + 3);
  }
  return made;
}

TEST(SplatInput, OrderDuplicatesAndPointsThatAreNowhereChangeNothing) {
  for (const std::size_t count : {3000u, 50000u}) {
    const PaintedCloud cloud = painted(count, 5.0);
    for (int mode = 0; mode < 4; ++mode) {
      SplatParams params = oneThread();
      if (mode == 1) params.max_splats = 1000;
      if (mode == 2) params.radius = RadiusRule::kNeighbors;
      if (mode == 3) params.paper_mode = true;
      params.color = SplatColor::kGradient;
      const bool normals = mode != 2;
      const SplatSet expected = sampled(cloud, params, nullptr, normals);
      for (const std::size_t times : {1u, 2u, 3u}) {
        SCOPED_TRACE(std::to_string(mode) + " x " + std::to_string(times));
        std::vector<std::uint32_t> from;
        const PaintedCloud other = shuffled(cloud, times, times == 2 ? 0 : count / 4, from);
        SplatSet splats = sampled(other, params, nullptr, normals);
        for (std::uint32_t& kept : splats.kept) kept = from[kept];
        expectSame(splats, expected);
      }
    }
  }
}

TEST(SplatInput, CoordinatesNearTheLargestFloatAreAnError) {
  PaintedCloud cloud = painted(500);
  for (double& value : cloud.points) value *= 2.5e38;
  SplatSet splats;
  const Error error = sampleSplats(cloud.view(), cloud.colors(), {}, splats);
  EXPECT_EQ(error.code, ErrorCode::kBadInput);
  EXPECT_NE(error.message.find("scale"), std::string::npos) << error.message;
  for (double& value : cloud.points) value *= 1e-70;
  expectSound(sampled(cloud, oneThread()), cloud.size());
}

TEST(SplatInput, DifferencesThatFloatsCannotHoldAreAnError) {
  for (const double size : {1e-35, 1e-310, 1e-320}) {
    PaintedCloud cloud = painted(500);
    for (double& value : cloud.points) value *= size;
    SplatSet splats;
    const Error error = sampleSplats(cloud.view(), cloud.colors(), {}, splats);
    EXPECT_EQ(error.code, ErrorCode::kBadInput) << size;
    EXPECT_NE(error.message.find("scale"), std::string::npos) << error.message;
  }
}

TEST(SplatInput, BadInputIsAnError) {
  SplatSet splats;
  PaintedCloud cloud;
  EXPECT_EQ(sampleSplats(cloud.view(), {}, {}, splats).code, ErrorCode::kBadInput);
  cloud = painted(100);
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.points[3 * i] = std::nan("");
  EXPECT_EQ(sampleSplats(cloud.view(), {}, {}, splats).code, ErrorCode::kBadInput);
  cloud.points[0] = 1e200;
  cloud.points[4] = 0;
  EXPECT_EQ(sampleSplats(cloud.view(), {}, {}, splats).code, ErrorCode::kBadInput);
  cloud = painted(100);
  cloud.points[7] = std::numeric_limits<double>::infinity();
  SplatStatistics statistics;
  EXPECT_FALSE(sampleSplats(cloud.view(), cloud.colors(), {}, splats, &statistics));
  EXPECT_EQ(statistics.non_finite, 1u);
  EXPECT_EQ(statistics.points, 99u);
}

TEST(SplatInput, IndicesOutOfRangeAreAnError) {
  SplatSet splats;
  const PaintedCloud cloud = painted(100);
  const std::int32_t indices[] = {0, 100};
  CloudView view = cloud.view();
  view.indices = indices;
  view.num_indices = 2;
  EXPECT_EQ(sampleSplats(view, {}, {}, splats).code, ErrorCode::kBadArgument);
  EXPECT_TRUE(splats.empty());
}

TEST(SplatInput, BadParametersAreErrors) {
  const PaintedCloud cloud = painted(100);
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<SplatParams> bad(12);
  bad[0].geometric_error = -0.1;
  bad[1].color_error = nan;
  bad[2].max_depth = -1;
  bad[3].initial_resolution = (1 << 20) + 1;
  bad[4].target_error = -1.0;
  bad[5].max_splats = 10;
  bad[5].target_error = 1.0;
  bad[6].normal_neighbors = 2;
  bad[7].viewpoint = {{0, nan, 0}};
  bad[8].geometric_error = inf;
  bad[9].color_error = inf;
  bad[10].threads = 100000;
  bad[11].threads = -1;
  for (const SplatParams& params : bad) {
    SplatSet splats;
    splats.resize(3, false);
    const Error error = sampleSplats(cloud.view(), cloud.colors(), params, splats);
    EXPECT_EQ(error.code, ErrorCode::kBadArgument);
    EXPECT_FALSE(error.message.empty());
    EXPECT_TRUE(splats.empty());
  }
}

TEST(SplatInput, AnyResolutionAndDepthWorks) {
  const PaintedCloud cloud = painted(3000);
  for (const int resolution : {1, 2, 3, 63, 64, 65, 1000, 1 << 20}) {
    for (const int depth : {0, 1, 1000000}) {
      SplatParams params = oneThread();
      params.initial_resolution = resolution;
      params.max_depth = depth;
      const SplatSet splats = sampled(cloud, params);
      expectSound(splats, cloud.size());
      if (resolution == 1 && depth == 0) {
        EXPECT_EQ(splats.size(), 1u);
      }
      if (resolution == 1 << 20) {
        EXPECT_EQ(splats.size(), cloud.size());
      }
    }
  }
}

TEST(SplatInput, CancelStops) {
  const PaintedCloud cloud = painted(1000);
  Progress* running = nullptr;
  Progress progress([&](float, const char*) { running->cancel(); });
  running = &progress;
  SplatSet splats;
  EXPECT_EQ(sampleSplats(cloud.view(), cloud.colors(), {}, splats, nullptr, &progress).code,
            ErrorCode::kCancelled);
  EXPECT_TRUE(splats.empty());
}

}  // namespace
}  // namespace pcl_slim
