// SPDX-License-Identifier: BSD-3-Clause
// The messages between ranks of a fit by tiles: cells, points, halos, fitted tiles.
#include <algorithm>
#include <limits>
#include <utility>

#include "pcl_slim/core/stopwatch.h"
#include "stream_state.h"

namespace pcl_slim {

void Ranks::exchange(std::vector<Bytes>& messages) {
  const Stopwatch watch;
  for (std::size_t r = 0; r < messages.size(); ++r)
    sent_ += r == static_cast<std::size_t>(rank()) ? 0 : messages[r].size();
  swap(messages);
  seconds_ += watch.seconds();
}

namespace detail {

std::vector<Ranks::Bytes> fromAll(Ranks& ranks, const Ranks::Bytes& own) {
  std::vector<Ranks::Bytes> messages(static_cast<std::size_t>(ranks.size()), own);
  ranks.exchange(messages);
  return messages;
}

void gather(Ranks& ranks, Ranks::Bytes& bytes) {
  std::vector<Ranks::Bytes> messages = emptyMessages(ranks);
  messages[0].swap(bytes);
  ranks.exchange(messages);
  if (ranks.rank() != 0) return;
  bytes.swap(messages[0]);
  for (std::size_t r = 1; r < messages.size(); ++r)
    bytes.insert(bytes.end(), messages[r].begin(), messages[r].end());
}

bool Rounds::exchange(bool more, Ranks::Bytes& received) {
  for (Ranks::Bytes& message : messages_) message.push_back(more ? 1 : 0);
  ranks_.exchange(messages_);
  received.clear();
  bool any = false;
  for (Ranks::Bytes& message : messages_) {
    any = any || message.back() != 0;
    received.insert(received.end(), message.begin(), message.end() - 1);
    message.clear();
  }
  return any;
}

}  // namespace detail

using namespace detail;

namespace {

constexpr int kSummedDepth = 5;  ///< cells of one cell of this depth are summed by one rank

bool byKey(const TilePlan::Cell& a, const TilePlan::Cell& b) {
  return a.first_key < b.first_key;
}

/** Sums the points of cells that are there more than once. */
void joinCells(std::vector<TilePlan::Cell>& cells) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  std::sort(cells.begin(), cells.end(), byKey);
  std::size_t kept = 0;
  for (const TilePlan::Cell& cell : cells) {
    if (kept > 0 && cells[kept - 1].first_key == cell.first_key) {
      const std::uint64_t sum = std::uint64_t{cells[kept - 1].points} + cell.points;
      cells[kept - 1].points = static_cast<std::uint32_t>(std::min(sum, kMost));
    } else {
      cells[kept++] = cell;
    }
  }
  cells.resize(kept);
}

}  // namespace

/** Gives each rank the counts of all for the cells that were counted last: each sums a share of the
 * cells, and sends the sums to all. */
Error detail::StreamState::sumCells() {
  std::vector<Ranks::Bytes> messages = emptyMessages(ranks());
  for (const TilePlan::Cell& cell : counts.cells()) {
    if (static_cast<int>(cell.depth) != counts.depth()) continue;
    appendBytes(cell, messages[cellOf(cell.first_key, kSummedDepth) % messages.size()]);
  }
  ranks().exchange(messages);
  std::vector<TilePlan::Cell> share;
  for (const Ranks::Bytes& message : messages) {
    const auto cells = valuesOf<TilePlan::Cell>(message);
    share.insert(share.end(), cells.begin(), cells.end());
  }
  joinCells(share);
  return counts.replace(allOf(ranks(), share));
}

/** Divides the tiles among the ranks: runs of about as many points. */
void detail::StreamState::shareTiles() {
  const auto shares = static_cast<std::size_t>(ranks().size());
  first_tiles.assign(shares + 1, plan.tiles.size());
  std::size_t rank = 0;
  double before = 0;  // points
  for (std::size_t t = 0; t < plan.tiles.size(); ++t) {
    const double middle = before + 0.5 * static_cast<double>(plan.tiles[t].points);
    const double place = middle * static_cast<double>(shares) / static_cast<double>(plan.points);
    for (; rank < shares && static_cast<double>(rank) <= place; ++rank) first_tiles[rank] = t;
    before += static_cast<double>(plan.tiles[t].points);
  }
}

/** The rank whose tiles contain a point. */
std::size_t detail::StreamState::ownerOf(std::uint64_t key) const {
  const auto begins = [&](std::uint64_t k, std::size_t tile) {
    return tile >= plan.tiles.size() || k < plan.tiles[tile].first_key;
  };
  const auto after = std::upper_bound(first_tiles.begin(), first_tiles.end(), key, begins);
  return static_cast<std::size_t>(after - first_tiles.begin()) - 1;
}

Error detail::StreamState::takePoints(TileStore& into, const Ranks::Bytes& records,
                                      PointKeys& keys) const {
  const CloudView view = into.record().view(records);
  return into.add(view, keys.of(view).data(), counts);
}

/** Reads this rank's share of the points and sends them to their owners, a piece a round. */
Error detail::StreamState::sendPoints(PointSource& source, Progress* progress) {
  const PointRecord& record = store.record();
  PointKeys keys(frame, threads), keys_of_received(frame, threads);
  Rounds rounds(ranks());
  Ranks::Bytes received;
  const auto send = [&](const CloudView& piece) {
    const AlignedVector<std::uint64_t>& codes = keys.of(piece);
    for (std::size_t i = 0; i < piece.count(); ++i) {
      if (codes[i] == PointKeys::kLeftOut) continue;
      Ranks::Bytes& to = rounds.to(ownerOf(codes[i]));
      to.resize(to.size() + record.bytes());
      record.write(piece, i, to.data() + to.size() - record.bytes());
    }
    rounds.exchange(true, received);
    return takePoints(store, received, keys_of_received);
  };
  if (Error error = pass(source, progress, 0.06f, 0.12f, "sorting", send)) return error;
  while (rounds.exchange(false, received)) {
    if (Error error = takePoints(store, received, keys_of_received)) return error;
  }
  return {};
}

/** Brings the points of other ranks' cells that are wanted into a store of their own. */
Error detail::StreamState::fetchHalo(const std::vector<char>& wanted) {
  std::vector<Ranks::Bytes> messages = emptyMessages(ranks());
  std::vector<std::uint32_t> points(plan.cells.size(), 0);
  for (std::uint64_t c = 0; c < wanted.size(); ++c) {
    const std::size_t owner = ownerOf(plan.cells[c].first_key);
    if (wanted[c] == 0 || owner == static_cast<std::size_t>(ranks().rank())) continue;
    points[c] = plan.cells[c].points;
    appendBytes(c, messages[owner]);
  }
  ranks().exchange(messages);
  std::vector<std::vector<std::uint64_t>> asked;
  asked.reserve(messages.size());
  for (const Ranks::Bytes& message : messages) asked.push_back(valuesOf<std::uint64_t>(message));
  if (Error error = halo.create(plan, points, store.record(), params.scratch, false)) return error;
  const std::uint64_t before = ranks().bytesSent();
  if (Error error = sendHalo(asked)) return error;
  stats.halo_sent = ranks().bytesSent() - before;
  return halo.finish();
}

/** Sends ranks the points of their requested cells, ascending, and receives those of its own: a
 * bucket a round. */
Error detail::StreamState::sendHalo(const std::vector<std::vector<std::uint64_t>>& asked) {
  const std::size_t step = store.record().bytes();
  PointKeys keys(frame, threads), keys_of_received(frame, threads);
  Rounds rounds(ranks());
  Ranks::Bytes received;
  std::vector<unsigned char> records;
  for (const Bucket& bucket : store.buckets()) {
    std::vector<std::vector<std::size_t>> takers(bucket.end_cell - bucket.first_cell);
    bool any = false;
    for (std::size_t r = 0; r < asked.size(); ++r) {
      auto cell = std::lower_bound(asked[r].begin(), asked[r].end(), bucket.first_cell);
      for (; cell != asked[r].end() && *cell < bucket.end_cell; ++cell, any = true)
        takers[*cell - bucket.first_cell].push_back(r);
    }
    if (!any) continue;
    records.clear();
    if (Error error = store.read(bucket, records)) return error;
    const CloudView view = store.record().view(records);
    const AlignedVector<std::uint64_t>& codes = keys.of(view);
    for (std::size_t i = 0; i < view.count(); ++i) {
      const auto from = records.begin() + static_cast<std::ptrdiff_t>(i * step);
      for (const std::size_t r : takers[counts.numberOf(codes[i]) - bucket.first_cell])
        rounds.to(r).insert(rounds.to(r).end(), from, from + static_cast<std::ptrdiff_t>(step));
    }
    rounds.exchange(true, received);
    if (Error error = takePoints(halo, received, keys_of_received)) return error;
  }
  while (rounds.exchange(false, received)) {
    if (Error error = takePoints(halo, received, keys_of_received)) return error;
  }
  return {};
}

/** Brings the tiles of other ranks to rank 0's sink, one after another. */
Error detail::StreamState::gatherTiles(const std::vector<std::size_t>& tiles,
                                       const StreamFit::Sink& sink) {
  for (const std::size_t t : tiles) {
    const std::size_t owner = ownerOf(plan.tiles[t].first_key);
    if (owner == 0) continue;
    Ranks::Bytes bytes;
    if (owns(t)) {
      if (Error error = fitted.read(t, bytes)) return error;
    }
    gather(ranks(), bytes);
    if (ranks().rank() != 0) continue;
    FittedTile made;
    if (Error error = unpackTile(bytes, made)) return error;
    addTile(t, made);
    if (Error error = sink(t, made.surface)) return error;
  }
  return {};
}

}  // namespace pcl_slim
