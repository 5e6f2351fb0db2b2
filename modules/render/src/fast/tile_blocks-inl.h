// SPDX-License-Identifier: BSD-3-Clause
// Which leaves of a tile its blocks of pixels have to look at. The guard toggles: Highway compiles
// a kernel file once per instruction set.
#if defined(PCL_SLIM_TILE_BLOCKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_TILE_BLOCKS_INL
#undef PCL_SLIM_TILE_BLOCKS_INL
#else
#define PCL_SLIM_TILE_BLOCKS_INL
#endif

#include <algorithm>
#include <cstring>

#include "hwy/cache_control.h"

#include "fast/fast_rasterizer.h"
#include "fast/lanes-inl.h"
#include "tiles/tiles.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlockWidth = lanes::kLanes < 4 ? lanes::kLanes : 4;  ///< pixels
constexpr int kBlockHeight = lanes::kLanes / kBlockWidth;
constexpr int kPatchSize = 8;  ///< pixels a side of the squares in which blocks share their lists

/** Rows of the tables of leaves; pixels count from the tile's corner. */
enum LeafRow : std::size_t {
  kPlaceRow,  ///< of TileLeaf, as bits
  kFirstX,    ///< circle around the picture of the ball of pass 1
  kFirstY,
  kFirstReachSq,
  kStripX,  ///< strip that contains the surface in it
  kStripY,
  kStripMiddle,
  kStripHalf,
  kFirstRows,
  kCenterX = 1,  ///< ball of pass 2, camera's axes
  kCenterY,
  kCenterZ,
  kBallRadius,
  kBlendRows,
  kBlendOfTile = kFirstRows - 1,        ///< in the tile's table the second list follows the first
  kBlendX = kBlendOfTile + kBlendRows,  ///< circle around that ball's picture
  kBlendY,
  kBlendReachSq,
  kTileRows
};

/** Pixels from (x, y) on. */
struct PixelBox {
  float x, y, width, height;  ///< from the first to the last pixel
};

/** A ball in the camera's axes. */
struct Ball {
  float x, y, z, radius;
};

/** One tile: its corner, and its leaves in its coordinates, listed by patch and by block. */
class TileBlocks {
 public:
  TileBlocks(const FrameScene& scene, std::size_t t, TileScratch& scratch)
      : scene_(scene), scratch_(scratch) {
    const auto columns = static_cast<std::size_t>(scene.tiles.columns);
    x0 = static_cast<int>(t % columns) * kTileSize;
    y0 = static_cast<int>(t / columns) * kTileSize;
    width = std::min(kTileSize, scene.view.width - x0);
    height = std::min(kTileSize, scene.view.height - y0);
    const StageTimer timer(ticks(), FrameStage::kLists);
    placeLeaves(t);
    fillTable();
  }

  /** Lists the leaves of a patch. \return whether pass 1 may meet any */
  bool beginPatch(int x, int y) {
    const StageTimer timer(ticks(), FrameStage::kLists);
    const Tag d;
    const PixelBox box = boxAt(x, y, kPatchSize, kPatchSize);
    const LeafTable& all = scratch_.tile;
    LeafTable &first = scratch_.first, &blend = scratch_.blend;
    first.reset(kFirstRows, all.count);
    blend.reset(kBlendRows, all.count);
    for (std::size_t i = 0; i < all.count; i += hn::Lanes(d)) {
      const Mask seen = And(touches(all, i, kBlendX, box), within(all, i));
      if (AllFalse(d, seen)) continue;
      take(all, i, kBlendOfTile, seen, kBlendRows, blend);
      take(all, i, 0, And(seen, mayMeet(all, i, box)), kFirstRows, first);
    }
    return first.count > 0;
  }

  /** Lists the leaves of the patch whose surface pass 1 may meet in a box, from near to far.
   * \return how many */
  std::size_t listFirst(const PixelBox& box) {
    const LeafTable& first = scratch_.first;
    return list(first, [&](std::size_t i) HWY_ATTR { return mayMeet(first, i, box); });
  }

  /** The same of those whose ball meets another. */
  std::size_t listBlend(const Ball& ball) {
    const LeafTable& blend = scratch_.blend;
    return list(blend, [&](std::size_t i) HWY_ATTR {
      const auto row = [&](std::size_t k) HWY_ATTR { return Load(Tag(), blend.row(k) + i); };
      const Vec dx = row(kCenterX) - set(ball.x), dy = row(kCenterY) - set(ball.y);
      const Vec dz = row(kCenterZ) - set(ball.z);
      const Vec reach = row(kBallRadius) + set(ball.radius);
      return dot3(dx, dy, dz, dx, dy, dz) <= reach * reach;
    });
  }

  /** The n-th leaf of the last list. */
  HWY_INLINE const TileLeaf& listed(std::size_t n) const { return scratch_.leaves[placeOf(n)]; }

  /** The place in the tile of the n-th leaf of the last list. */
  HWY_INLINE std::uint32_t placeOf(std::size_t n) const {
    std::uint32_t place;
    std::memcpy(&place, scratch_.list.row(kPlaceRow) + n, sizeof place);
    return place;
  }

  /** Where this thread's ticks are counted, if they are. */
  StageTicks* ticks() const { return scene_.timed ? &scratch_.ticks : nullptr; }

  /** Leaves on the rays of the block in work. */
  KeptRays& kept() { return scratch_.kept; }

  /** Rays that continue behind their hits, and memory for packing them. */
  std::vector<UncoveredRay>& uncovered() { return scratch_.uncovered; }
  std::vector<UncoveredRay>& packed() { return scratch_.packed; }

  static PixelBox boxAt(int x, int y, int width, int height) {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(width - 1),
            static_cast<float>(height - 1)};
  }

  int x0, y0, width, height;
  float depth = 0.0f;  ///< D of the tile, from which depths here are counted

 private:
  /** Lanes that are leaves. */
  static HWY_INLINE Mask within(const LeafTable& table, std::size_t i) {
    return FirstN(Tag(), std::min(table.count - i, hn::Lanes(Tag())));
  }

  /** Lanes whose circle, its rows from k on, touches a box. */
  static HWY_INLINE Mask touches(const LeafTable& table, std::size_t i, std::size_t k,
                                 const PixelBox& box) {
    const Tag d;
    const auto gap = [&](std::size_t axis, float from, float extent) HWY_ATTR {
      const Vec behind = Load(d, table.row(k + axis) + i) - set(from);
      return Max(Max(Neg(behind), behind - set(extent)), Zero(d));
    };
    const Vec x = gap(0, box.x, box.width), y = gap(1, box.y, box.height);
    return MulAdd(x, x, y * y) <= Load(d, table.row(k + 2) + i);
  }

  /** Lanes whose surface pass 1 may meet in a box. */
  static HWY_INLINE Mask mayMeet(const LeafTable& table, std::size_t i, const PixelBox& box) {
    const Tag d;
    const auto row = [&](std::size_t k) HWY_ATTR { return Load(d, table.row(k) + i); };
    const float half_x = 0.5f * box.width, half_y = 0.5f * box.height;
    const Vec sx = row(kStripX), sy = row(kStripY);
    const Vec from =
        MulAdd(sx, set(box.x + half_x), MulSub(sy, set(box.y + half_y), row(kStripMiddle)));
    const Vec reach = MulAdd(Abs(sx), set(half_x), MulAdd(Abs(sy), set(half_y), row(kStripHalf)));
    return And(touches(table, i, kFirstX, box), Abs(from) <= reach);
  }

  /** Appends some lanes' rows from k on to a list. */
  static HWY_INLINE void take(const LeafTable& from, std::size_t i, std::size_t k, Mask taken,
                              std::size_t rows, LeafTable& list) {
    const Tag d;
    const LanePacking packing(d, taken);
    for (std::size_t r = 0; r < rows; ++r) {
      const float* row = from.row(r == kPlaceRow ? kPlaceRow : k + r) + i;
      packing.store(Load(d, row), list.row(r) + list.count);
    }
    list.count += packing.count();
  }

  /** Lists the leaves of a table for which some(i) is true, i being the first lane. */
  template <typename Some>
  HWY_INLINE std::size_t list(const LeafTable& from, const Some& some) {
    LeafTable& list = scratch_.list;
    list.reset(1, from.count);
    for (std::size_t i = 0; i < from.count; i += hn::Lanes(Tag())) {
      const Mask taken = And(some(i), within(from, i));
      if (!AllFalse(Tag(), taken)) take(from, i, 0, taken, 1, list);
    }
    return list.count;
  }

  /** Records are in no order: they are prefetched. */
  HWY_INLINE void prefetch(std::uint32_t entry) const {
    const auto* record = reinterpret_cast<const char*>(&scene_.leaf(scene_.tiles.entries[entry]));
    for (std::size_t line = 0; line < scene_.stride; line += 64) hwy::Prefetch(record + line);
  }

  void placeLeaves(std::size_t t) {
    const FrameTiles& tiles = scene_.tiles;
    const bool perspective = scene_.view.perspective;
    scratch_.leaves.clear();
    float middle = 0.0f;  // z of the tile
    for (std::uint32_t e = tiles.begin[t]; e < tiles.begin[t + 1]; ++e) {
      prefetch(std::min(e + kAhead, tiles.begin[t + 1] - 1));
      const FrameLeaf& leaf = scene_.leaf(tiles.entries[e]);
      if (middle == 0.0f && leaf.degree != kNearLeaf) {
        middle = leaf.depth;
        depth = perspective ? -1.0f / middle : middle;
      }
      TileLeaf placed;
      placed.leaf = &leaf;
      placed.x = (static_cast<float>(x0) - leaf.x) * leaf.per_pixel;
      placed.y = (leaf.y - static_cast<float>(y0)) * leaf.per_pixel;
      // z_c / r (1 - z_c / z) at the tile's z: no difference of large numbers.
      const float behind = (middle - leaf.depth) * leaf.inverse_radius;
      placed.sigma = perspective ? behind * (leaf.depth / middle) : behind;
      placed.nearest = leaf.nearest - depth;
      scratch_.leaves.push_back(placed);
    }
  }

  void fillTable() {
    LeafTable& table = scratch_.tile;
    const std::size_t count = scratch_.leaves.size();
    table.reset(kTileRows, count);
    const float left = static_cast<float>(x0), top = static_cast<float>(y0);
    for (std::size_t i = 0; i < count; ++i) {
      const FrameLeaf& leaf = *scratch_.leaves[i].leaf;
      const auto put = [&](std::size_t k, float value) { table.row(k)[i] = value; };
      const auto place = static_cast<std::uint32_t>(i);
      std::memcpy(table.row(kPlaceRow) + i, &place, sizeof place);
      put(kFirstX, leaf.first_x - left);
      put(kFirstY, leaf.first_y - top);
      put(kFirstReachSq, leaf.first_reach * leaf.first_reach);
      put(kStripX, leaf.strip_x);
      put(kStripY, leaf.strip_y);
      const float middle = leaf.strip_x * (leaf.x - left) + leaf.strip_y * (leaf.y - top);
      put(kStripMiddle, middle + 0.5f * (leaf.strip_low + leaf.strip_high));
      put(kStripHalf, 0.5f * (leaf.strip_high - leaf.strip_low));
      put(kBlendX, leaf.blend_x - left);
      put(kBlendY, leaf.blend_y - top);
      put(kBlendReachSq, leaf.blend_reach * leaf.blend_reach);
      const Ball ball = ballOf(leaf);
      put(kBlendOfTile + kCenterX, ball.x);
      put(kBlendOfTile + kCenterY, ball.y);
      put(kBlendOfTile + kCenterZ, ball.z);
      put(kBlendOfTile + kBallRadius, ball.radius);
    }
    table.count = count;
    scratch_.kept.beginTile(count);
  }

  /** The ball of pass 2, and a little more against rounding. */
  Ball ballOf(const FrameLeaf& leaf) const {
    if (leaf.degree == kNearLeaf) return {0.0f, 0.0f, 0.0f, 1e18f};
    const FrameView& view = scene_.view;
    const float scale = view.pixel * (view.perspective ? leaf.depth : 1.0f);
    const float radius = leaf.radius * scene_.shares.blend;
    return {(leaf.x - view.center_x) * scale, (view.center_y - leaf.y) * scale, leaf.depth,
            1.001f * radius + 4e-7f * std::abs(leaf.depth)};
  }

  static constexpr std::uint32_t kAhead = 6;

  const FrameScene& scene_;
  TileScratch& scratch_;
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
