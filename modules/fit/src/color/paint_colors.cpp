// SPDX-License-Identifier: BSD-3-Clause
// Colours of another cloud than the one that a surface was fitted to.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "color/color_fit.h"
#include "color/surfel_sheet.h"
#include "pcl_slim/cloud/outliers.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surfel_color.h"
#include "scan/ball_kernels.h"
#include "trim/trim.h"

namespace pcl_slim {

namespace {

constexpr float kMostDistance = 0.5f;  ///< [radii] points farther from every leaf are left out
/// [radii] Leaves cover the scan's points up to 2/3; other points may be between these.
constexpr float kReach = 0.8f;
constexpr char kSpread = 2;  ///< a leaf that has the colour of points around it
constexpr std::uint64_t kNoLeaf = ~std::uint64_t{0};
constexpr double kLeastShare =
    0.5;  ///< of its leaves: with fewer painted ones a node keeps its colour

/** Units of the surface, and the cube that contains its balls: points outside have no leaf. */
StoreFrame frameOf(const SLIMSurface& surface) {
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::max());
  high.fill(std::numeric_limits<double>::lowest());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double r = surface.radius[i], center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], center[a] - r);
      high[a] = std::max(high[a], center[a] + r);
    }
  }
  StoreFrame frame;
  frame.origin = surface.info.origin;
  frame.scale = surface.info.scale;
  frame.diagonal = frame.bulk_diagonal = surface.info.diagonal;
  frame.bulk_reach = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    frame.bulk_center[a] = frame.origin[a] + frame.scale * 0.5 * (low[a] + high[a]);
    frame.bulk_reach = std::max(frame.bulk_reach, frame.scale * 0.5 * (high[a] - low[a]));
  }
  frame.bulk_between = frame.bulk_reach;
  return frame;
}

/** The points near the surface's box, in its units; with the cloud's normals if there are any. */
Result<PointStore> storeNear(CloudView cloud, const SLIMSurface& surface, int threads) {
  StoreFrame frame = frameOf(surface);
  frame.with_normals = cloud.normal != nullptr;
  Result<PointStore> store = PointStore::build(cloud, frame, threads);
  if (store || !frame.with_normals) return store;
  frame.with_normals = false;
  cloud.normal = nullptr;
  return PointStore::build(cloud, frame, threads);
}

/** Calls body(leaf, memory of its thread) for every leaf. */
template <typename Body>
void forLeaves(const SLIMSurface& surface, int threads, const Body& body) {
  std::vector<detail::SurfelSheet> memory(static_cast<std::size_t>(threads));
  parallelFor(surface.size(), threads, 64, [&](std::size_t i, int thread) {
    if (surface.isLeaf(i)) body(i, memory[static_cast<std::size_t>(thread)]);
  });
}

/** For each stored point, the leaf whose polynomial is nearest to it. */
class NearestLeaves {
 public:
  NearestLeaves(const PointStore& store, const SLIMSurface& surface)
      : store_(store), surface_(surface), nearest_(store.size()) {}

  /** Searches all leaves. \param[in] facing only those that face a point's own normal */
  void find(bool facing, int threads) {
    for (auto& entry : nearest_) entry.store(kNoLeaf, std::memory_order_relaxed);
    forLeaves(surface_, threads, [&](std::size_t i, detail::SurfelSheet& memory) {
      add(i, memory.gather(store_, surface_, i, {1.0f, facing, kMostDistance}));
    });
  }

  /** \return the leaf of point p; the surface's size where none is near */
  std::size_t of(std::size_t p) const {
    const std::uint64_t entry = nearest_[p].load(std::memory_order_relaxed);
    return entry == kNoLeaf ? surface_.size() : static_cast<std::size_t>(entry & 0xffffffffu);
  }

 private:
  void add(std::size_t i, const detail::SheetPoints& points) {
    const int degree = surface_.degree[i];
    const float* const c = surface_.coefficientsOf(i);
    for (std::size_t k = 0; k < points.count; ++k) {
      const float u = points.u[k], v = points.v[k];
      if (u * u + v * v > kReach * kReach) continue;
      const double off = points.w[k] - evaluateHeight(degree, c, u, v);
      const auto distance = static_cast<float>(surface_.radius[i] * std::abs(off));
      std::uint32_t bits;
      std::memcpy(&bits, &distance, sizeof bits);  // ordered as the numbers are
      lower(nearest_[points.index[k]], std::uint64_t{bits} << 32 | i);
    }
  }

  static void lower(std::atomic<std::uint64_t>& least, std::uint64_t entry) {
    std::uint64_t known = least.load(std::memory_order_relaxed);
    while (entry < known && !least.compare_exchange_weak(known, entry, std::memory_order_relaxed)) {
    }
  }

  const PointStore& store_;
  const SLIMSurface& surface_;
  std::vector<std::atomic<std::uint64_t>> nearest_;  ///< bits of the distance, then the leaf
};

/** Whether most points that are near a leaf have a normal that opposes it. */
bool normalsOppose(const PointStore& store, const SLIMSurface& surface,
                   const NearestLeaves& leaves) {
  std::size_t facing = 0, opposing = 0;
  for (std::size_t p = 0; p < store.size(); ++p) {
    const std::size_t i = leaves.of(p);
    if (i == surface.size()) continue;
    const auto n = store.normal(p);
    ++(n[0] * surface.nx[i] + n[1] * surface.ny[i] + n[2] * surface.nz[i] > 0 ? facing : opposing);
  }
  return opposing > facing;
}

/** A point's foot on a leaf, along the leaf's normal. */
Vector3 footOn(const SLIMSurface& s, std::size_t i, const Vector3& place) {
  const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
  const double r = s.radius[i];
  const Vector3 offset = scaled(subtract(place, Vector3{s.cx[i], s.cy[i], s.cz[i]}), 1 / r);
  const double u = dot(offset, frame.u), v = dot(offset, frame.v), w = dot(offset, frame.w);
  return along(place, r * (evaluateHeight(s.degree[i], s.coefficientsOf(i), u, v) - w), frame.w);
}

/** Moves points onto their nearest leaves, gives them the sides of an oriented surface, and drops
 * the others. \return how many are left; 0: the store is as it was */
std::size_t moveToLeaves(const SLIMSurface& surface, const NearestLeaves& leaves, int threads,
                         PointStore& store) {
  std::vector<Vector3> feet(store.size());
  std::vector<std::array<float, 3>> sides(store.size());
  std::vector<std::uint32_t> dropped;
  for (std::size_t p = 0; p < store.size(); ++p) {
    const std::size_t i = leaves.of(p);
    feet[p] = store.position(p);
    if (i == surface.size()) {
      dropped.push_back(static_cast<std::uint32_t>(p));
      continue;
    }
    feet[p] = footOn(surface, i, feet[p]);
    sides[p] = {surface.nx[i], surface.ny[i], surface.nz[i]};
  }
  if (dropped.size() == store.size()) return 0;
  store.dropNormals();
  store.moveTo(feet, threads);
  if (surface.info.oriented) store.setSides(sides);
  if (!dropped.empty()) store.drop(dropped, threads);
  return store.size();
}

/** Which leaves have points, moved onto the surface, that their colours follow from. */
std::vector<char> paintedLeaves(const PointStore& store, const SLIMSurface& surface, int threads) {
  // At the end of the points a leaf that has colours keeps them unless points reach its middle
  // part.
  const float reach = surface.hasColors() ? SurfelTexture::kReach : 1.0f;
  std::vector<char> painted(surface.size(), 0);
  forLeaves(surface, threads, [&](std::size_t i, detail::SurfelSheet& memory) {
    // Points farther from the polynomial are of other sheets, as fitColors() has it.
    const double gate = std::max(detail::kLeastErrorGate,
                                 detail::kErrorGate * surface.error[i] / surface.radius[i]);
    const auto& points =
        memory.gather(store, surface, i, {1.0f, store.hasSides(), static_cast<float>(gate)});
    for (std::size_t k = 0; k < points.count && painted[i] == 0; ++k) {
      const float u = points.u[k], v = points.v[k];
      painted[i] = u * u + v * v < reach * reach ? 1 : 0;
    }
  });
  return painted;
}

/** A leaf without points of its own, and the colour of those around. */
struct SpreadColor {
  std::size_t leaf = 0;
  std::array<std::uint8_t, 3> rgb{};
  bool known = false;
};

/** The colour of the points within a reach of a leaf's centre and on its side, the nearer the
 * more. */
SpreadColor colorAround(const PointStore& store, const detail::ColorColumns& columns,
                        const SLIMSurface& s, std::size_t i, float reach,
                        std::vector<std::uint32_t>& blocks) {
  const float center[3] = {s.cx[i], s.cy[i], s.cz[i]};
  blocks.clear();
  store.tree().blocksInBall(center, reach, blocks);
  double sum[3] = {}, total = 0;
  for (const std::uint32_t block : blocks) {
    const std::size_t begin = block * PointStore::kBlock,
                      end = std::min(store.size(), begin + PointStore::kBlock);
    for (std::size_t p = begin; p < end; ++p) {
      const auto place = store.position(p);
      const double x = place[0] - center[0], y = place[1] - center[1], z = place[2] - center[2];
      const double distance_sq = x * x + y * y + z * z, reach_sq = double{reach} * reach;
      if (distance_sq >= reach_sq) continue;
      const auto n =
          store.hasSides() ? store.normal(p) : std::array<float, 3>{s.nx[i], s.ny[i], s.nz[i]};
      if (!(n[0] * s.nx[i] + n[1] * s.ny[i] + n[2] * s.nz[i] > 0)) continue;
      const double weight = 1 / (distance_sq + 1e-3 * reach_sq);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * columns[c][p];
      total += weight;
    }
  }
  SpreadColor color;
  color.leaf = i;
  color.known = total > 0;
  for (std::size_t c = 0; c < 3 && color.known; ++c)
    color.rgb[c] = static_cast<std::uint8_t>(std::lround(sum[c] / total));
  return color;
}

/** Gives leaves that are smaller than the spacing of the points, and contain none, the colours of
 * those around. \param[in,out] painted leaves that have colours of the points */
void spreadColors(const PointStore& store, const detail::ColorColumns& columns, int threads,
                  SLIMSurface& surface, std::vector<char>& painted) {
  const auto reach = static_cast<float>(medianSpacing(store));
  std::vector<std::size_t> bare;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i) && painted[i] == 0 && surface.radius[i] < reach) bare.push_back(i);
  }
  if (bare.empty()) return;
  std::vector<SpreadColor> colors(bare.size());
  std::vector<std::vector<std::uint32_t>> blocks(static_cast<std::size_t>(threads));
  parallelFor(bare.size(), threads, 64, [&](std::size_t k, int thread) {
    colors[k] = colorAround(store, columns, surface, bare[k], reach,
                            blocks[static_cast<std::size_t>(thread)]);
  });
  if (!surface.hasColors()) surface.colors = detail::greyColors(surface.size());
  std::vector<std::uint8_t> sides(surface.size(), 0), texels;
  for (const SpreadColor& color : colors) {
    if (!color.known) continue;
    std::uint8_t* const bytes = surface.colors.data() + color.leaf * kColorBytes;
    std::fill_n(bytes, kColorBytes, std::uint8_t{0});
    std::copy(color.rgb.begin(), color.rgb.end(), bytes);
    painted[color.leaf] = kSpread;
  }
  if (!surface.hasTextures()) return;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const SurfelTexture texture = surface.texture(i);
    if (texture.empty() || painted[i] == kSpread) continue;
    sides[i] = static_cast<std::uint8_t>(texture.side);
    texels.insert(texels.end(), texture.rgb, texture.rgb + SurfelTexture::numBytes(texture.side));
  }
  surface.setTextures(sides, texels);
}

/** Which surfels keep their colours: leaves that are not painted, and nodes above too few that
 * are. */
std::vector<char> keptColors(const SLIMSurface& surface, const std::vector<char>& painted) {
  std::vector<std::uint32_t> finest_first(surface.size());
  for (std::uint32_t i = 0; i < surface.size(); ++i) finest_first[i] = i;
  std::stable_sort(finest_first.begin(), finest_first.end(), [&](std::uint32_t a, std::uint32_t b) {
    return surface.level[a] > surface.level[b];
  });
  std::vector<double> share(surface.size(), 0.0);  // of the leaves below that are painted
  for (const std::uint32_t i : finest_first) {
    if (surface.isLeaf(i)) {
      share[i] = painted[i] != 0 ? 1 : 0;
      continue;
    }
    if (surface.child_begin.empty()) continue;
    const std::uint32_t begin = surface.child_begin[i], end = surface.child_begin[i + 1];
    for (std::uint32_t k = begin; k < end; ++k)
      share[i] += share[surface.children[k]] / (end - begin);
  }
  std::vector<char> keeps(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i)
    keeps[i] = share[i] < kLeastShare || painted[i] == kSpread ? 1 : 0;
  return keeps;
}

}  // namespace

Result<PaintStatistics> paintColors(const CloudView& cloud, const ColorView& colors, int threads,
                                    SLIMSurface& surface) {
  if (colors.bgr == nullptr)
    return badInput(
        "the cloud to paint with has no colours: give one with rgb, rgba or red green blue");
  if (surface.empty()) return badInput("there is no surface to paint: fit one first");
  threads = resolveThreads(threads);
  PaintStatistics statistics;
  statistics.leaves = surface.numLeaves();
  if (Error error = cloud.validate()) return error;
  Result<PointStore> store = storeNear(cloud, surface, threads);
  if (store) {
    NearestLeaves nearest(*store, surface);
    nearest.find(false, threads);
    if (store->hasNormals() && surface.info.oriented) {
      statistics.normals_opposed = normalsOppose(*store, surface, nearest);
      if (!statistics.normals_opposed) nearest.find(true, threads);
    }
    statistics.points = moveToLeaves(surface, nearest, threads, *store);
  }
  if (statistics.points == 0) {
    return badInput(
        "no point of the cloud to paint with is near the surface: register both in the same "
        "coordinates and units");
  }
  const detail::ColorColumns columns = detail::colorsInStoreOrder(*store, cloud, colors, threads);
  std::vector<char> painted = paintedLeaves(*store, surface, threads);
  spreadColors(*store, columns, threads, surface, painted);
  for (const char is_painted : painted) statistics.painted += is_painted != 0 ? 1 : 0;
  detail::fitStoredColors(*store, columns, keptColors(surface, painted), threads, surface);
  return statistics;
}

}  // namespace pcl_slim
