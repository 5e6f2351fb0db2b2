// SPDX-License-Identifier: BSD-3-Clause
#include "shading/paint_surface.h"

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr int kSide = 4;  ///< pixels a side of the blocks that are painted at a time
static_assert(kSide * kSide <= static_cast<int>(SurfaceProbe::kMost));

/** The covered pixels of one block. */
struct PixelBlock {
  std::array<Vector3, SurfaceProbe::kMost> places, sides;
  std::array<std::size_t, SurfaceProbe::kMost> pixels;
  std::size_t count = 0;

  PixelBlock(const GBuffer& buffer, int x0, int y0)
  {
    for (int y = y0; y < std::min(buffer.height, y0 + kSide); ++y) {
      for (int x = x0; x < std::min(buffer.width, x0 + kSide); ++x) {
        const std::size_t pixel = buffer.index(x, y);
        if (!buffer.covered(pixel)) continue;
        const auto &p = buffer.position[pixel], &n = buffer.normal[pixel];
        // Normals of a surface that is seen from behind are turned to the viewer.
        const double sign = buffer.back_face[pixel] ? -1.0 : 1.0;
        places[count] = {p[0], p[1], p[2]};
        sides[count] = {sign * n[0], sign * n[1], sign * n[2]};
        pixels[count++] = pixel;
      }
    }
  }
};

}  // namespace

void
SurfacePainter::paint(int threads, GBuffer& buffer)
{
  buffer.color.clear();
  if (!surface_.hasColors()) return;
  if (!index_) index_ = std::make_unique<ProbeIndex>(surface_);
  buffer.color.assign(buffer.numPixels(), {1.0f, 1.0f, 1.0f});
  std::deque<SurfaceProbe> probes;
  for (int t = 0; t < threads; ++t) probes.emplace_back(*index_);
  const auto rows = static_cast<std::size_t>((buffer.height + kSide - 1) / kSide);
  parallelFor(rows, threads, 1, [&](std::size_t row, int thread) {
    SurfaceProbe& probe = probes[static_cast<std::size_t>(thread)];
    std::array<std::array<float, 3>, SurfaceProbe::kMost> colors;
    for (int x = 0; x < buffer.width; x += kSide) {
      const PixelBlock block(buffer, x, static_cast<int>(row) * kSide);
      if (block.count == 0) continue;
      probe.restart(0);  // no result depends on the blocks before
      probe.colors(block.places.data(), block.sides.data(), block.count, colors.data());
      for (std::size_t i = 0; i < block.count; ++i) {
        for (std::size_t c = 0; c < 3 && colors[i][c] >= 0.0f; ++c)
          buffer.color[block.pixels[i]][c] = colors[i][c] / 255.0f;
      }
    }
  });
}

}  // namespace pcl_slim::detail
