// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "stream_state.h"

namespace pcl_slim::detail {

/** \brief Tiles that are fitted at the same time, a thread each, and given away in order. */
class TileQueue {
 public:
  TileQueue(StreamState& state, const std::vector<std::size_t>& tiles, const StreamFit::Sink& sink,
            Progress* progress)
      : state_(state), tiles_(tiles), sink_(sink), progress_(progress)
  {
  }

  /** \brief Fits all. \param[in] at_once how many at the same time */
  Error fit(int at_once);

 private:
  void work();
  bool take(std::size_t& place);
  Error fitOne(std::size_t place);
  Error giveAway();
  bool stopped() const { return progress_ != nullptr && progress_->cancelled(); }

  StreamState& state_;
  const std::vector<std::size_t>& tiles_;
  const StreamFit::Sink& sink_;
  Progress* progress_;
  const std::thread::id caller_ = std::this_thread::get_id();
  std::mutex mutex_;
  std::size_t next_ = 0, given_ = 0;  ///< places among the tiles
  std::map<std::size_t, FittedTile> ready_;
  Error error_;
};

}  // namespace pcl_slim::detail
