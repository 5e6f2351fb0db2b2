// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

namespace pcl_slim::detail {

/** \brief How fast one back end has drawn a surface's full frames. */
class FramePace {
 public:
  /** \brief Counts a frame. \param[in] seconds of wall time */
  void add(double seconds, std::size_t pixels)
  {
    constexpr std::size_t kFewest = 10000;  // small frames do not predict large ones
    if (pixels < kFewest) return;
    const double pace = seconds / static_cast<double>(pixels);
    seconds_ = frames_ > 0 ? std::min(seconds_, pace) : pace;
    ++frames_;
  }

  /** \brief Whether frames enough are counted: the first one also compiles shaders or makes an index. */
  bool isKnown() const { return frames_ >= 3; }
  /** \brief Seconds a pixel of the fastest frame. */
  double secondsPerPixel() const { return seconds_; }

 private:
  int frames_ = 0;
  double seconds_ = 0.0;
};

/** \brief Whether the graphics card is to draw the next frame: while it is fast or not yet known to be slow; once it
 * is slow, after the CPU's pace is known as well, where it is the faster of the two. */
inline bool
prefersCard(const FramePace& card, const FramePace& cpu)
{
  constexpr double kFast = 1.5e-8;  // 14 ms a frame of 1280 x 720
  if (!card.isKnown() || card.secondsPerPixel() < kFast) return true;
  return cpu.isKnown() && card.secondsPerPixel() < cpu.secondsPerPixel();
}

}  // namespace pcl_slim::detail
