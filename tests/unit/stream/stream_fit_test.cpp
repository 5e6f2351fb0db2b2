// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/stream/stream_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"
#include "support/temporary_folder.h"
#include "unit/stream/small_tiles.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

constexpr measure::Shape kShape = measure::Shape::kTorus;

Cloud torus(std::size_t count = 200000, double noise = 0.004) {
  return sceneCloud(kShape, count, noise).withoutNormals();
}

SLIMSurface byTiles(const Cloud& cloud, const StreamParams& params,
                    StreamStatistics* statistics = nullptr) {
  CloudSource source(cloud.view());
  SLIMSurface surface;
  const Error error = fitTiles(source, params, surface, statistics);
  EXPECT_FALSE(error) << error.message;
  return surface;
}

Errors errorsBy(const Cloud& cloud, const SLIMSurface& surface) {
  Fitted f;
  f.store = storeOf(cloud);
  f.surface = surface;
  ProjectionParams projection;
  const Error error = projectPoints(f.store, f.surface, projection, f.projection);
  EXPECT_FALSE(error) << error.message;
  return errorsOf(kShape, f);
}

TEST(StreamFit, IsAsNearToTheTruthAsAFitInMemory) {
  const Cloud cloud = torus();
  StreamStatistics statistics;
  const SLIMSurface tiled = byTiles(cloud, smallTiles(), &statistics);
  const Fitted whole = fitted(cloud);
  EXPECT_GE(statistics.tiles, 10u);
  EXPECT_EQ(statistics.fit.points, cloud.size());
  EXPECT_EQ(statistics.fit.uncovered, 0u);
  EXPECT_EQ(statistics.fit.leaves, tiled.numLeaves());
  EXPECT_FALSE(tiled.validate());
  const Errors by_tiles = errorsBy(cloud, tiled), in_memory = errorsOf(kShape, whole);
  // Balls begin with a 50th of a tile, 400 points: leaves are narrower than a smooth body allows.
  EXPECT_LT(by_tiles.position, 1.5 * in_memory.position);
  EXPECT_LT(by_tiles.normal, 1.5 * in_memory.normal);
  EXPECT_LT(by_tiles.position, 0.25 * 0.004);
}

TEST(StreamFit, MeasuresTheNoiseOfTheWholeCloud) {
  const Cloud cloud = torus();
  StreamStatistics statistics;
  byTiles(cloud, smallTiles(), &statistics);
  EXPECT_NEAR(statistics.fit.lambda, fitted(cloud).statistics.lambda, 0.02 * statistics.fit.lambda);
}

TEST(StreamFit, ADenseClumpMakesNoOutliersOfThePointsAboutIt) {
  // In its tile a clump has most points: their spacing is not the cloud's.
  Cloud cloud = torus(100000);
  std::mt19937 random(3);
  std::normal_distribution<double> off(0.0, 0.004);
  const std::size_t whole = cloud.size();
  for (int i = 0; i < 15000; ++i)
    cloud.add(cloud.points[0] + off(random), cloud.points[1] + off(random),
              cloud.points[2] + off(random));
  StreamStatistics statistics;
  byTiles(cloud, smallTiles(), &statistics);
  EXPECT_LE(statistics.fit.outliers, whole / 1000);
  EXPECT_EQ(statistics.points.duplicates, 0u);
  EXPECT_EQ(statistics.fit.points + statistics.fit.outliers, cloud.size());
}

TEST(StreamFit, CountsTheMemoryOfBallsAsWideAsNoiseAsks) {
  // Balls of 32 sigma contain a good part of such a tile: each thread has one in memory.
  const Cloud cloud = torus(200000, 0.01);
  CloudSource source(cloud.view());
  StreamFit fit(smallTiles());
  ASSERT_FALSE(fit.prepare(source));
  std::uint64_t loaded = 0;
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t)
    loaded = std::max(loaded, fit.loadedPoints(t));
  EXPECT_GE(fit.workingBytes(), 52 * loaded);
  const std::uint64_t of_thread = (fit.workingBytes(101) - fit.workingBytes(1)) / 100;
  EXPECT_GT(of_thread, 36 * smallTiles().tile_points / 8);
}

TEST(StreamFit, GivesTheSameBytesForAnyThreads) {
  const Cloud cloud = torus(100000);
  EXPECT_EQ(encodeSlim(byTiles(cloud, smallTiles(1))), encodeSlim(byTiles(cloud, smallTiles(3))));
}

TEST(StreamFit, GivesTheSameBytesForAnyOrderOfPoints) {
  const Cloud cloud = torus(100000);
  std::vector<std::int32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(9));
  CloudView view = cloud.view();
  view.indices = order.data();
  view.num_indices = order.size();
  CloudSource source(view);
  SLIMSurface shuffled;
  ASSERT_FALSE(fitTiles(source, smallTiles(), shuffled));
  EXPECT_EQ(encodeSlim(shuffled), encodeSlim(byTiles(cloud, smallTiles())));
}

TEST(StreamFit, GivesTheSameBytesForAnyOrderOfTiles) {
  const Cloud cloud = torus(100000);
  CloudSource source(cloud.view());
  StreamFit fit(smallTiles());
  ASSERT_FALSE(fit.prepare(source));
  const std::size_t tiles = fit.plan().tiles.size();
  std::vector<std::vector<unsigned char>> forward(tiles);
  SLIMSurface surface;
  for (std::size_t t = 0; t < tiles; ++t) {
    ASSERT_FALSE(fit.fit(t, surface));
    forward[t] = encodeSlim(surface);
  }
  for (std::size_t t = tiles; t-- > 0;) {
    ASSERT_FALSE(fit.fit(t, surface));
    EXPECT_EQ(encodeSlim(surface), forward[t]);
  }
}

TEST(StreamFit, TilesFittedAtOnceComeInOrderAndAreTheSame) {
  const Cloud cloud = torus(100000);
  CloudSource source(cloud.view());
  StreamParams params = smallTiles(3);
  params.fit.orient = false;
  StreamFit fit(params);
  ASSERT_FALSE(fit.prepare(source));
  std::vector<std::size_t> tiles(fit.plan().tiles.size());
  std::iota(tiles.begin(), tiles.end(), 0);
  std::vector<std::size_t> order;
  SLIMSurface all = fit.coarse();
  const auto take = [&](std::size_t tile, const SLIMSurface& surface) {
    order.push_back(tile);
    all.append(surface);
    return Error();
  };
  ASSERT_FALSE(fit.fit(tiles, 3, take));
  EXPECT_EQ(order, tiles);
  StreamStatistics alone;
  EXPECT_EQ(encodeSlim(all), encodeSlim(byTiles(cloud, params, &alone)));
  EXPECT_EQ(fit.statistics().fit.leaves, alone.fit.leaves);
  EXPECT_EQ(fit.statistics().halo_points, alone.halo_points);
  EXPECT_EQ(fit.statistics().fit.rms_error, alone.fit.rms_error);

  const auto full = [&](std::size_t tile, const SLIMSurface&) {
    return tile == 2 ? Error{ErrorCode::kIo, "the disk is full"} : Error();
  };
  EXPECT_EQ(fit.fit(tiles, 2, full).code, ErrorCode::kIo);
  Progress stopped;
  stopped.cancel();
  EXPECT_EQ(fit.fit(tiles, 2, take, &stopped).code, ErrorCode::kCancelled);
}

TEST(StreamFit, HasTheLevelsAboveTheTilesOnceOnly) {
  const Cloud cloud = torus(100000);
  CloudSource source(cloud.view());
  StreamFit fit(smallTiles());
  ASSERT_FALSE(fit.prepare(source));
  const SLIMSurface& coarse = fit.coarse();
  ASSERT_GT(coarse.size(), 10u);
  EXPECT_EQ(coarse.numLeaves(), 0u);
  EXPECT_FALSE(coarse.validate());
  int last = 0;
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t)
    last = std::max(last, fit.firstLevel(t));
  for (const std::uint8_t level : coarse.level) EXPECT_LT(level, last);
  EXPECT_EQ(coarse.info.num_points, cloud.size());
}

TEST(StreamFit, UsesNormals) {
  const Cloud cloud = sceneCloud(kShape, 100000, 0.004);
  ASSERT_FALSE(cloud.normals.empty());
  StreamParams params = smallTiles();
  params.tile_points = 40000;
  const SLIMSurface surface = byTiles(cloud, params);
  EXPECT_TRUE(surface.info.oriented);
  EXPECT_LT(errorsBy(cloud, surface).position, 1.8 * errorsOf(kShape, fitted(cloud)).position);
}

TEST(StreamFit, AClosedBodyIsNotOpenedAtTheBordersOfTiles) {
  const Cloud cloud = torus(200000, 0.0);
  StreamStatistics statistics;
  byTiles(cloud, smallTiles(), &statistics);
  EXPECT_GT(statistics.fit.leaves, 10000u);
  EXPECT_LT(statistics.fit.open_leaves, statistics.fit.leaves / 5000);
}

TEST(StreamFit, NoiseInTheCloudsUnitIsItsLambda) {
  Cloud cloud = torus(40000);
  const double origin[] = {432100.5, 5412345.25, -310};
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.points[i] = 1000 * cloud.points[i] + origin[i % 3];
  StreamParams in_unit = smallTiles(), as_share = smallTiles();
  in_unit.fit.noise = 6;
  const PointStore store = storeOf(cloud);
  const double share = 6 / (store.diagonal() * store.scale());
  as_share.fit.lambda = share * share;
  StreamStatistics statistics, expected;
  EXPECT_EQ(encodeSlim(byTiles(cloud, in_unit, &statistics)),
            encodeSlim(byTiles(cloud, as_share, &expected)));
  EXPECT_GE(statistics.tiles, 2u);
  EXPECT_EQ(statistics.fit.lambda, expected.fit.lambda);
  EXPECT_NEAR(statistics.fit.lambda, share * share, 1e-9 * share * share);

  in_unit.fit.noise = 1e6;
  CloudSource source(cloud.view());
  SLIMSurface surface;
  EXPECT_EQ(fitTiles(source, in_unit, surface).code, ErrorCode::kBadArgument);
}

TEST(StreamFit, RefusesWhatTilesCannotDo) {
  const Cloud cloud = torus(30000);
  CloudSource source(cloud.view());
  const auto refused = [&](const StreamParams& params, const std::string& word) {
    SLIMSurface surface;
    const Error error = fitTiles(source, params, surface);
    EXPECT_EQ(error.code, ErrorCode::kBadArgument);
    EXPECT_NE(error.message.find(word), std::string::npos) << error.message;
    EXPECT_TRUE(surface.empty());
  };
  StreamParams params = smallTiles();
  params.fit.paper_mode = true;
  refused(params, "by tiles");
  params = smallTiles();
  params.fit.size = TargetError{0.01};
  refused(params, "by tiles");
  params.fit.size = TargetDistance{0.01};
  refused(params, "by tiles");
  params = smallTiles();
  params.fit.size = MaxSurfels{100};
  refused(params, "by tiles");
  params = smallTiles();
  params.tile_points = 5;
  refused(params, "10000 or more");
  params = smallTiles();
  params.scratch = "/no/such/folder";
  SLIMSurface surface;
  EXPECT_EQ(fitTiles(source, params, surface).code, ErrorCode::kIo);
  const std::vector<std::uint32_t> frames(cloud.size(), 3);
  CloudView view = cloud.view();
  view.frame_numbers = frames.data();
  CloudSource numbered(view);
  EXPECT_EQ(fitTiles(numbered, smallTiles(), surface).code, ErrorCode::kBadArgument);
}

TEST(StreamFit, SurvivesCloudsWithoutASurface) {
  Cloud cloud;
  SLIMSurface surface;
  CloudSource none(cloud.view());
  EXPECT_EQ(fitTiles(none, smallTiles(), surface).code, ErrorCode::kBadInput);
  for (int i = 0; i < 500; ++i) cloud.add(1, 2, 3);
  CloudSource same(cloud.view());
  EXPECT_EQ(fitTiles(same, smallTiles(), surface).code, ErrorCode::kNoSurface);
  cloud.points.clear();
  for (int i = 0; i < 500; ++i) cloud.add(i, 0, 0);
  CloudSource line(cloud.view());
  EXPECT_EQ(fitTiles(line, smallTiles(), surface).code, ErrorCode::kNoSurface);
  EXPECT_TRUE(surface.empty());
}

TEST(StreamFit, CanBeCancelled) {
  const Cloud cloud = torus(100000);
  CloudSource source(cloud.view());
  for (const float from : {0.0f, 0.05f, 0.5f}) {
    SLIMSurface surface;
    Progress* running = nullptr;
    Progress progress([&](float fraction, const char*) {
      if (fraction >= from) running->cancel();
    });
    running = &progress;
    EXPECT_EQ(fitTiles(source, smallTiles(), surface, nullptr, &progress).code,
              ErrorCode::kCancelled);
  }
}

TEST(StreamFit, GoesOnWithWhatAnEarlierRunHasKept) {
  const TemporaryFolder folder;
  const Cloud cloud = torus(100000);
  StreamParams params = smallTiles();
  const auto bytes = encodeSlim(byTiles(cloud, params));
  params.state = folder / ".";
  {
    CloudSource source(cloud.view());
    StreamFit fit(params);
    ASSERT_FALSE(fit.prepare(source));
    SLIMSurface tile;
    for (const std::size_t t : {3, 1}) ASSERT_FALSE(fit.fit(t, tile));
  }
  StreamStatistics statistics;
  EXPECT_EQ(encodeSlim(byTiles(cloud, params, &statistics)), bytes);
  EXPECT_EQ(statistics.kept_tiles, 2u);
  EXPECT_EQ(statistics.passes, 0u);
  EXPECT_EQ(statistics.fit.points, cloud.size());
  // A damaged tile is fitted again, and so is everything of another parameter.
  auto damaged = fileBytes(folder / "tile-1");
  damaged[damaged.size() / 2] ^= 1;
  writeBytes(folder / "tile-1", damaged);
  EXPECT_EQ(encodeSlim(byTiles(cloud, params, &statistics)), bytes);
  EXPECT_EQ(statistics.kept_tiles, statistics.tiles - 1);
  params.fit.degree = 2;
  byTiles(cloud, params, &statistics);
  EXPECT_EQ(statistics.kept_tiles, 0u);
}

/** A source that gives other points when it is read again. */
class ChangingSource : public CloudSource {
 public:
  ChangingSource(const CloudView& first, const CloudView& later, int from)
      : CloudSource(first), later_(later), from_(from) {}
  Error pass(const Visit& visit) override {
    return ++passes_ < from_ ? CloudSource::pass(visit) : later_.pass(visit);
  }

 private:
  CloudSource later_;
  int from_, passes_ = 0;
};

TEST(StreamFit, NoticesThatPointsChangeWhileTheyAreRead) {
  const Cloud cloud = torus(50000);
  Cloud fewer = cloud, other = cloud;
  fewer.points.resize(3 * 40000);
  for (double& coordinate : other.points) coordinate = -coordinate;
  for (const Cloud* later : {&fewer, &other}) {
    StreamStatistics statistics;
    byTiles(cloud, smallTiles(), &statistics);
    ChangingSource source(cloud.view(), later->view(), static_cast<int>(statistics.passes));
    SLIMSurface surface;
    const Error error = fitTiles(source, smallTiles(), surface);
    EXPECT_EQ(error.code, ErrorCode::kBadInput);
    EXPECT_NE(error.message.find("changed"), std::string::npos) << error.message;
  }
}

}  // namespace
