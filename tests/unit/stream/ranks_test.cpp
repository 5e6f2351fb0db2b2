// SPDX-License-Identifier: BSD-3-Clause
// Fits by tiles on ranks that are threads of this process: every step of them but MPI's own.
#include "pcl_slim/stream/ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "pcl_slim/stream/record_source.h"
#include "pcl_slim/stream/stream_fit.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"
#include "support/temporary_folder.h"
#include "unit/stream/small_tiles.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** Where threads put messages for each other. */
class Board {
 public:
  explicit Board(std::size_t ranks) : ranks_(ranks), letters_(ranks) {}

  void swap(std::size_t rank, std::vector<Ranks::Bytes>& messages) {
    letters_[rank] = messages;
    wait();
    for (std::size_t r = 0; r < ranks_; ++r) messages[r] = letters_[r][rank];
    wait();
  }

 private:
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    const std::size_t turn = turn_;
    if (++here_ == ranks_) {
      here_ = 0;
      ++turn_;
      all_.notify_all();
    }
    all_.wait(lock, [&] { return turn_ != turn; });
  }

  std::size_t ranks_, here_ = 0, turn_ = 0;
  std::mutex mutex_;
  std::condition_variable all_;
  std::vector<std::vector<Ranks::Bytes>> letters_;
};

class ThreadRanks : public Ranks {
 public:
  ThreadRanks(Board& board, std::size_t rank, std::size_t size)
      : board_(board), rank_(rank), size_(size) {}
  int rank() const override { return static_cast<int>(rank_); }
  int size() const override { return static_cast<int>(size_); }

 protected:
  void swap(std::vector<Bytes>& messages) override { board_.swap(rank_, messages); }

 private:
  Board& board_;
  std::size_t rank_, size_;
};

/** What a fit on ranks made and sent. */
struct Made {
  std::vector<unsigned char> bytes;
  StreamStatistics statistics;
  std::vector<std::uint64_t> sent, halo_sent;
  std::vector<std::size_t> tiles;  ///< in the order of the sink
};

void fitShare(PointSource& source, ThreadRanks& ranks, int at_once, Made& made) {
  StreamParams params = smallTiles();
  params.ranks = &ranks;
  StreamFit fit(params);
  Error error = fit.prepare(source);
  ASSERT_FALSE(error) << error.message;
  std::vector<std::size_t> all(fit.plan().tiles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  SLIMSurface surface = fit.coarse();
  error = fit.fit(all, at_once, [&](std::size_t t, const SLIMSurface& tile) {
    made.tiles.push_back(t);
    surface.append(tile);
    return Error();
  });
  ASSERT_FALSE(error) << error.message;
  const auto rank = static_cast<std::size_t>(ranks.rank());
  made.sent[rank] = ranks.bytesSent();
  made.halo_sent[rank] = fit.statistics().halo_sent;
  if (rank != 0) return;
  surface.buildLinks(1);
  orientSurfels(fit.frame(), params.fit, surface);
  made.bytes = encodeSlim(surface);
  made.statistics = fit.statistics();
}

/** Fits on so many ranks. \param[in] sourceOf the share of a rank */
template <typename SourceOf>
Made fitOnRanks(std::size_t ranks, int at_once, const SourceOf& sourceOf) {
  Made made;
  made.sent.resize(ranks);
  made.halo_sent.resize(ranks);
  Board board(ranks);
  std::vector<std::thread> threads;
  for (std::size_t r = 0; r < ranks; ++r) {
    threads.emplace_back([&, r] {
      ThreadRanks own(board, r, ranks);
      auto source = sourceOf(r);
      fitShare(source, own, at_once, made);
    });
  }
  for (std::thread& thread : threads) thread.join();
  return made;
}

/** The rows of a cloud that are a rank's share: any division will do. */
CloudView shareOf(const Cloud& cloud, std::vector<std::int32_t>& rows, std::size_t rank,
                  std::size_t ranks) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i * ranks / cloud.size() == rank) rows.push_back(static_cast<std::int32_t>(i));
  }
  CloudView view = cloud.view();
  view.indices = rows.data();
  view.num_indices = rows.size();
  return view;
}

Made fitOnRanks(const Cloud& cloud, std::size_t ranks, int at_once = 1) {
  std::vector<std::vector<std::int32_t>> rows(ranks);
  return fitOnRanks(ranks, at_once,
                    [&](std::size_t r) { return CloudSource(shareOf(cloud, rows[r], r, ranks)); });
}

std::vector<unsigned char> fitAlone(const Cloud& cloud, StreamStatistics& statistics) {
  CloudSource source(cloud.view());
  SLIMSurface surface;
  const Error error = fitTiles(source, smallTiles(), surface, &statistics);
  EXPECT_FALSE(error) << error.message;
  return encodeSlim(surface);
}

TEST(Ranks, GiveTheBytesAndTheStatisticsOfOneProcess) {
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 150000, 0.004).withoutNormals();
  StreamStatistics alone;
  const std::vector<unsigned char> bytes = fitAlone(cloud, alone);
  for (const std::size_t ranks : {1u, 2u, 3u, 5u}) {
    const Made made = fitOnRanks(cloud, ranks, ranks == 2 ? 2 : 1);
    EXPECT_EQ(made.bytes, bytes) << ranks << " ranks";
    EXPECT_EQ(made.statistics.fit.points, alone.fit.points);
    EXPECT_EQ(made.statistics.fit.leaves, alone.fit.leaves);
    EXPECT_EQ(made.statistics.fit.rms_error, alone.fit.rms_error);
    EXPECT_EQ(made.statistics.halo_points, alone.halo_points);
    EXPECT_EQ(made.statistics.points.input_points, cloud.size());
    EXPECT_TRUE(std::is_sorted(made.tiles.begin(), made.tiles.end()));
  }
}

TEST(Ranks, MoreThanTilesLeaveSomeWithoutWork) {
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 30000, 0.004).withoutNormals();
  StreamStatistics alone;
  const std::vector<unsigned char> bytes = fitAlone(cloud, alone);
  ASSERT_LT(alone.tiles, 6u);
  EXPECT_EQ(fitOnRanks(cloud, 6).bytes, bytes);
}

TEST(Ranks, SendEachPointOnceAndItsHalo) {
  // Doubles: 24 bytes a point, of which all but a rank's own share travel.
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 150000, 0.004).withoutNormals();
  const Made made = fitOnRanks(cloud, 3);
  const auto sum = [](const std::vector<std::uint64_t>& v) {
    return std::accumulate(v.begin(), v.end(), std::uint64_t{0});
  };
  EXPECT_GT(sum(made.halo_sent), 24 * made.statistics.halo_points / 20);
  EXPECT_LT(sum(made.halo_sent), 24 * 2 * made.statistics.halo_points);
  // Points, the two samples of a cloud that is smaller than them, counts of cells, fitted tiles.
  const std::uint64_t points = 24 * cloud.size();
  EXPECT_LT(sum(made.sent) - sum(made.halo_sent), 4 * points + 3 * made.bytes.size());
}

TEST(Ranks, CountPointsThatAreNoneOnEveryRank) {
  Cloud cloud = sceneCloud(measure::Shape::kTorus, 60000, 0.004).withoutNormals();
  for (int i = 0; i < 10; ++i) cloud.add(std::nan(""), 0, 0);
  cloud.add(1e9, 0, 0);  // a stray: one more pass on every rank
  StreamStatistics alone;
  const std::vector<unsigned char> bytes = fitAlone(cloud, alone);
  const Made made = fitOnRanks(cloud, 2);
  EXPECT_EQ(made.bytes, bytes);
  EXPECT_EQ(made.statistics.points.non_finite, 10u);
  EXPECT_EQ(made.statistics.points.far_away, alone.points.far_away);
  EXPECT_EQ(made.statistics.passes, alone.passes);
}

TEST(Ranks, ReadSharesOfAFile) {
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 60001, 0.004).withoutNormals();
  const TemporaryFolder folder;
  RecordLayout binary, text;
  binary.path = folder / "points.f64";
  binary.count = text.count = cloud.size();
  binary.step = 24;
  text.path = folder / "points.txt";
  text.step = 3;
  text.text = true;
  for (std::size_t a = 0; a < 3; ++a) {
    binary.position[a] = {8 * a, kFloat64};
    text.position[a] = {a, kFloat64};
  }
  std::ofstream(binary.path, std::ios::binary)
      .write(reinterpret_cast<const char*>(cloud.points.data()),
             static_cast<std::streamsize>(24 * cloud.size()));
  {
    std::ofstream out(text.path);
    out.precision(17);
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      out << cloud.points[i] << (i % 3 == 2 ? '\n' : ' ');
  }
  StreamStatistics alone;
  const std::vector<unsigned char> bytes = fitAlone(cloud, alone);
  for (const RecordLayout& layout : {binary, text}) {
    const Made made = fitOnRanks(4, 1, [&](std::size_t r) { return RecordSource(layout, r, 4); });
    EXPECT_EQ(made.bytes, bytes) << layout.path;
    EXPECT_EQ(made.statistics.points.input_points, cloud.size());
  }
}

TEST(Ranks, KeepNoPlan) {
  Board board(1);
  ThreadRanks two(board, 0, 2);
  StreamParams params = smallTiles();
  params.ranks = &two;
  params.state = "somewhere";
  EXPECT_EQ(params.validate().code, ErrorCode::kBadArgument);
}

}  // namespace
