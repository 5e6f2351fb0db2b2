// SPDX-License-Identifier: BSD-3-Clause
// Which leaves and parts of leaves are connected, and how many points such a component has.
#include <algorithm>
#include <atomic>
#include <memory>
#include <numeric>
#include <utility>

#include "components/regions.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/detail/center_grid.h"
#include "pcl_slim/surface/surface_components.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kTask = 64;  ///< leaves a thread takes at a time

/** Components as trees whose root is the least leaf: threads may join in any order. */
class Forest {
 public:
  explicit Forest(std::size_t size) : parent_(size) {
    for (std::size_t i = 0; i < size; ++i)
      parent_[i].store(static_cast<std::uint32_t>(i), std::memory_order_relaxed);
  }

  std::uint32_t rootOf(std::uint32_t i) {
    for (;;) {
      std::uint32_t up = parent_[i].load(std::memory_order_relaxed);
      if (up == i) return i;
      const std::uint32_t next = parent_[up].load(std::memory_order_relaxed);
      if (next != up) parent_[i].compare_exchange_weak(up, next, std::memory_order_relaxed);
      i = next;
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = rootOf(a);
      b = rootOf(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t root = a;
      if (parent_[a].compare_exchange_strong(root, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::vector<std::atomic<std::uint32_t>> parent_;
};

/** The leaves of one level, alike in size, and all leaves as fine or finer, which look for
 * neighbours among them. */
struct LevelGrid {
  std::unique_ptr<CenterGrid> grid;
  std::vector<CenterGrid::Entry> seekers;  ///< in order of the grid's cells
  float widest = 0;
};

std::vector<LevelGrid> levelGrids(const SLIMSurface& s, int threads) {
  std::vector<std::vector<std::uint32_t>> members(256);
  for (const std::uint32_t i : s.leaves()) members[s.level[i]].push_back(i);
  std::vector<LevelGrid> levels(members.size());
  parallelFor(levels.size(), threads, 1, [&](std::size_t k, int) {
    if (members[k].empty()) return;
    LevelGrid& level = levels[k];
    for (const std::uint32_t i : members[k]) level.widest = std::max(level.widest, s.radius[i]);
    std::vector<std::uint32_t> seekers;
    float reach = level.widest;
    for (std::uint32_t i = 0; i < s.size(); ++i) {
      if (!s.isLeaf(i) || s.level[i] < k) continue;
      seekers.push_back(i);
      reach = std::max(reach, s.radius[i]);
    }
    level.grid = std::make_unique<CenterGrid>(s, members[k], level.widest + reach);
    level.seekers = level.grid->sortedByCell(s, seekers);
  });
  return levels;
}

/** Joins the regions of leaves whose sheets overlap. */
class Joiner {
 public:
  Joiner(const SLIMSurface& surface, const Regions& regions, const LevelGrid& level, Forest& forest)
      : surface_(surface), regions_(regions), level_(level), forest_(forest), walk_(*level.grid) {}

  void join(const CenterGrid::Entry& seeker) {
    const auto [cell, i] = seeker;
    const float center[3] = {surface_.cx[i], surface_.cy[i], surface_.cz[i]};
    const float reach = surface_.radius[i] + level_.widest;
    level_.grid->findWithin(walk_.around(cell), center, reach * reach, near_);
    bool has_places = false;
    for (std::size_t k = 0; k < near_.count; ++k) {
      const std::uint32_t j = level_.grid->memberAt(near_.places[k]);
      const float apart = surface_.radius[i] + surface_.radius[j];
      if (j == i || !(near_.distances_sq[k] < apart * apart) || areOne(i, j)) continue;
      if (!has_places) Sheet(surface_, regions_, i).placesOf(places_);
      has_places = true;
      const Sheet other(surface_, regions_, j);
      for (const SheetPlace& place : places_) {
        const std::uint32_t region = other.regionAt(place.position);
        if (region != Regions::kOutside) forest_.join(region, place.region);
      }
    }
  }

 private:
  /** Whether all regions of two leaves are connected already: most leaves soon are. */
  bool areOne(std::uint32_t i, std::uint32_t j) {
    if (regions_.begin(i) == regions_.end(i) || regions_.begin(j) == regions_.end(j)) return true;
    const std::uint32_t root = forest_.rootOf(regions_.begin(i));
    for (const std::uint32_t leaf : {i, j}) {
      for (std::uint32_t r = regions_.begin(leaf); r < regions_.end(leaf); ++r)
        if (forest_.rootOf(r) != root) return false;
    }
    return true;
  }

  const SLIMSurface& surface_;
  const Regions& regions_;
  const LevelGrid& level_;
  Forest& forest_;
  CenterGrid::Walk walk_;
  CenterGrid::Near near_;
  std::vector<SheetPlace> places_;
};

/** The components of a surface's regions, and about how many points each has. */
class Components {
 public:
  /** \param[in] enough points from which on a lower bound is as good as their number */
  Components(const SLIMSurface& surface, const Regions& regions, double enough, int threads)
      : surface_(surface), regions_(regions) {
    Forest forest(regions.count());
    for (const LevelGrid& level : levelGrids(surface, threads)) {
      if (!level.grid) continue;
      const std::size_t tasks = (level.seekers.size() + kTask - 1) / kTask;
      parallelFor(tasks, threads, 1, [&](std::size_t task, int) {
        Joiner joiner(surface, regions, level, forest);
        const std::size_t end = std::min((task + 1) * kTask, level.seekers.size());
        for (std::size_t at = task * kTask; at < end; ++at) joiner.join(level.seekers[at]);
      });
    }
    number(forest);
    points_.resize(leaves_.size());
    parallelFor(leaves_.size(), threads, kTask, [&](std::size_t k, int) {
      points_[k] = pointsOf(static_cast<std::uint32_t>(k), enough);
    });
  }

  std::size_t count() const { return points_.size(); }
  double points(std::size_t component) const { return points_[component]; }
  std::uint32_t of(std::uint32_t region) const { return of_region_[region]; }
  std::size_t largest() const {
    return static_cast<std::size_t>(std::max_element(points_.begin(), points_.end()) -
                                    points_.begin());
  }

 private:
  void number(Forest& forest) {
    of_region_.resize(regions_.count());
    for (const std::uint32_t i : surface_.leaves()) {
      for (std::uint32_t r = regions_.begin(i); r < regions_.end(i); ++r) {
        const std::uint32_t root = forest.rootOf(r);  // the first region, before all others
        if (root == r) {
          of_region_[r] = static_cast<std::uint32_t>(leaves_.size());
          leaves_.emplace_back();
        }
        const std::uint32_t own = of_region_[r] = of_region_[root];
        if (leaves_[own].empty() || leaves_[own].back() != i) leaves_[own].push_back(i);
      }
    }
  }

  /** Points that several leaves have count once: of each leaf those of the share of its sheet that
   * no leaf before it has. */
  double pointsOf(std::uint32_t component, double enough) const {
    double points = 0;
    std::vector<Sheet> before;
    std::vector<SheetPlace> places;
    for (const std::uint32_t i : leaves_[component]) {
      const Sheet sheet(surface_, regions_, i);
      sheet.placesOf(places);
      const auto own = std::count_if(places.begin(), places.end(), [&](const SheetPlace& place) {
        return of_region_[place.region] == component &&
               std::none_of(before.begin(), before.end(), [&](const Sheet& other) {
                 return other.regionAt(place.position) != Regions::kOutside;
               });
      });
      if (!places.empty())
        points +=
            sheet.numPoints(places) * static_cast<double>(own) / static_cast<double>(places.size());
      if (points >= enough) return points;
      before.push_back(sheet);
    }
    return points;
  }

  const SLIMSurface& surface_;
  const Regions& regions_;
  std::vector<std::uint32_t> of_region_;
  std::vector<std::vector<std::uint32_t>> leaves_;  ///< of each component
  std::vector<double> points_;
};

/** Whether a leaf's ball reaches into one of some boxes. */
bool reachesInto(const SLIMSurface& s, std::uint32_t leaf,
                 const std::vector<std::array<std::array<double, 3>, 2>>& boxes) {
  const double r = s.info.scale * s.radius[leaf];
  const Vector3 center = along(s.info.origin, s.info.scale, {s.cx[leaf], s.cy[leaf], s.cz[leaf]});
  return std::any_of(boxes.begin(), boxes.end(), [&](const auto& box) {
    bool meets = true;
    for (std::size_t a = 0; a < 3; ++a)
      meets = meets && center[a] + r >= box[0][a] && center[a] - r <= box[1][a];
    return meets;
  });
}

template <typename T>
void keepRows(const std::vector<std::uint32_t>& kept, std::size_t width, std::vector<T>& column) {
  for (std::size_t to = 0; to < kept.size(); ++to)
    std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(kept[to] * width), width,
                column.begin() + static_cast<std::ptrdiff_t>(to * width));
  column.resize(kept.size() * width);
}

struct TrimBits {
  std::vector<std::uint8_t> sides, bits;
};

/** The trim maps of some surfels without the regions that do not stay. */
TrimBits keptMaps(const SLIMSurface& s, const std::vector<std::uint32_t>& kept,
                  const Regions& regions, const std::vector<bool>& region_stays) {
  TrimBits maps;
  for (const std::uint32_t i : kept) {
    const TrimMap map = s.trimMap(i);
    maps.sides.push_back(static_cast<std::uint8_t>(map.side));
    if (map.closed()) continue;
    const std::size_t begin = maps.bits.size();
    maps.bits.insert(maps.bits.end(), map.bits, map.bits + TrimMap::numBytes(map.side));
    if (!s.isLeaf(i) || regions.end(i) - regions.begin(i) < 2) continue;
    for (int k = 0; k < map.side * map.side; ++k) {
      const std::uint32_t region = regions.at(i, k);
      if (region != Regions::kOutside && !region_stays[region])
        maps.bits[begin + static_cast<std::size_t>(k >> 3)] &=
            static_cast<std::uint8_t>(~(1 << (k & 7)));
    }
  }
  return maps;
}

/** Which surfels stay where some leaves do not: internal ones with a child that stays, or without
 * any. */
std::vector<std::uint32_t> keptSurfels(const SLIMSurface& s, std::vector<bool> stays) {
  std::vector<std::uint32_t> order(s.size()), kept;
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return s.level[a] > s.level[b]; });
  for (const std::uint32_t i : order) {
    if (s.isLeaf(i) || s.child_begin.empty()) continue;
    const std::uint32_t begin = s.child_begin[i], end = s.child_begin[i + 1];
    stays[i] = begin == end;
    for (std::uint32_t k = begin; k < end; ++k) stays[i] = stays[i] || stays[s.children[k]];
  }
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    if (stays[i]) kept.push_back(i);
  }
  return kept;
}

/** Keeps the textures of some surfels. */
void keepTextures(const std::vector<std::uint32_t>& kept, SLIMSurface& s) {
  std::vector<std::uint8_t> sides, texels;
  for (const std::uint32_t i : kept) {
    const SurfelTexture texture = s.texture(i);
    sides.push_back(static_cast<std::uint8_t>(texture.side));
    texels.insert(texels.end(), texture.rgb, texture.rgb + SurfelTexture::numBytes(texture.side));
  }
  s.setTextures(sides, texels);
}

/** Removes regions, the leaves that have no other and what they leave empty. \return the number of
 * leaves removed. */
std::uint64_t dropRegions(const Regions& regions, const std::vector<bool>& region_stays,
                          int threads, SLIMSurface& s) {
  std::vector<bool> stays(s.size(), true);
  std::uint64_t dropped = 0;
  for (const std::uint32_t i : s.leaves()) {
    bool any = regions.begin(i) == regions.end(i);
    for (std::uint32_t r = regions.begin(i); r < regions.end(i); ++r) any = any || region_stays[r];
    stays[i] = any;
    dropped += any ? 0 : 1;
  }
  const std::vector<std::uint32_t> kept = keptSurfels(s, std::move(stays));
  const TrimBits maps = keptMaps(s, kept, regions, region_stays);
  if (s.hasColors()) keepRows(kept, kColorBytes, s.colors);
  for (auto* column :
       {&s.cx, &s.cy, &s.cz, &s.radius, &s.nx, &s.ny, &s.nz, &s.error, &s.effective_count})
    keepRows(kept, 1, *column);
  for (auto* column : {&s.degree, &s.level, &s.flags}) keepRows(kept, 1, *column);
  keepRows(kept, static_cast<std::size_t>(s.stride()), s.coefficients);
  s.setTrimMaps(maps.sides, maps.bits);
  if (s.hasTextures()) keepTextures(kept, s);
  if (!s.child_begin.empty()) s.buildLinks(threads);
  return dropped;
}

}  // namespace

DroppedComponents dropComponents(
    double min_points, SLIMSurface& surface, int threads,
    const std::vector<std::array<std::array<double, 3>, 2>>& unloaded) {
  DroppedComponents dropped;
  if (!(min_points > 0) || surface.empty()) return dropped;
  threads = resolveThreads(threads);
  const Regions regions(surface, threads);
  const Components components(surface, regions, min_points, threads);
  dropped.kept = components.count();
  if (dropped.kept < 2) return dropped;
  std::vector<bool> stays(components.count());
  for (std::size_t k = 0; k < stays.size(); ++k) stays[k] = components.points(k) >= min_points;
  stays[components.largest()] = true;
  for (const std::uint32_t i : surface.leaves()) {
    if (unloaded.empty() || !reachesInto(surface, i, unloaded)) continue;
    for (std::uint32_t r = regions.begin(i); r < regions.end(i); ++r)
      stays[components.of(r)] = true;
  }
  dropped.kept = static_cast<std::uint64_t>(std::count(stays.begin(), stays.end(), true));
  bool any = false;
  for (std::size_t k = 0; k < stays.size(); ++k) {
    if (stays[k]) continue;
    any = true;
    if (components.points(k) > 0) ++dropped.components;  // others exist in no ball
    dropped.points += components.points(k);
  }
  if (!any) return dropped;
  std::vector<bool> region_stays(regions.count());
  for (std::uint32_t r = 0; r < regions.count(); ++r) region_stays[r] = stays[components.of(r)];
  dropped.leaves = dropRegions(regions, region_stays, threads, surface);
  return dropped;
}

}  // namespace pcl_slim
