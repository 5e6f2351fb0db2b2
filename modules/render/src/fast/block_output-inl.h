// SPDX-License-Identifier: BSD-3-Clause
// From a block's sums to a G-buffer's pixels. The guard toggles: Highway compiles a kernel file
// once per instruction set.
#if defined(PCL_SLIM_BLOCK_OUTPUT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLOCK_OUTPUT_INL
#undef PCL_SLIM_BLOCK_OUTPUT_INL
#else
#define PCL_SLIM_BLOCK_OUTPUT_INL
#endif

#include <array>
#include <cstring>

#include "fast/block_passes-inl.h"
#include "pcl_slim/leaf/detail/level_set-inl.h"
#include "tiles/tiles.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

/** Vectors of a block in world axes, from the camera's. */
HWY_INLINE void toWorld(const FrameView& view, const Vec p[3], Vec world[3]) {
  for (int a = 0; a < 3; ++a) {
    world[a] = dot3(set(view.right[a]), set(view.up[a]), set(view.forward[a]), p[0], p[1], p[2]);
  }
}

/** The pixels of a block whose upper left one is at (x, y) of its tile. */
struct BlockRows {
  const TileBlocks& tile;
  int x, y;

  /** Calls row(lane, pixel, count) for each of the block's rows inside the picture. */
  template <typename Row>
  HWY_INLINE void forEachRow(const GBuffer& buffer, const Row& row) const {
    const int count = std::min(kBlockWidth, tile.width - x);
    for (int r = 0; r < kBlockHeight && y + r < tile.height; ++r) {
      row(static_cast<std::size_t>(r * kBlockWidth), buffer.index(tile.x0 + x, tile.y0 + y + r),
          static_cast<std::size_t>(count));
    }
  }
};

/** Isolated pixels, a lane each, of those whose sums have a weight. */
struct PackedPixels {
  const TileBlocks& tile;
  const UncoveredRay* rays;
  std::size_t count;
  HWY_ALIGN float weight[16];

  PackedPixels(const TileBlocks& t, const UncoveredRay* r, std::size_t n, const BlockSums& sums)
      : tile(t), rays(r), count(n) {
    store(sums.weight, weight);
  }

  template <typename Row>
  HWY_INLINE void forEachRow(const GBuffer& buffer, const Row& row) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (!(weight[i] > 0.0f)) continue;
      row(i,
          buffer.index(tile.x0 + static_cast<int>(rays[i].x),
                       tile.y0 + static_cast<int>(rays[i].y)),
          std::size_t{1});
    }
  }
};

/** Where the pixels of some rays go. */
template <typename Pixels>
struct BlockOutput {
  const FrameScene& scene;
  Pixels pixels;
  GBuffer& buffer;
  RenderStatistics& statistics;

  template <typename Row>
  HWY_INLINE void forEachRow(const Row& row) const {
    pixels.forEachRow(buffer, row);
  }

  /** Copies count pixels of some values each. */
  template <std::size_t Values, typename T>
  static HWY_INLINE void copy(const T* from, std::size_t count, T* to) {
    constexpr std::size_t kWhole = kBlockWidth;
    if (HWY_LIKELY(count == kWhole))
      std::memcpy(to, from, kWhole * Values * sizeof(T));
    else
      std::memcpy(to, from, count * Values * sizeof(T));
  }

  HWY_INLINE void put(Vec v, std::vector<float>& column) const {
    HWY_ALIGN float values[16] = {};
    store(v, values);
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count)
                   HWY_ATTR { copy<1>(values + lane, count, column.data() + pixel); });
  }

  HWY_INLINE void put(const Vec v[3], std::vector<std::array<float, 3>>& column) const {
    HWY_ALIGN float values[48];
    storeInterleaved(v[0], v[1], v[2], values);
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count)
                   HWY_ATTR { copy<3>(values + 3 * lane, count, column.data()[pixel].data()); });
  }

  void writeNothing() const {
    forEachRow([&](std::size_t, std::size_t pixel, std::size_t count) {
      clearPixels(buffer, pixel, count);
    });
  }

  void write(const Block& block, const BlockSums& sums) const {
    const FrameView& view = scene.view;
    const Mask met = sums.weight > set(0.0f);
    const std::size_t covered = CountTrue(met);
    if (covered == 0) return writeNothing();
    statistics.covered_pixels += covered;
    const Vec share = set(1.0f) / IfThenElse(met, sums.weight, set(1.0f));
    Vec z = block.first + set(pixels.tile.depth);
    if (view.perspective) z = set(-1.0f) / z;
    z = MulAdd(sums.shift, share, z);
    const Vec depth = z * block.slant;
    put(IfThenElse(met, depth, set(kInfinite)), buffer.depth);

    Vec g[3], gradient[3], normal[3];
    for (int a = 0; a < 3; ++a) g[a] = sums.gradient[a] * share;
    toWorld(view, g, gradient);
    const Vec norm_sq = dot3(g[0], g[1], g[2], g[0], g[1], g[2]);
    const Mask usable = norm_sq > set(0.0f);
    const Vec inverse = set(1.0f) / Sqrt(IfThenElse(usable, norm_sq, set(1.0f)));
    for (int a = 0; a < 3; ++a) {
      normal[a] = IfThenElseZero(met, gradient[a] * inverse);
      gradient[a] = IfThenElseZero(met, gradient[a]);
    }
    put(normal, buffer.normal);
    if (!buffer.gradient.empty()) put(gradient, buffer.gradient);
    if (!buffer.position.empty()) writePositions(block, z, met);
    if (scene.columns & (kHessianColumn | kCurvatureColumn)) writeCurvature(g, sums, share, met);
    writeLeaves(sums, met);
  }

 private:
  void writePositions(const Block& block, Vec z, Mask met) const {
    const bool perspective = scene.view.perspective;
    const Vec in_view[3] = {perspective ? block.slope_x * z : block.slope_x,
                            perspective ? block.slope_y * z : block.slope_y, z};
    Vec position[3];
    toWorld(scene.view, in_view, position);
    for (int a = 0; a < 3; ++a) {
      const Vec from_eye = position[a] + set(scene.view.eye_rest[a]);
      position[a] = IfThenElseZero(met, from_eye + set(scene.view.eye[a]));
    }
    put(position, buffer.position);
  }

  void writeCurvature(const Vec g[3], const BlockSums& sums, Vec share, Mask met) const {
    Vec h[6];
    for (int k = 0; k < 6; ++k) h[k] = sums.hessian[k] * share;
    if (!buffer.mean_curvature.empty()) {
      const LevelSetCurvatures<Vec> curvature(g, h);
      put(IfThenElseZero(met, curvature.mean), buffer.mean_curvature);
      put(IfThenElseZero(met, curvature.gaussian), buffer.gaussian_curvature);
      HWY_ALIGN float values[32] = {};
      const Vec k_max = IfThenElseZero(met, curvature.k_max);
      const Vec k_min = IfThenElseZero(met, curvature.k_min);
      storeInterleaved(k_max, k_min, values);
      forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) {
        copy<2>(values + 2 * lane, count, buffer.principal.data()[pixel].data());
      });
    }
    if (!buffer.hessian.empty()) writeHessian(h, met);
  }

  void writeHessian(const Vec h[6], Mask met) const {
    // Columns of R H with R's rows the camera's axes, then R^T of those.
    const Vec columns[3][3] = {
        {h[kXX], h[kXY], h[kXZ]}, {h[kXY], h[kYY], h[kYZ]}, {h[kXZ], h[kYZ], h[kZZ]}};
    Vec half[3][3], full[3][3];
    for (int i = 0; i < 3; ++i) toWorld(scene.view, columns[i], half[i]);
    for (int a = 0; a < 3; ++a) {
      const Vec row[3] = {half[0][a], half[1][a], half[2][a]};
      toWorld(scene.view, row, full[a]);
    }
    const Vec world[6] = {full[0][0], full[0][1], full[0][2], full[1][1], full[1][2], full[2][2]};
    HWY_ALIGN float values[6][16] = {};
    for (int k = 0; k < 6; ++k) store(IfThenElseZero(met, world[k]), values[k]);
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 6; ++k) buffer.hessian[pixel + i][k] = values[k][lane + i];
      }
    });
  }

  void writeLeaves(const BlockSums& sums, Mask met) const {
    HWY_ALIGN std::uint32_t surfel[16] = {};
    HWY_ALIGN std::uint32_t behind[16] = {};
    const UintVec nothing = setUint(GBuffer::kNothing);
    store(IfThenElse(met, sums.surfel, nothing), surfel);
    const Mask turned = And(met, sums.facing < set(0.0f));
    if (scene.surface.info.hasFront()) {
      store(IfThenElse(turned, setUint(1), setUint(0)), behind);
    }
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) {
      copy<1>(surfel + lane, count, buffer.surfel.data() + pixel);
      for (std::size_t i = 0; i < count; ++i) {
        buffer.back_face[pixel + i] = static_cast<std::uint8_t>(behind[lane + i]);
      }
      if (buffer.level.empty()) return;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t s = surfel[lane + i];
        const bool is_met = s != GBuffer::kNothing;
        buffer.level[pixel + i] = is_met ? scene.surface.level[s] : std::uint8_t{0};
        buffer.radius[pixel + i] = is_met ? scene.surface.radius[s] : 0.0f;
      }
    });
    if (buffer.weight.empty()) return;
    put(IfThenElseZero(met, sums.weight), buffer.weight);
    put(IfThenElseZero(met, sums.coverage), buffer.coverage);
  }
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif
