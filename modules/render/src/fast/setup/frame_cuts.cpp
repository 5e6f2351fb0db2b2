// SPDX-License-Identifier: BSD-3-Clause
#include "fast/setup/frame_cuts.h"

namespace pcl_slim::detail {
namespace {

double
along(const HalfSpace& cut, const float axis[3])
{
  return cut.normal[0] * axis[0] + cut.normal[1] * axis[1] + cut.normal[2] * axis[2];
}

}  // namespace

std::vector<FrameCut>
frameCuts(const FrameView& view, const std::vector<HalfSpace>& cuts)
{
  std::vector<FrameCut> frame;
  for (const HalfSpace& cut : cuts) {
    const double offset = cut.offset - along(cut, view.eye) - along(cut, view.eye_rest);
    const double forward = along(cut, view.forward);
    // n . (x z, y z, z) >= offset, divided by z > 0: 1 / z = -D.
    frame.push_back({along(cut, view.right), along(cut, view.up),
                     view.perspective ? forward : -offset, view.perspective ? offset : forward});
  }
  return frame;
}

}  // namespace pcl_slim::detail
