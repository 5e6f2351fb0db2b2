// SPDX-License-Identifier: BSD-3-Clause
// Coarse levels by several threads: their few balls nearly all touch each other, so there is no
// order in which two can be kept at once. But what a ball's fit is does not depend on what others
// have served; only whether it is wanted does. So fits are made speculatively, before their turn.
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>

#include "cover/level_cover.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

/// Centres per thread that are looked at before their turn; no result depends on it.
constexpr std::size_t kWindow = 8;

}  // namespace

/** \brief The centres of a level in their order: fitted before their turn where earlier balls are
 * not likely to serve them, and kept in turn if they are still wanted then. */
class LevelCover::Speculation {
 public:
  Speculation(LevelCover& cover, int level, Output* outputs)
      : cover_(cover), level_(level), reach_(cover.settings_.levelRadius(level)), outputs_(outputs)
  {
  }

  /** One thread's share. An exception of any thread ends the shares of all. */
  void work(int thread)
  {
    try {
      fitInTurn(cover_.worker(thread).fitter);
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
  struct Slot {
    std::uint32_t cell, point;
    std::array<double, 3> place;
    State state = State::kWaiting;
    BallOutcome outcome = BallOutcome::kUnsupported;
    SurfelRecord surfel;
  };

  /** Fits and keeps centres until none is left, or until another thread has failed. */
  void fitInTurn(BallFitter& fitter)
  {
    std::uint32_t prepared = kNone;
    std::unique_lock<std::mutex> lock(mutex_);
    while (!failed_) {
      keepDone();
      Slot* const slot = take();
      if (slot == nullptr) {
        if (done_) break;
        changed_.wait(lock);
        continue;
      }
      lock.unlock();
      prepare(fitter.nearby(), prepared, slot->cell);
      slot->outcome = fitter.fit(slot->point, level_, slot->surfel);
      lock.lock();
      slot->state = State::kDone;
      changed_.notify_all();
    }
    changed_.notify_all();
  }

  void prepare(NearbyBlocks& nearby, std::uint32_t& prepared, std::uint32_t cell) const
  {
    if (prepared != cell) cover_.collectNearby(cover_.cells_[cell], level_, nearby);
    prepared = cell;
  }

  /** Keeps what is fitted and next in turn; what earlier ones serve is dropped. */
  void keepDone()
  {
    for (; !slots_.empty(); slots_.pop_front()) {
      Slot& slot = slots_.front();
      if (cover_.isServed(slot.point)) {
        if (slot.state == State::kRunning) return;
        continue;
      }
      if (slot.state != State::kDone) return;
      Output& output = outputs_[slot.cell];
      if (kept_cell_ != slot.cell) {
        const auto begin = static_cast<std::uint32_t>(cover_.worker(0).arena.size());
        output = {0, begin, begin, false};
      }
      prepare(kept_nearby_, kept_cell_, slot.cell);
      cover_.keep(slot.point, slot.outcome, slot.surfel, kept_nearby_, output);
    }
  }

  /** A centre to fit now, or none: those that wait are likely to be served by earlier ones. */
  Slot* take()
  {
    bool waits = false;
    for (std::size_t at = 0; at < window(); ++at) {
      if (at == slots_.size() && !addNext()) {
        done_ = !waits;
        return nullptr;
      }
      Slot& slot = slots_[at];
      if (slot.state != State::kWaiting || cover_.isServed(slot.point)) continue;
      if (!isNearEarlier(at)) {
        slot.state = State::kRunning;
        return &slot;
      }
      waits = true;
    }
    return nullptr;
  }

  std::size_t window() const { return kWindow * cover_.workers_.size(); }

  /** Whether a ball before it in turn is likely to serve a centre. */
  bool isNearEarlier(std::size_t at) const
  {
    for (std::size_t k = 0; k < at; ++k) {
      double distance_sq = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = slots_[at].place[a] - slots_[k].place[a];
        distance_sq += d * d;
      }
      if (distance_sq < reach_ * reach_) return true;
    }
    return false;
  }

  /** Lets the next centre wait. \return false: there is none. */
  bool addNext()
  {
    const auto served = [this](std::uint32_t point) { return cover_.isServed(point); };
    for (;;) {
      std::uint32_t point;
      if (visits_ && visits_->next(served, point)) {
        slots_.emplace_back();
        slots_.back().cell = cell_;
        slots_.back().point = point;
        slots_.back().place = cover_.store_.position(point);
        return true;
      }
      if (next_cell_ == cover_.cells_.byColor().size()) return false;
      cell_ = cover_.cells_.byColor()[next_cell_++];
      visits_.emplace(cover_.visitsOf(cover_.cells_[cell_]));
    }
  }

  LevelCover& cover_;
  int level_;
  double reach_;
  Output* outputs_;
  NearbyBlocks kept_nearby_;         ///< of the cell whose balls are kept
  std::uint32_t kept_cell_ = kNone;  ///< that cell
  std::mutex mutex_;
  std::condition_variable changed_;  ///< a fit is done, or all are
  std::deque<Slot> slots_;           ///< in turn
  std::size_t next_cell_ = 0;        ///< in order of colours
  std::uint32_t cell_ = kNone;
  std::optional<CellVisits> visits_;
  bool done_ = false;  ///< nothing is left to take
  bool failed_ = false;
};

void
LevelCover::coverSpeculatively(int level, std::size_t first_output)
{
  Speculation speculation(*this, level, outputs_.data() + first_output);
  const auto workers = static_cast<std::size_t>(threads_);
  parallelFor(workers, threads_, 1, [&](std::size_t, int thread) { speculation.work(thread); });
}

}  // namespace pcl_slim::detail
