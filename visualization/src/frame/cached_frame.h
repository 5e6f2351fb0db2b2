// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "frame/frame_textures.h"
#include "frame/view_camera.h"
#include "frame/vtk_view.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

/** \brief All that decides what a frame's rays meet, except their distance. */
struct FrameKey {
  Matrix4 model_to_view{};
  std::array<double, 7> projection{};  ///< without the depth range, which moves no ray
  int width = 0, height = 0;
  double near_distance = 0.0;
  std::vector<double> planes;
  VisibleSides sides = VisibleSides::kAuto;
  double lod = 0.0;  ///< of a frame at rest
  bool trim = true;
  bool colored = false;      ///< the frame has the colours of a surface
  bool close_gaps = false;   ///< a frame with its gaps closed is one without as well
  std::uint64_t object = 0;  ///< counts changes of the object

  FrameKey() = default;
  FrameKey(const VtkView& view, const FrameRequest& request, std::uint64_t object_count);

  bool operator==(const FrameKey& other) const;
};

/** \brief What the rays of the last frame met, kept until something moves. */
class CachedFrame {
 public:
  using Rasterize = std::function<Error(const Camera&, const FrameRequest&, GBuffer&)>;
  /** Draws on the graphics card and counts the covered pixels. */
  using DrawOnCard = std::function<Error(const ViewCamera&, const FrameRequest&, std::uint64_t&)>;

  /** \brief Whether a frame at least as fine is there. */
  bool holds(const FrameKey& key, int coarseness) const;

  /** \brief Makes a frame. \param[in] request near_plane is filled in here, and lod is brought to
   * the rays' distance; \param[in] scale of the lengths that rasterize writes. After an error there
   * is none. */
  Error make(const VtkView& view, FrameKey key, int coarseness, FrameRequest request, double scale,
             const Rasterize& rasterize);

  /** \brief Makes a frame that stays on the graphics card: packed() is of no use then. */
  Error makeOnCard(const VtkView& view, FrameKey key, int coarseness, FrameRequest request,
                   const DrawOnCard& draw);

  /** \brief Forgets the frame and how long it took. */
  void clear();

  /** \brief The distance of rays [pixels] at which a frame takes no longer than this. */
  int coarsenessFor(double milliseconds) const;

  const ViewCamera& view() const { return view_; }
  /** \brief The frame of the CPU itself. */
  const GBuffer& buffer() const { return buffer_; }
  const PackedFrame& packed() const { return packed_; }
  int width() const { return buffer_.width; }
  int height() const { return buffer_.height; }
  int coarseness() const { return coarseness_; }
  double seconds() const { return seconds_; }
  std::uint64_t coveredPixels() const { return covered_; }
  /** \brief Left, bottom, right, top of all covered pixels, normalised device coordinates. */
  const std::array<float, 4>& rectangle() const { return rectangle_; }

 private:
  using Clock = std::chrono::steady_clock;

  Error begin(const VtkView& view, int coarseness, FrameRequest& request);
  void finish(FrameKey key, int coarseness, Clock::time_point start);

  bool valid_ = false;
  FrameKey key_;
  int coarseness_ = 1;
  double seconds_ = 0.0;       ///< what the frame took
  double full_seconds_ = 0.0;  ///< about what a frame with a ray for every pixel takes
  std::uint64_t covered_ = 0;
  ViewCamera view_;
  GBuffer buffer_;
  PackedFrame packed_;
  std::array<float, 4> rectangle_{};
};

}  // namespace pcl_slim::detail
