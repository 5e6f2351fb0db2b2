// SPDX-License-Identifier: BSD-3-Clause
#include "frame/cached_frame.h"

#include <algorithm>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {
namespace {

/** \brief Normalised device coordinates of a rectangle that contains every covered pixel. */
std::array<float, 4>
coveredRectangle(const GBuffer& buffer)
{
  int x0 = buffer.width, x1 = -1, y0 = buffer.height, y1 = -1;
  const auto met = [](std::uint32_t surfel) { return surfel != GBuffer::kNothing; };
  for (int y = 0; y < buffer.height; ++y) {
    const std::uint32_t* row = buffer.surfel.data() + buffer.index(0, y);
    const std::uint32_t* first = std::find_if(row, row + buffer.width, met);
    if (first == row + buffer.width) continue;
    int last = buffer.width - 1;
    while (!met(row[last])) --last;
    x0 = std::min(x0, static_cast<int>(first - row));
    x1 = std::max(x1, last);
    y0 = std::min(y0, y);
    y1 = y;
  }
  const auto ndc = [](int texel, int count) {
    const float x = static_cast<float>(texel) / static_cast<float>(count);
    return std::clamp(2.0f * x - 1.0f, -1.0f, 1.0f);
  };
  // Texels more on each side for what is interpolated between rays, and for lines on the silhouette.
  constexpr int kMore = 2;
  return {ndc(x0 - kMore, buffer.width), -ndc(y1 + 1 + kMore, buffer.height),
          ndc(x1 + 1 + kMore, buffer.width), -ndc(y0 - kMore, buffer.height)};
}

}  // namespace

FrameKey::FrameKey(const VtkView& view, const FrameRequest& request, std::uint64_t object_count)
    : model_to_view(view.gl.model_to_view),
      width(view.gl.width),
      height(view.gl.height),
      near_distance(view.near_distance),
      sides(request.sides),
      lod(request.lod),
      trim(request.trim),
      colored((request.columns & kColorColumn) != 0),
      close_gaps(request.close_gaps),
      object(object_count)
{
  const Matrix4& p = view.gl.projection;
  projection = {p[0], p[2], p[3], p[5], p[6], p[7], p[15]};
  for (const HalfSpace& plane : request.clip_planes) {
    planes.insert(planes.end(), plane.normal.begin(), plane.normal.end());
    planes.push_back(plane.offset);
  }
}

bool
FrameKey::operator==(const FrameKey& other) const
{
  return model_to_view == other.model_to_view && projection == other.projection &&
         width == other.width && height == other.height && near_distance == other.near_distance &&
         planes == other.planes && sides == other.sides && lod == other.lod && trim == other.trim &&
         colored == other.colored && object == other.object;
}

bool
CachedFrame::holds(const FrameKey& key, int coarseness) const
{
  return valid_ && key == key_ && coarseness_ <= coarseness && (key_.close_gaps || !key.close_gaps);
}

/** \brief Converts a request to a camera whose rays are several pixels apart. */
Error
CachedFrame::begin(const VtkView& view, int coarseness, FrameRequest& request)
{
  valid_ = false;
  if (Error error = translateView(view.gl, view.near_distance, coarseness, view_)) return error;
  request.near_plane = view_.near_plane;
  request.lod /= coarseness;
  // A frame that has to hurry shows nothing that falls between its rays.
  if (coarseness > 1) request.lod = std::max(request.lod, 1.0);
  return {};
}

Error
CachedFrame::make(const VtkView& view, FrameKey key, int coarseness, FrameRequest request,
                  double scale, const Rasterize& rasterize)
{
  const Clock::time_point start = Clock::now();
  if (Error error = begin(view, coarseness, request)) return error;
  if (Error error = rasterize(view_.camera, request, buffer_)) return error;
  packFrame(buffer_, scale, resolveThreads(request.threads), packed_);
  rectangle_ = coveredRectangle(buffer_);
  covered_ = buffer_.numCovered();
  finish(std::move(key), coarseness, start);
  return {};
}

Error
CachedFrame::makeOnCard(const VtkView& view, FrameKey key, int coarseness, FrameRequest request,
                        const DrawOnCard& draw)
{
  const Clock::time_point start = Clock::now();
  if (Error error = begin(view, coarseness, request)) return error;
  if (Error error = draw(view_, request, covered_)) return error;
  rectangle_ = {-1.0f, -1.0f, 1.0f, 1.0f};
  finish(std::move(key), coarseness, start);
  return {};
}

void
CachedFrame::finish(FrameKey key, int coarseness, Clock::time_point start)
{
  key_ = std::move(key);
  coarseness_ = coarseness;
  valid_ = true;
  seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
  full_seconds_ = seconds_ * coarseness * coarseness;
}

void
CachedFrame::clear()
{
  valid_ = false;
  full_seconds_ = 0.0;
  covered_ = 0;
}

int
CachedFrame::coarsenessFor(double milliseconds) const
{
  for (const int step : {1, 2}) {
    if (full_seconds_ * 1000.0 <= milliseconds * step * step) return step;
  }
  return 4;
}

}  // namespace pcl_slim::detail
