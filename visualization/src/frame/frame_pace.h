// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim::detail {

/** \brief How fast one back end has drawn its last full frames of a surface. */
class FramePace {
 public:
  /** \brief Counts a frame. \param[in] seconds of wall time */
  void add(double seconds, std::size_t pixels)
  {
    constexpr std::size_t kFewest = 10000;  // small frames do not predict large ones
    if (pixels < kFewest) return;
    last_[frames_ % last_.size()] = seconds / static_cast<double>(pixels);
    ++frames_;
  }

  /** \brief Whether frames enough are counted: the first one also compiles shaders or makes an index. */
  bool isKnown() const { return frames_ >= last_.size(); }
  /** \brief Seconds a pixel of the fastest of the last three frames, once they are known. */
  double secondsPerPixel() const { return *std::min_element(last_.begin(), last_.end()); }

 private:
  std::array<double, 3> last_{};
  std::size_t frames_ = 0;
};

/** \brief Which of the two back ends draws a surface: the graphics card while it is fast or not yet known to be slow;
 * once it is slow the CPU, until its pace is known as well, and from then on the faster of the two. */
class BackendChoice {
 public:
  /** \brief Counts a full frame. The card draws nothing that is cut open, for which the CPU takes longer: such frames
   * are not counted. \param[in] seconds of wall time until the card has it */
  void add(bool on_card, const FrameRequest& request, double seconds, std::size_t pixels)
  {
    if (!request.close_gaps || !request.clip_planes.empty()) return;
    (on_card ? card_ : cpu_).add(seconds, pixels);
  }

  /** \brief Whether the graphics card is to draw the next frame. */
  bool prefersCard()
  {
    constexpr double kFast = 1.5e-8;  // 14 ms a frame of 1280 x 720
    if (!card_.isKnown() || card_.secondsPerPixel() < kFast) return on_card_ = true;
    if (!cpu_.isKnown()) return on_card_ = false;
    // Frames vary by as much while the camera turns: what is faster by less is no reason to change again.
    const double gain = settled_ ? 0.75 : 1.0;
    const double ratio = cpu_.secondsPerPixel() / card_.secondsPerPixel();
    settled_ = true;
    return on_card_ = on_card_ ? ratio >= gain : ratio * gain > 1.0;
  }

 private:
  FramePace card_, cpu_;
  bool on_card_ = true, settled_ = false;
};

}  // namespace pcl_slim::detail
