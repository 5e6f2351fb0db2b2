// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/octree_cloud.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "octree/octree.h"
#include "painted_clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using namespace pcl_slim_test;

using Cell = std::array<long, 3>;

Cell cellOf(const PaintedCloud& cloud, const OctreeCloud& octree, std::size_t point, double width) {
  float p[3];
  octree.frame().position(cloud.points.data() + 3 * point, p);
  Cell cell;
  for (std::size_t a = 0; a < 3; ++a) cell[a] = static_cast<long>(std::floor(p[a] / width));
  return cell;
}

TEST(OctreeCloud, RootsAreTheOccupiedCellsOfTheGrid) {
  const PaintedCloud cloud = painted(20000);
  for (const int resolution : {1, 3, 40, 1000, 1 << 20}) {
    const auto octree = OctreeCloud::build(cloud.view(), {resolution, 0}, 2);
    ASSERT_TRUE(octree);
    EXPECT_EQ(octree->resolution(), resolution);
    std::map<Cell, std::size_t> counts;
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i < cloud.size(); ++i) ++counts[cellOf(cloud, *octree, i, 1.0)];
    ASSERT_EQ(octree->numRoots(), counts.size());
    for (std::size_t r = 0; r < octree->numRoots(); ++r) {
      const std::size_t begin = octree->root(r).begin, end = octree->root(r + 1).begin;
      const Cell cell = cellOf(cloud, *octree, octree->order(begin), 1.0);
      ASSERT_EQ(end - begin, counts[cell]);
      for (std::size_t i = begin; i < end; ++i) {
        ASSERT_EQ(cellOf(cloud, *octree, octree->order(i), 1.0), cell);
        ASSERT_TRUE(seen.insert(octree->order(i)).second);
        ASSERT_EQ(octree->rootOf(i), r);
      }
    }
    std::set<Cell> wide;
    for (std::size_t i = 0; i < cloud.size(); ++i) wide.insert(cellOf(cloud, *octree, i, 2.0));
    EXPECT_EQ(octree->countCells(1), wide.size());
  }
}

TEST(OctreeCloud, KeysTellCellsBelowRootsApart) {
  const PaintedCloud cloud = painted(20000);
  const auto octree = OctreeCloud::build(cloud.view(), {20, 0}, 1);
  ASSERT_TRUE(octree);
  const RunKeys keys{octree->keys()};
  const int shift = octree->depth() - 4;
  const double width = octree->edge(shift);
  std::set<Cell> cells;
  std::size_t runs = 0;
  for (std::size_t at = 0; at < octree->size(); ++runs) {
    const std::size_t end = keys.runEnd(at, octree->size(), shift);
    const Cell cell = cellOf(cloud, *octree, octree->order(at), width);
    EXPECT_TRUE(cells.insert(cell).second) << "a cell is one run";
    for (; at < end; ++at) ASSERT_EQ(cellOf(cloud, *octree, octree->order(at), width), cell);
  }
  EXPECT_GT(runs, octree->numRoots());
}

/** The level at which a point falls apart from the one before it. */
int levelBetween(const OctreeCloud& cloud, std::size_t i) {
  return RunKeys{cloud.keys()}.dividingShift(i - 1, i + 1);
}

TEST(OctreeCloud, EqualPointsCountOnceAndOrderIsNoMatter) {
  const PaintedCloud cloud = painted(3000);
  PaintedCloud mixed;
  for (std::size_t i = 2 * cloud.size(); i-- > 0;) {  // every point twice, backwards
    const std::size_t k = i % cloud.size();
    const float* n = cloud.normals.data() + 3 * k;
    const std::uint8_t* c = cloud.bgr.data() + 3 * k;
    mixed.add({cloud.points[3 * k], cloud.points[3 * k + 1], cloud.points[3 * k + 2]},
              {n[0], n[1], n[2]}, {c[2], c[1], c[0]});
    if (i % 7 == 0) mixed.add({std::nan(""), 0, 0}, {0, 0, 1}, {0, 0, 0});
  }
  const RootGrid grid{0, 0, 20};
  const auto once = OctreeCloud::build(cloud.view(), grid, 1, cloud.colors());
  const auto twice = OctreeCloud::build(mixed.view(), grid, 3, mixed.colors());
  ASSERT_TRUE(once && twice);
  EXPECT_EQ(twice->numDuplicates(), cloud.size());
  EXPECT_EQ(twice->resolution(), once->resolution());
  ASSERT_EQ(twice->size(), once->size());
  for (std::size_t i = 0; i < once->size(); ++i) {
    // Keys may end at other bits, and divide the points alike.
    if (i > 0) {
      ASSERT_EQ(levelBetween(*twice, i), levelBetween(*once, i));
    }
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_EQ(mixed.points[3 * twice->order(i) + a], cloud.points[3 * once->order(i) + a]);
    }
  }
}

TEST(OctreeCloud, PointsAtOnePlaceWithOtherColoursStay) {
  PaintedCloud cloud = painted(100);
  cloud.add({cloud.points[0], cloud.points[1], cloud.points[2]}, {0, 0, 1}, {1, 2, 3});
  const auto octree = OctreeCloud::build(cloud.view(), {4, 0, 0}, 1, cloud.colors());
  ASSERT_TRUE(octree);
  EXPECT_EQ(octree->size(), 101u);
}

/** Clouds of more places than are drawn: how many there are is guessed, from the same places each
 * time. */
TEST(OctreeCloud, CountsPlacesHoweverOftenTheyAreGiven) {
  const PaintedCloud cloud = painted(60000);
  const auto resolutionOf = [&](std::size_t times) {
    PaintedCloud repeated;
    for (std::size_t k = 0; k < times; ++k) {
      repeated.points.insert(repeated.points.end(), cloud.points.begin(), cloud.points.end());
    }
    const auto octree = OctreeCloud::build(repeated.view(false), {0, 0, 50}, 2);
    EXPECT_TRUE(octree);
    return octree ? octree->resolution() : 0;
  };
  const int once = resolutionOf(1);
  for (const std::size_t times : {2u, 5u, 9u}) EXPECT_EQ(resolutionOf(times), once) << times;
  const auto exact = OctreeCloud::build(cloud.view(), {0, 60000.0 / 50, 0}, 1);
  ASSERT_TRUE(exact);
  EXPECT_NEAR(exact->resolution(), once, 1);
}

TEST(OctreeCloud, APointFarAwayLeavesTheOthersTheirCells) {
  const PaintedCloud cloud = painted(20000);
  for (const double far : {30.0, 1000.0, 20000.0}) {
    PaintedCloud more = cloud;
    more.add({far, 0, 0}, {0, 0, 1}, {1, 2, 3});
    const auto octree = OctreeCloud::build(more.view(), {0, 0, 50}, 2);
    ASSERT_TRUE(octree);
    EXPECT_GT(octree->numRoots(), 20000u / 50 / 2) << far;
    EXPECT_LT(octree->numRoots(), 20000u / 50 * 2) << far;
  }
}

TEST(OctreeCloud, FloatsAndIndicesGiveTheSameOrder) {
  const PaintedCloud cloud = painted(5000);
  std::vector<float> floats(cloud.points.begin(), cloud.points.end());
  std::vector<double> rounded(floats.begin(), floats.end());
  std::vector<std::int32_t> all(5000);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int32_t>(i);
  CloudView wide = cloud.view(), narrow = wide, indexed;
  wide.xyz = rounded.data();
  narrow.xyz = floats.data();
  narrow.xyz_stride = 3 * sizeof(float);
  narrow.scalar = CloudView::Scalar::kFloat;
  indexed = narrow;
  indexed.indices = all.data();
  indexed.num_indices = all.size();
  std::vector<float> padded(4 * 5000 - 1);  // four floats apart, the last of three
  for (std::size_t i = 0; i < 5000; ++i) std::copy_n(&floats[3 * i], 3, &padded[4 * i]);
  CloudView spaced = narrow;
  spaced.xyz = padded.data();
  spaced.xyz_stride = 4 * sizeof(float);
  const auto expected = OctreeCloud::build(wide, {0, 100}, 1);
  ASSERT_TRUE(expected);
  for (const CloudView& view : {narrow, indexed, spaced}) {
    const auto octree = OctreeCloud::build(view, {0, 100}, 3);
    ASSERT_TRUE(octree);
    ASSERT_EQ(octree->resolution(), expected->resolution());
    for (std::size_t i = 0; i < octree->size(); ++i) {
      ASSERT_EQ(octree->order(i), expected->order(i));
    }
  }
}

/** Points as their owner has them, and what a window makes of them. */
class Window : public testing::Test {
 protected:
  PaintedCloud cloud_ = painted(3000, 6.0);
  CloudView view_ = cloud_.view();
  ColorView colors_ = cloud_.colors();
  LabTable table_;
  Result<OctreeCloud> octree_ = OctreeCloud::build(view_, {10, 0}, 1);
  PointWindow window_;

  void load(std::size_t begin, std::size_t end) {
    window_.load(*octree_, {view_, colors_, table_}, begin, end);
  }
};

TEST_F(Window, HoldsWhatPointsAre) {
  cloud_.normals[3] = std::nanf("");
  for (std::size_t a = 0; a < 3; ++a) cloud_.normals[6 + a] *= 5.0f;
  load(100, 2900);
  for (std::size_t i = 100; i < 2900; ++i) {
    const std::size_t at = window_.order(i);
    ASSERT_EQ(at, octree_->order(i));
    float cells[3];
    octree_->frame().position(cloud_.points.data() + 3 * at, cells);
    const auto lab = labFromRgb({cloud_.bgr[3 * at + 2] / 255.0, cloud_.bgr[3 * at + 1] / 255.0,
                                 cloud_.bgr[3 * at] / 255.0});
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_EQ(window_.position(i)[a], cells[a]);
      ASSERT_NEAR(window_.lab(i)[a], lab[a], LabTable::kMaxDeltaE);
      const float unit = at == 1 ? 0.0f : cloud_.normals[3 * at + a] / (at == 2 ? 5.0f : 1.0f);
      ASSERT_NEAR(window_.normal(i)[a], unit, 1e-6f);
    }
  }
}

TEST_F(Window, WithoutNormalsAndColoursHoldsZeros) {
  view_.normal = nullptr;
  colors_ = {};
  load(0, 50);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(window_.normal(i), (std::array<float, 3>{}));
    EXPECT_EQ(window_.lab(i), (std::array<float, 3>{}));
  }
}

TEST_F(Window, SumsAreThoseOfItsPoints) {
  load(0, 3000);
  for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 16u, 19u, 2000u}) {
    for (const std::size_t begin : {0u, 7u}) {
      double count = 0, x = 0, pp = 0, uw = 0, ll = 0;
      for (std::size_t i = begin; i < begin + n; ++i) {
        const auto p = window_.position(i), u = window_.normal(i), l = window_.lab(i);
        count += 1;
        x += p[1];
        for (std::size_t a = 0; a < 3; ++a) pp += double(p[a]) * p[a];
        uw += double(u[0]) * u[2];
        for (std::size_t a = 0; a < 3; ++a) ll += double(l[a]) * l[a];
      }
      const CellSums sums = sumsOf(window_, begin, begin + n);
      EXPECT_EQ(sums.count, count);
      EXPECT_NEAR(sums.position[1], x, 1e-12 * count * 10);
      EXPECT_NEAR(sums.position_sq, pp, 1e-12 * count * 300);
      EXPECT_NEAR(sums.product[2], uw, 1e-12 * count);
      EXPECT_NEAR(sums.lab_sq, ll, 1e-12 * count * 1e4);
      EXPECT_NEAR(sums.normals(), count, 1e-6 * count);
    }
  }
}

}  // namespace
}  // namespace pcl_slim
