// SPDX-License-Identifier: BSD-3-Clause
// Levels of few cells by several threads. A cell waits for those of lower colours that it touches,
// and for no others. Where fewer cells are ready than there are threads, several fit balls of one
// cell: a ball's fit does not depend on what others have covered; only whether it is needed does.
// So fits are made before their turn, and kept in turn.
#include <condition_variable>
#include <list>
#include <mutex>

#include "cover/cover.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

// How many centres are fitted before their turn; no result depends on it.
constexpr std::size_t kPlaces = 8;     ///< of a cell that are apart from each other
constexpr std::size_t kCenters = 256;  ///< of a cell in all

}  // namespace

/** \brief The cells of a level and their centres, shared out among threads. */
class LevelCover::Sharing {
 public:
  Sharing(LevelCover& cover, int level, Output* outputs)
      : cover_(cover),
        level_(level),
        outputs_(outputs),
        waits_for_(cover.cells_.size(), 0),
        left_(cover.cells_.size()) {
    const double reach = cover.plan_.levelRadius(level);
    reach_sq_ = reach * reach;
    for (const std::uint32_t cell : cover.cells_.byColor()) {
      cover.cells_.forTouching(cell, [&](std::uint32_t other) {
        waits_for_[cell] += cover.cells_.colorOf(other) < cover.cells_.colorOf(cell);
      });
      if (waits_for_[cell] == 0) begin(cell);
    }
  }

  /** One thread's share. An exception of any thread ends the shares of all. */
  void work(int thread) {
    try {
      std::unique_lock<std::mutex> lock(mutex_);
      Nearby nearby{cover_.worker(thread).fitter.nearby()};
      while (left_ > 0 && !failed_) {
        if (!keepNext(thread, nearby, lock) && !fitNext(thread, nearby, lock)) changed_.wait(lock);
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failed_ = true;
      changed_.notify_all();
      throw;
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  enum class State : unsigned char { kWaiting, kRunning, kDone };
  struct Center {
    std::uint32_t point;
    std::array<double, 3> place;
    State state = State::kWaiting;
    BallOutcome outcome = BallOutcome::kUnsupported;
    SurfelRecord surfel;
  };
  /** A cell that waits for no other. */
  struct Cell {
    Cell(std::uint32_t n, const CellVisits& v) : number(n), visits(v) {}
    std::uint32_t number;
    CellVisits visits;
    std::list<Center> centers{};  ///< in turn
    bool seen_all = false;        ///< no centre is left to visit
    bool keeping = false;         ///< a thread covers or marks its points
    std::size_t running = 0;
    Output output{};
    std::vector<SurfelRecord> surfels{};
  };
  /** The blocks near the cell that a thread is at. */
  struct Nearby {
    NearbyBlocks& blocks;
    std::uint32_t of = kNone;
  };

  void begin(std::uint32_t cell) { ready_.push_back({cell, cover_.visitsOf(cover_.cells_[cell])}); }

  void collect(const Cell& cell, Nearby& nearby) const {
    if (nearby.of != cell.number)
      cover_.collectNearby(cover_.cells_[cell.number], level_, nearby.blocks);
    nearby.of = cell.number;
  }

  /** Keeps the next ball in turn of some cell, or ends a cell. \return false: there is none. */
  bool keepNext(int thread, Nearby& nearby, std::unique_lock<std::mutex>& lock) {
    for (auto cell = ready_.begin(); cell != ready_.end(); ++cell) {
      if (cell->keeping) continue;
      dropDone(*cell);
      if (cell->centers.empty()) {
        if (!cell->seen_all) continue;
        end(cell, thread);
        return true;
      }
      const Center& center = cell->centers.front();
      if (center.state != State::kDone) continue;
      cell->keeping = true;
      lock.unlock();
      collect(*cell, nearby);
      cover_.keep(center.point, center.outcome, center.surfel, nearby.blocks, cell->surfels,
                  cell->output);
      lock.lock();
      drop(*cell);
      cell->keeping = false;
      changed_.notify_all();
      return true;
    }
    return false;
  }

  /** Drops the first centres whose points others cover. */
  void dropDone(Cell& cell) {
    while (!cell.centers.empty() && cell.centers.front().state != State::kRunning &&
           cover_.isDone(cell.centers.front().point))
      drop(cell);
  }

  /** Drops the first centre; its memory is used again. */
  void drop(Cell& cell) { spare_.splice(spare_.end(), cell.centers, cell.centers.begin()); }

  /** Outputs the surfels of a finished cell and starts the cells that waited for it. */
  void end(std::list<Cell>::iterator cell, int thread) {
    auto& arena = cover_.worker(thread).arena;
    Output& output = outputs_[cell->number] = cell->output;
    output.thread = thread;
    output.begin = static_cast<std::uint32_t>(arena.size());
    output.end = output.begin + static_cast<std::uint32_t>(cell->surfels.size());
    arena.insert(arena.end(), cell->surfels.begin(), cell->surfels.end());
    const CoverCells& cells = cover_.cells_;
    cells.forTouching(cell->number, [&](std::uint32_t other) {
      if (cells.colorOf(other) > cells.colorOf(cell->number) && --waits_for_[other] == 0)
        begin(other);
    });
    ready_.erase(cell);
    --left_;
    changed_.notify_all();
  }

  /** Fits one centre: of a cell that no thread is at, or of one where centres are apart.
   * \return false: all that wait are likely to be covered by earlier ones. */
  bool fitNext(int thread, Nearby& nearby, std::unique_lock<std::mutex>& lock) {
    for (const bool alone : {true, false}) {
      for (Cell& cell : ready_) {
        if (cell.keeping || (cell.running == 0) != alone) continue;
        Center* const center = take(cell);
        if (center == nullptr && cell.centers.empty()) return true;  // to be ended
        if (center == nullptr) continue;
        center->state = State::kRunning;
        ++cell.running;
        lock.unlock();
        collect(cell, nearby);
        center->outcome = cover_.worker(thread).fitter.fit(center->point, level_, center->surfel);
        lock.lock();
        center->state = State::kDone;
        --cell.running;
        changed_.notify_all();
        return true;
      }
    }
    return false;
  }

  /** A centre that waits and that no earlier one is likely to cover, or none. */
  Center* take(Cell& cell) {
    const Center* apart[kPlaces];
    std::size_t places = 0, seen = 0;
    for (auto at = cell.centers.begin(); places < kPlaces && seen < kCenters; ++at, ++seen) {
      if (at == cell.centers.end()) {
        if (!addNext(cell)) return nullptr;
        at = std::prev(cell.centers.end());
      }
      const bool waits = at->state == State::kWaiting;
      if (waits && cover_.isDone(at->point)) continue;
      const auto near = [&](const Center* other) { return areNear(*other, *at); };
      if (std::any_of(apart, apart + places, near)) continue;
      if (waits) return &*at;
      apart[places++] = &*at;
    }
    return nullptr;
  }

  bool areNear(const Center& a, const Center& b) const {
    double distance_sq = 0;
    for (std::size_t k = 0; k < 3; ++k)
      distance_sq += (a.place[k] - b.place[k]) * (a.place[k] - b.place[k]);
    return distance_sq < reach_sq_;
  }

  /** Lets the next centre of a cell wait. \return false: there is none. */
  bool addNext(Cell& cell) {
    std::uint32_t point;
    const auto is_done = [this](std::uint32_t p) { return cover_.isDone(p); };
    if (cell.seen_all || !cell.visits.next(is_done, point)) {
      cell.seen_all = true;
      return false;
    }
    if (spare_.empty()) spare_.emplace_back();
    Center& center = spare_.front();
    center.point = point;
    center.place = cover_.store_.position(point);
    center.state = State::kWaiting;
    cell.centers.splice(cell.centers.end(), spare_, spare_.begin());
    return true;
  }

  LevelCover& cover_;
  int level_;
  double reach_sq_;
  Output* outputs_;
  std::mutex mutex_;
  std::condition_variable changed_;       ///< a fit is done, kept, or a cell is
  std::vector<std::uint32_t> waits_for_;  ///< cells of lower colours that each cell waits for
  std::list<Cell> ready_;
  std::list<Center> spare_;
  std::size_t left_;  ///< cells that have not ended
  bool failed_ = false;
};

void LevelCover::shareCells(int level, std::size_t first_output) {
  Sharing sharing(*this, level, outputs_.data() + first_output);
  const auto workers = static_cast<std::size_t>(threads_);
  parallelFor(workers, threads_, 1, [&](std::size_t, int thread) { sharing.work(thread); });
}

}  // namespace pcl_slim::detail
