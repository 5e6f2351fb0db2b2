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
#include "tiles/clear_pixels.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Vectors of a block in world axes, from the camera's. */
HWY_INLINE void
toWorld(const FrameView& view, const Vec p[3], Vec world[3])
{
  for (int a = 0; a < 3; ++a) {
    world[a] = dot3(set(view.right[a]), set(view.up[a]), set(view.forward[a]), p[0], p[1], p[2]);
  }
}

/** Curvatures of the level set with the given gradient and Hessian. */
struct LevelSetCurvatures {
  Vec mean, gaussian, k_max, k_min;

  HWY_INLINE LevelSetCurvatures(const Vec g[3], const Vec h[6])
  {
    const Vec half = set(0.5f), two = set(2.0f);
    const Vec xx = hn::Mul(g[0], g[0]), yy = hn::Mul(g[1], g[1]), zz = hn::Mul(g[2], g[2]);
    const Vec xy = hn::Mul(g[0], g[1]), xz = hn::Mul(g[0], g[2]), yz = hn::Mul(g[1], g[2]);
    const Vec norm_sq = hn::Max(hn::Add(xx, hn::Add(yy, zz)), set(1e-30f));
    const Vec ghg = hn::MulAdd(two, dot3(xy, xz, yz, h[kXY], h[kXZ], h[kYZ]),
                               dot3(xx, yy, zz, h[kXX], h[kYY], h[kZZ]));
    const Vec inverse_sq = hn::Div(set(1.0f), norm_sq);
    const Vec trace = hn::Add(h[kXX], hn::Add(h[kYY], h[kZZ]));
    mean = hn::Mul(hn::Mul(half, hn::NegMulAdd(ghg, inverse_sq, trace)), hn::Sqrt(inverse_sq));
    const auto minor = [&](int a, int b, int c, int e)
                           HWY_ATTR { return hn::MulSub(h[a], h[b], hn::Mul(h[c], h[e])); };
    const Vec diagonal = dot3(xx, yy, zz, minor(kYY, kZZ, kYZ, kYZ), minor(kXX, kZZ, kXZ, kXZ),
                              minor(kXX, kYY, kXY, kXY));
    const Vec mixed = dot3(xy, xz, yz, minor(kXZ, kYZ, kXY, kZZ), minor(kXY, kYZ, kXZ, kYY),
                           minor(kXY, kXZ, kYZ, kXX));
    gaussian = hn::Mul(hn::MulAdd(two, mixed, diagonal), hn::Mul(inverse_sq, inverse_sq));
    const Vec spread = hn::Sqrt(hn::Max(hn::Zero(Tag()), hn::MulSub(mean, mean, gaussian)));
    k_max = hn::Add(mean, spread);
    k_min = hn::Sub(mean, spread);
  }
};

/** Where one block's pixels go. */
struct BlockOutput {
  const FrameScene& scene;
  const TileBlocks& tile;
  int x, y;  ///< of the block in its tile
  GBuffer& buffer;
  RenderStatistics& statistics;

  /** Calls row(lane, pixel, count) for each of the block's rows inside the picture. */
  template <typename Row>
  HWY_INLINE void forEachRow(const Row& row) const
  {
    const int count = std::min(kBlockWidth, tile.width - x);
    for (int r = 0; r < blockHeight() && y + r < tile.height; ++r) {
      row(static_cast<std::size_t>(r * kBlockWidth), buffer.index(tile.x0 + x, tile.y0 + y + r),
          static_cast<std::size_t>(count));
    }
  }

  HWY_INLINE void put(Vec v, std::vector<float>& column) const
  {
    HWY_ALIGN float values[16] = {};
    hn::Store(v, Tag(), values);
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) HWY_ATTR {
      std::memcpy(column.data() + pixel, values + lane, count * sizeof(float));
    });
  }

  HWY_INLINE void put(const Vec v[3], std::vector<std::array<float, 3>>& column) const
  {
    HWY_ALIGN float values[48];
    hn::StoreInterleaved3(v[0], v[1], v[2], Tag(), values);
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) HWY_ATTR {
      float* target = column.data()[pixel].data();
      if (count == kBlockWidth)
        std::memcpy(target, values + 3 * lane, 3 * kBlockWidth * sizeof(float));
      else
        std::memcpy(target, values + 3 * lane, 3 * count * sizeof(float));
    });
  }

  void writeNothing() const
  {
    forEachRow([&](std::size_t, std::size_t pixel, std::size_t count) {
      clearPixels(buffer, pixel, count);
    });
  }

  void write(const Block& block, const BlockSums& sums, Vec first) const
  {
    const Tag d;
    const FrameView& view = scene.view;
    const Mask met = hn::Gt(sums.weight, hn::Zero(d));
    const std::size_t covered = hn::CountTrue(d, met);
    if (covered == 0) return writeNothing();
    statistics.covered_pixels += covered;
    const Vec share = hn::Div(set(1.0f), hn::IfThenElse(met, sums.weight, set(1.0f)));
    Vec z = hn::Add(first, set(tile.depth));
    if (view.perspective) z = hn::Div(set(-1.0f), z);
    z = hn::MulAdd(sums.shift, share, z);
    const Vec depth = hn::Mul(z, block.slant);
    put(hn::IfThenElse(met, depth, set(kInfinite)), buffer.depth);

    Vec g[3], gradient[3], normal[3];
    for (int a = 0; a < 3; ++a) g[a] = hn::Mul(sums.gradient[a], share);
    toWorld(view, g, gradient);
    const Vec norm_sq = dot3(g[0], g[1], g[2], g[0], g[1], g[2]);
    const Mask usable = hn::Gt(norm_sq, hn::Zero(d));
    const Vec inverse = hn::Div(set(1.0f), hn::Sqrt(hn::IfThenElse(usable, norm_sq, set(1.0f))));
    for (int a = 0; a < 3; ++a) {
      normal[a] = hn::IfThenElseZero(met, hn::Mul(gradient[a], inverse));
      gradient[a] = hn::IfThenElseZero(met, gradient[a]);
    }
    put(normal, buffer.normal);
    if (!buffer.gradient.empty()) put(gradient, buffer.gradient);
    if (!buffer.position.empty()) writePositions(block, z, met);
    if (scene.columns & (kHessianColumn | kCurvatureColumn)) writeCurvature(g, sums, share, met);
    writeLeaves(sums, met);
  }

 private:
  void writePositions(const Block& block, Vec z, Mask met) const
  {
    const bool perspective = scene.view.perspective;
    const Vec in_view[3] = {perspective ? hn::Mul(block.slope_x, z) : block.slope_x,
                            perspective ? hn::Mul(block.slope_y, z) : block.slope_y, z};
    Vec position[3];
    toWorld(scene.view, in_view, position);
    for (int a = 0; a < 3; ++a) {
      const Vec from_eye = hn::Add(position[a], set(scene.view.eye_rest[a]));
      position[a] = hn::IfThenElseZero(met, hn::Add(from_eye, set(scene.view.eye[a])));
    }
    put(position, buffer.position);
  }

  void writeCurvature(const Vec g[3], const BlockSums& sums, Vec share, Mask met) const
  {
    const Tag d;
    Vec h[6];
    for (int k = 0; k < 6; ++k) h[k] = hn::Mul(sums.hessian[k], share);
    if (!buffer.mean_curvature.empty()) {
      const LevelSetCurvatures curvature(g, h);
      put(hn::IfThenElseZero(met, curvature.mean), buffer.mean_curvature);
      put(hn::IfThenElseZero(met, curvature.gaussian), buffer.gaussian_curvature);
      HWY_ALIGN float values[32] = {};
      hn::StoreInterleaved2(hn::IfThenElseZero(met, curvature.k_max),
                            hn::IfThenElseZero(met, curvature.k_min), d, values);
      forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) {
        std::memcpy(buffer.principal.data() + pixel, values + 2 * lane, 2 * count * sizeof(float));
      });
    }
    if (!buffer.hessian.empty()) writeHessian(h, met);
  }

  void writeHessian(const Vec h[6], Mask met) const
  {
    const Tag d;
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
    for (int k = 0; k < 6; ++k) hn::Store(hn::IfThenElseZero(met, world[k]), d, values[k]);
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 6; ++k) buffer.hessian[pixel + i][k] = values[k][lane + i];
      }
    });
  }

  void writeLeaves(const BlockSums& sums, Mask met) const
  {
    const Tag d;
    HWY_ALIGN std::uint32_t surfel[16] = {};
    HWY_ALIGN float facing[16] = {};
    const UintVec nothing = hn::Set(UintTag(), GBuffer::kNothing);
    hn::Store(hn::IfThenElse(hn::RebindMask(UintTag(), met), sums.surfel, nothing), UintTag(),
              surfel);
    hn::Store(hn::IfThenElseZero(met, sums.facing), d, facing);
    const bool oriented = scene.surface.info.oriented;
    forEachRow([&](std::size_t lane, std::size_t pixel, std::size_t count) {
      std::memcpy(buffer.surfel.data() + pixel, surfel + lane, count * sizeof(std::uint32_t));
      for (std::size_t i = 0; i < count; ++i) {
        buffer.back_face[pixel + i] = oriented && facing[lane + i] < 0.0f;
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
    put(hn::IfThenElseZero(met, sums.weight), buffer.weight);
    put(hn::IfThenElseZero(met, sums.coverage), buffer.coverage);
  }
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
