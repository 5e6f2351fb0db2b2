// SPDX-License-Identifier: BSD-3-Clause
// What the stages of a frame cost.
#pragma once

#include <chrono>
#include <cstdint>

namespace pcl_slim::detail {

enum class FrameStage : std::uint8_t {
  kSetup,   ///< culling, and records of the leaves that may be seen
  kSort,    ///< by depth, and into tiles
  kLists,   ///< the leaves of tiles, and of their patches of pixels
  kFirst,   ///< pass 1: first intersections
  kBlend,   ///< pass 2: blending
  kOutput,  ///< into the G-buffer
};
constexpr int kFrameStages = 6;

/** \brief Ticks of a clock that costs a few nanoseconds to read, by stage. */
struct StageTicks {
  std::uint64_t of[kFrameStages] = {};

  StageTicks& operator+=(const StageTicks& other) {
    for (int s = 0; s < kFrameStages; ++s) of[s] += other.of[s];
    return *this;
  }
};

/** \brief Adds the ticks of its life to a stage. */
class StageTimer {
 public:
  /** \param[in] ticks nullptr: nothing is measured */
  StageTimer(StageTicks* ticks, FrameStage stage)
      : ticks_(ticks), stage_(stage), begin_(ticks ? now() : 0) {}
  ~StageTimer() {
    if (ticks_) ticks_->of[static_cast<int>(stage_)] += now() - begin_;
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  static std::uint64_t now() {
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
  }

  StageTicks* ticks_;
  FrameStage stage_;
  std::uint64_t begin_;
};

}  // namespace pcl_slim::detail
