// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "camera/camera_rays.h"
#include "pcl_slim/render/picture_lines.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr float kFullStrength = 4.0f;

/** Places of points in the picture, and whether the surface hides them. */
class LineView {
 public:
  LineView(const GBuffer& buffer, const Camera& camera, const SLIMSurface& surface,
           double tolerance)
      : buffer_(buffer),
        camera_(camera),
        axes_(camera),
        scale_(surface.info.scale),
        tolerance_(tolerance * surface.info.diagonal)
  {
    const bool perspective = camera.projection == Camera::Projection::kPerspective;
    const double height =
        perspective ? 2.0 * std::tan(camera.fov * M_PI / 360.0) : camera.view_height;
    pixel_ = height / camera.size.height;
  }

  /** \return whether the point is seen; place is then where. */
  bool see(const Vector3& point, std::array<float, 2>& place) const
  {
    const Vector3 to = subtract(point, camera_.position);
    const bool perspective = camera_.projection == Camera::Projection::kPerspective;
    const double ahead = dot(to, axes_.forward);
    if (perspective && !(ahead > 0)) return false;
    const double unit = pixel_ * (perspective ? ahead : 1.0);
    const double x = dot(to, axes_.right) / unit + 0.5 * (camera_.size.width - 1);
    const double y = 0.5 * (camera_.size.height - 1) - dot(to, axes_.up) / unit;
    place = {static_cast<float>(x), static_cast<float>(y)};
    const auto column = std::lround(x), row = std::lround(y);
    if (column < 0 || row < 0 || column >= buffer_.width || row >= buffer_.height) return false;
    const double depth = (perspective ? length(to) : ahead) / scale_;
    return depth < tolerance_ + depthAbout(static_cast<int>(column), static_cast<int>(row));
  }

 private:
  /** The greatest depth about a pixel: a line on a contour is not hidden by its own surface. */
  double depthAbout(int column, int row) const
  {
    float depth = 0;
    for (int y = std::max(0, row - 1); y <= std::min(buffer_.height - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(buffer_.width - 1, column + 1); ++x)
        depth = std::max(depth, buffer_.depth[buffer_.index(x, y)]);
    }
    return depth;
  }

  const GBuffer& buffer_;
  const Camera& camera_;
  CameraAxes axes_;
  double scale_, tolerance_, pixel_ = 1;
};

void
appendVisible(const SpaceLine& line, const LineView& view, std::vector<PictureLine>& seen)
{
  PictureLine part;
  part.kind = line.kind;
  const auto finish = [&] {
    part.strength.assign(part.points.size(), kFullStrength);
    if (part.points.size() > 1) seen.push_back(part);
    part.points.clear();
  };
  for (const auto& point : line.points) {
    std::array<float, 2> place;
    if (view.see(point, place)) {
      part.points.push_back(place);
    } else {
      finish();
    }
  }
  finish();
}

}  // namespace

Result<std::vector<PictureLine>>
projectLines(const std::vector<SpaceLine>& lines, const GBuffer& buffer, const Camera& camera,
             const SLIMSurface& surface, double tolerance)
{
  if (Error error = camera.validate()) return error;
  if (buffer.width != camera.size.width || buffer.height != camera.size.height)
    return Error{ErrorCode::kBadArgument,
                 "the G-buffer and the camera differ in size; draw lines with the camera it was "
                 "made by"};
  const LineView view(buffer, camera, surface, tolerance);
  std::vector<PictureLine> seen;
  for (const SpaceLine& line : lines) appendVisible(line, view, seen);
  return seen;
}

}  // namespace pcl_slim
