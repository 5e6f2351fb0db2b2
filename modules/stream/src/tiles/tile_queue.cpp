// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/tile_queue.h"

#include <utility>

namespace pcl_slim::detail {

Error
TileQueue::fit(int at_once)
{
  parallelFor(static_cast<std::size_t>(at_once), at_once, 1, [&](std::size_t, int) {
    try {
      work();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      next_ = tiles_.size();
      throw;
    }
  });
  return stopped() ? cancelled() : error_;
}

/** One thread's share: fits what is next until nothing is left or some tile has failed. */
void
TileQueue::work()
{
  for (std::size_t place; take(place);) {
    Error error = fitOne(place);
    if (!error) continue;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!error_) error_ = std::move(error);
    next_ = tiles_.size();
  }
}

bool
TileQueue::take(std::size_t& place)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  place = next_;
  if (next_ == tiles_.size() || stopped()) return false;
  ++next_;
  return true;
}

Error
TileQueue::fitOne(std::size_t place)
{
  Progress watched([&](float, const char*) {
    if (stopped()) watched.cancel();
  });
  FittedTile made;
  if (Error error = state_.fitTile(tiles_[place], 1, made, watched)) return error;
  const std::lock_guard<std::mutex> lock(mutex_);
  ready_.emplace(place, std::move(made));
  return giveAway();
}

/** Gives away the tiles whose turn it is. */
Error
TileQueue::giveAway()
{
  for (auto first = ready_.begin(); first != ready_.end() && first->first == given_ && !error_;
       first = ready_.erase(first), ++given_) {
    if (Error error = state_.give(tiles_[given_], first->second, sink_)) return error;
  }
  const auto done = static_cast<float>(given_) / static_cast<float>(tiles_.size());
  if (progress_ != nullptr && std::this_thread::get_id() == caller_)
    progress_->report(0.12f + 0.88f * done, "covering");
  return {};
}

}  // namespace pcl_slim::detail
