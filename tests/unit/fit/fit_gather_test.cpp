// SPDX-License-Identifier: BSD-3-Clause
// Gathering, covering and marking the points of a ball against loops over all points.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scan/ball_kernels.h"
#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using namespace pcl_slim_test;

constexpr float kUntouched = -7.0f;

/** A ball about a stored point, its blocks, and which points are in it by double arithmetic. */
struct GatheredBall {
  BallQuery query;
  BlockList blocks;
  std::vector<std::size_t> inside, bounded;
  bool clear = true;  ///< no point is so near a limit that rounding decides
};

GatheredBall ballAt(const PointStore& store, std::size_t i, float radius,
                    const std::array<float, 3>* bound, float min_dot) {
  GatheredBall ball;
  const auto p = store.position(i);
  for (std::size_t a = 0; a < 3; ++a) ball.query.center[a] = static_cast<float>(p[a]);
  ball.query.radius = radius;
  ball.query.bound_normal = bound != nullptr ? bound->data() : nullptr;
  ball.query.min_dot = min_dot;
  std::vector<std::uint32_t> blocks;
  store.tree().blocksInBall(ball.query.center.data(), radius, blocks);
  ball.blocks.assign(blocks.begin(), blocks.end());
  for (std::size_t j = 0; j < store.size(); ++j) {
    const auto q = store.position(j);
    const auto& c = ball.query.center;
    const double distance = std::hypot(q[0] - c[0], q[1] - c[1], q[2] - c[2]);
    if (std::abs(distance - radius) < 1e-6) ball.clear = false;
    if (distance >= radius) continue;
    ball.inside.push_back(j);
    double dot = 1;
    if (bound != nullptr) {
      const auto n = store.normal(j);
      dot = double(n[0]) * (*bound)[0] + double(n[1]) * (*bound)[1] + double(n[2]) * (*bound)[2];
    }
    if (bound != nullptr && std::abs(dot - min_dot) < 1e-6) ball.clear = false;
    if (bound == nullptr || dot > min_dot) ball.bounded.push_back(j);
  }
  return ball;
}

class FitGather : public testing::Test {
 protected:
  void SetUp() override {
    const auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kTorus, 2500, 0.01, 0.8);
    with_normals_ = storeOf(cloud);
    without_normals_ = storeOf(cloud.withoutNormals());
  }

  /** Calls body(store, ball) for balls of many sizes, with and without a bound. */
  template <typename Body>
  void forEachBall(const Body& body) {
    std::mt19937 random(51);
    std::uniform_int_distribution<std::size_t> pick(0, with_normals_.size() - 1);
    int tested = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const PointStore& store = trial % 3 == 0 ? without_normals_ : with_normals_;
      const std::size_t i = pick(random);
      const auto bound = with_normals_.normal(i);
      const float radius = 0.004f * static_cast<float>(1 + trial);
      const GatheredBall ball =
          ballAt(store, i, radius, trial % 3 == 0 ? nullptr : &bound, trial % 3 == 1 ? 0.0f : 0.5f);
      if (!ball.clear) continue;
      ++tested;
      body(store, ball);
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(tested, 40);
  }

  PointStore with_normals_, without_normals_;
};

TEST_F(FitGather, TakesThePointsOfTheBallAndItsSums) {
  forEachBall([](const PointStore& store, const GatheredBall& ball) {
    BallBuffer buffer;
    BallSums sums;
    kernels::gatherBall(store, ball.blocks, ball.query, true, buffer, sums);
    ASSERT_EQ(sums.inside, ball.inside.size());
    ASSERT_EQ(buffer.count, ball.bounded.size());
    double weight = 0, first = 0, second[6] = {}, normal = 0;
    for (std::size_t k = 0; k < ball.bounded.size(); ++k) {
      const auto q = store.position(ball.bounded[k]);
      const auto& c = ball.query.center;
      const double d[3] = {q[0] - c[0], q[1] - c[1], q[2] - c[2]};
      // Points stand in stored order: a fit is the same however they were found.
      ASSERT_NEAR(buffer.u[k], d[0], 1e-7);
      ASSERT_NEAR(buffer.v[k], d[1], 1e-7);
      ASSERT_NEAR(buffer.w[k], d[2], 1e-7);
      const double d_sq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      ASSERT_NEAR(buffer.s_sq[k], d_sq, 1e-7 * ball.query.radius);
      const double g =
          evaluateKernel(WeightKernel::kPower4, d_sq / (ball.query.radius * ball.query.radius));
      weight += g;
      first += g * d[1];
      for (int a = 0, m = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b, ++m) second[m] += g * d[a] * d[b];
      }
      if (ball.query.bound_normal != nullptr) normal += g * store.normal(ball.bounded[k])[2];
    }
    const double r = ball.query.radius;
    ASSERT_NEAR(sums.weight, weight, 1e-4 * weight);
    ASSERT_NEAR(sums.first[1], first, 1e-4 * weight * r);
    for (std::size_t m = 0; m < 6; ++m)
      ASSERT_NEAR(sums.second[m], second[m], 1e-4 * weight * r * r);
    ASSERT_NEAR(sums.normal[2], normal, 1e-4 * weight);
  });
}

TEST_F(FitGather, TurnsOffsetsIntoTheFrame) {
  forEachBall([](const PointStore& store, const GatheredBall& ball) {
    BallBuffer buffer;
    BallSums sums;
    kernels::gatherBall(store, ball.blocks, ball.query, false, buffer, sums);
    const LocalFrame frame({0.36, 0.48, -0.8});
    kernels::toFrame(frame, ball.query.radius, buffer);
    for (std::size_t k = 0; k < ball.bounded.size(); ++k) {
      const auto q = store.position(ball.bounded[k]);
      double u = 0, v = 0, w = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = (q[a] - ball.query.center[a]) / ball.query.radius;
        u += d * frame.u[a];
        v += d * frame.v[a];
        w += d * frame.w[a];
      }
      ASSERT_NEAR(buffer.u[k], u, 2e-6);
      ASSERT_NEAR(buffer.v[k], v, 2e-6);
      ASSERT_NEAR(buffer.w[k], w, 2e-6);
      ASSERT_NEAR(buffer.s_sq[k], u * u + v * v + w * w, 4e-6);
    }
  });
}

TEST_F(FitGather, MarksOnlyThePointsOfTheBall) {
  forEachBall([](const PointStore& store, const GatheredBall& ball) {
    std::vector<std::uint8_t> marks(store.numBlocks() * PointStore::kBlock, 8), expected = marks;
    for (const std::size_t i : ball.bounded) expected[i] = 9;
    kernels::markPoints(store, ball.blocks, ball.query, 1, marks.data());
    ASSERT_EQ(marks, expected);
  });
}

TEST_F(FitGather, CoversOnlyThePointsOfTheBallNearTheSurface) {
  for (const WeightKernel kernel : {WeightKernel::kPower7, WeightKernel::kGaussian}) {
    for (int degree = 1; degree <= kMaxDegree; ++degree) {
      const bool to_foot = degree % 2 == 0;
      forEachBall([&](const PointStore& store, const GatheredBall& ball) {
        std::array<float, kMaxCoefficients> c{};
        for (std::size_t k = 0; k < static_cast<std::size_t>(numCoefficients(degree)); ++k) {
          c[k] = 0.05f * static_cast<float>(k % 4) - 0.07f;
        }
        const LocalFrame frame({0.48, 0.6, 0.64});
        const float support = 1.5f * ball.query.radius;
        const kernels::CoverLeaf leaf{ball.query, frame,          degree, support,
                                      c.data(),   0.2f * support, to_foot};
        std::vector<float> coverage(store.numBlocks() * PointStore::kBlock, kUntouched);
        kernels::coverPoints(store, ball.blocks, leaf, kernel, coverage.data());
        std::vector<float> expected(coverage.size(), kUntouched);
        for (const std::size_t i : ball.bounded) {
          const auto q = store.position(i);
          double u = 0, v = 0, w = 0, d_sq = 0;
          for (std::size_t a = 0; a < 3; ++a) {
            const double d = q[a] - ball.query.center[a];
            d_sq += d * d;
            u += d * frame.u[a] / support;
            v += d * frame.v[a] / support;
            w += d * frame.w[a] / support;
          }
          const double residual = w - evaluateHeight(degree, c.data(), u, v);
          const double off = std::abs(residual) - 0.2;
          if (to_foot) d_sq = std::max(0.0, d_sq - residual * residual * support * support);
          if (std::abs(off) < 1e-5) expected[i] = coverage[i];  // rounding decides
          if (off >= -1e-5) continue;
          expected[i] += static_cast<float>(
              evaluateKernel(kernel, d_sq / (ball.query.radius * ball.query.radius)));
        }
        for (std::size_t i = 0; i < expected.size(); ++i) {
          const double slack = expected[i] == kUntouched ? 1e-6 : 2e-5;
          ASSERT_NEAR(coverage[i], expected[i], slack) << i;
        }
      });
    }
  }
}

}  // namespace
}  // namespace pcl_slim
