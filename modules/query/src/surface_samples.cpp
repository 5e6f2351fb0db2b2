// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/random.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** \brief Points with a side. */
struct SidedPoints {
  std::vector<std::array<double, 3>> position;
  std::vector<std::array<float, 3>> normal;
  bool oriented = false;  ///< points that face apart do not count as near
};

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::size_t kBatch = 8192;  ///< points that are tried side by side

std::uint64_t mixed(std::uint64_t bits) {
  return SplitMix{bits}.next();
}

/** Chosen points in cells as wide as the spacing, found by a hash of the cell. */
class CellTable {
 public:
  CellTable(const SidedPoints& points, double spacing)
      : points_(points), spacing_(spacing), next_(points.position.size(), kNone) {
    std::size_t slots = 1024;
    while (slots < points.position.size() / 4) slots *= 2;
    heads_.assign(slots, kNone);
  }

  void add(std::uint32_t i) {
    std::uint32_t& head = heads_[slotOf(cellOf(i))];
    next_[i] = head;
    head = i;
  }

  /** The nearest chosen point nearer than twice the spacing that is not i itself, of those in the
   * cells around: surely found if it is nearer than the spacing. */
  std::pair<std::uint32_t, double> nearest(std::uint32_t i, double bound) const {
    std::pair<std::uint32_t, double> best{kNone, bound * bound};
    const auto cell = cellOf(i);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const std::size_t slot = slotOf({cell[0] + x, cell[1] + y, cell[2] + z});
          for (std::uint32_t j = heads_[slot]; j != kNone; j = next_[j]) {
            const double d = squaredDistance(i, j);
            if (j != i && d < best.second && face(i, j)) best = {j, d};
          }
        }
      }
    }
    return best;
  }

 private:
  std::array<std::int64_t, 3> cellOf(std::uint32_t i) const {
    std::array<std::int64_t, 3> cell;
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] = static_cast<std::int64_t>(std::floor(points_.position[i][a] / spacing_));
    return cell;
  }

  std::size_t slotOf(const std::array<std::int64_t, 3>& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cell) hash = mixed(hash ^ static_cast<std::uint64_t>(c));
    return static_cast<std::size_t>(hash) & (heads_.size() - 1);
  }

  double squaredDistance(std::uint32_t i, std::uint32_t j) const {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = points_.position[i][a] - points_.position[j][a];
      sum += d * d;
    }
    return sum;
  }

  bool face(std::uint32_t i, std::uint32_t j) const {
    if (!points_.oriented) return true;
    const auto &m = points_.normal[i], &n = points_.normal[j];
    return m[0] * n[0] + m[1] * n[1] + m[2] * n[2] > 0.0f;
  }

  const SidedPoints& points_;
  double spacing_;
  std::vector<std::uint32_t> heads_, next_;
};

/** \brief A maximal set of points of which no two are nearer than the spacing, ascending. The
 * points are taken in an order that the seed makes. O(points); the same for any number of threads.
 */
std::vector<std::uint32_t> poissonSet(const SidedPoints& points, double spacing, std::uint64_t seed,
                                      int threads) {
  const std::size_t n = points.position.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(n);
  for (std::uint32_t i = 0; i < n; ++i) order[i] = {mixed(mixed(seed) ^ i), i};
  std::sort(order.begin(), order.end());
  CellTable chosen(points, spacing);
  std::vector<std::uint32_t> set;
  std::vector<std::uint8_t> free(kBatch);
  for (std::size_t begin = 0; begin < n; begin += kBatch) {
    // Most points are too near to one of an earlier batch; the few others are tried again in their
    // order.
    const std::size_t count = std::min(kBatch, n - begin);
    parallelFor(count, threads, 256, [&](std::size_t k, int) {
      free[k] = chosen.nearest(order[begin + k].second, spacing).first == kNone;
    });
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = order[begin + k].second;
      if (free[k] == 0 || chosen.nearest(i, spacing).first != kNone) continue;
      chosen.add(i);
      set.push_back(i);
    }
  }
  std::sort(set.begin(), set.end());
  return set;
}

/** \brief Thins a set to a given size by leaving out samples: those nearest to another, one of each
 * pair first. O(set). */
void thinSet(const SidedPoints& points, double spacing, std::size_t count,
             std::vector<std::uint32_t>& set) {
  if (set.size() <= count) return;
  CellTable chosen(points, spacing);
  for (const std::uint32_t i : set) chosen.add(i);
  struct Neighbor {
    double distance;
    std::uint32_t point, nearest;
  };
  std::vector<Neighbor> neighbors;
  for (const std::uint32_t i : set) {
    const auto [j, distance] = chosen.nearest(i, 2 * spacing);
    neighbors.push_back({distance, i, j});
  }
  std::stable_sort(neighbors.begin(), neighbors.end(),
                   [](const Neighbor& a, const Neighbor& b) { return a.distance < b.distance; });
  std::vector<std::uint8_t> gone(points.position.size(), 0);
  std::size_t left = set.size();
  for (const bool pairs : {true, false}) {
    for (const Neighbor& n : neighbors) {
      const bool widowed = n.nearest != kNone && gone[n.nearest] != 0;
      if (left == count || gone[n.point] != 0 || (pairs && widowed)) continue;
      gone[n.point] = 1;
      --left;
    }
  }
  set.erase(std::remove_if(set.begin(), set.end(), [&](std::uint32_t i) { return gone[i] != 0; }),
            set.end());
}

constexpr double kStep = 0.5;         ///< of the spacing: spacing of the candidates' nodes
constexpr double kReach = 0.5;        ///< of a ball's radius; see ProjectionParams
constexpr double kMostNodes = 4e8;    ///< candidates that memory is spent on
constexpr double kFirstCount = 4000;  ///< samples of the first trial for a count
constexpr double kSurplus = 1.03;     ///< samples over the count, at most, that are thinned
constexpr int kMostTrials = 12;
constexpr std::size_t kRun = 64;  ///< surfels a thread takes at a time; no result depends on it

/** Half the width of a leaf's (u, v) square that is sampled, in radii: beyond its cover other
 * leaves sample. */
double halfWidth(const SurfaceInfo& info) {
  return std::min(1.0, 1.1 * info.cover_radius);
}

/** Nodes along a side of the square of leaf i; one of three is its centre. */
std::int64_t sideOf(const SLIMSurface& surface, std::size_t i, double step) {
  const double steps = 2 * halfWidth(surface.info) * surface.radius[i] / step;
  return std::max<std::int64_t>(3, static_cast<std::int64_t>(steps) + 2);
}

/** Candidates of one leaf, in world coordinates. \param[in] step local length */
void appendNodes(const SLIMSurface& surface, std::size_t i, double step, std::vector<double>& xyz) {
  const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
  const double r = surface.radius[i], reach = halfWidth(surface.info);
  const double center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
  const TrimMap map = surface.trimMap(i);
  const std::int64_t side = sideOf(surface, i, step);
  const double pitch = 2 * reach / static_cast<double>(side - 1);
  for (std::int64_t k = 0; k < side * side; ++k) {
    const std::int64_t row = k / side;
    const double u = pitch * static_cast<double>(k % side) - reach;
    const double v = pitch * static_cast<double>(row) - reach;
    if (u * u + v * v > reach * reach) continue;
    if (surface.isOpen(i) && outsideShare(map, u, v) > 0.5) continue;
    const double h = evaluateHeight(surface.degree[i], surface.coefficientsOf(i), u, v);
    if (!(u * u + v * v + h * h < 1.0)) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const double local = center[a] + r * (u * frame.u[a] + v * frame.v[a] + h * frame.w[a]);
      xyz.push_back(surface.info.origin[a] + surface.info.scale * local);
    }
  }
}

Error checkNodes(const SLIMSurface& surface, double step) {
  double nodes = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double side = 2 * halfWidth(surface.info) * surface.radius[i] / step + 3;
    if (surface.isLeaf(i)) nodes += side * side;
  }
  if (nodes < kMostNodes) return {};
  return {ErrorCode::kBadArgument, "so dense a sampling takes too much memory: raise the spacing"};
}

/** Candidates on the blended surface, inside its borders. */
struct Candidates {
  SidedPoints points;
  std::vector<std::array<float, 2>> curvature;
};

Error makeCandidates(const SLIMSurface& surface, double spacing, int threads, Progress* progress,
                     Candidates& made) {
  const double step = kStep * spacing / surface.info.scale;
  if (Error error = checkNodes(surface, step)) return error;
  std::vector<std::vector<double>> runs((surface.size() + kRun - 1) / kRun);
  parallelFor(runs.size(), threads, 1, [&](std::size_t run, int) {
    for (std::size_t i = run * kRun; i < std::min(surface.size(), (run + 1) * kRun); ++i) {
      if (surface.isLeaf(i)) appendNodes(surface, i, step, runs[run]);
    }
  });
  std::vector<double> xyz;
  for (const auto& run : runs) xyz.insert(xyz.end(), run.begin(), run.end());
  made = Candidates();
  if (xyz.empty()) return {};
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = xyz.size() / 3;
  const Result<PointStore> store = PointStore::build(view, threads);
  if (!store) return store.error();
  ProjectionParams params;
  params.curvature = true;
  params.reach = kReach;
  params.threads = threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, params, projection, progress)) return error;
  made.points.oriented = surface.info.oriented;
  const double scale = store->scale();
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (!projection.supported[i] || !projection.inside[i]) continue;
    std::array<double, 3> world;
    for (std::size_t a = 0; a < 3; ++a)
      world[a] = store->origin()[a] + scale * projection.position[i][a];
    made.points.position.push_back(world);
    made.points.normal.push_back(projection.normal[i]);
    const auto& [mean, gaussian] = projection.curvature[i];
    made.curvature.push_back(
        {static_cast<float>(mean / scale), static_cast<float>(gaussian / scale / scale)});
  }
  return {};
}

/** A spacing that gives about the wanted number of samples, from the area of the leaves. */
double guessSpacing(const SLIMSurface& surface, double count) {
  double area = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) area += surface.radius[i] * double{surface.radius[i]};
  }
  return surface.info.scale * std::sqrt(area / count);
}

void take(const Candidates& candidates, const std::vector<std::uint32_t>& set, double spacing,
          SurfaceSamples& samples) {
  samples.spacing = spacing;
  samples.candidates = candidates.curvature.size();
  for (const std::uint32_t i : set) {
    samples.position.push_back(candidates.points.position[i]);
    samples.normal.push_back(candidates.points.normal[i]);
    samples.curvature.push_back(candidates.curvature[i]);
  }
}

Error noArea() {
  return badInput(
      "the surface has no area inside its borders at this spacing, as where the points lie along "
      "lines: "
      "give a smaller spacing, or a scan of a surface");
}

Error sampleSpacing(const SLIMSurface& surface, const SurfaceSampleParams& params, int threads,
                    Progress* progress, SurfaceSamples& samples) {
  Candidates candidates;
  if (Error error = makeCandidates(surface, params.spacing, threads, progress, candidates))
    return error;
  if (candidates.curvature.empty()) return noArea();
  take(candidates, poissonSet(candidates.points, params.spacing, params.seed, threads),
       params.spacing, samples);
  return {};
}

/** Tries spacings until a few more samples than requested come out, and thins those. */
Error sampleCount(const SLIMSurface& surface, const SurfaceSampleParams& params, int threads,
                  Progress* progress, SurfaceSamples& samples) {
  const auto wanted = static_cast<double>(params.count);
  const double aim = 0.5 * (1.0 + kSurplus) * wanted + 0.5;
  double spacing = guessSpacing(surface, std::min(wanted, kFirstCount));
  Candidates candidates;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    if (Error error = makeCandidates(surface, spacing, threads, progress, candidates)) return error;
    std::vector<std::uint32_t> set = poissonSet(candidates.points, spacing, params.seed, threads);
    const auto found = static_cast<double>(set.size());
    const bool close = found <= kSurplus * wanted + 1 || trial + 1 == kMostTrials;
    if (found >= wanted && close) {
      thinSet(candidates.points, spacing, params.count, set);
      take(candidates, set, spacing, samples);
      return {};
    }
    spacing *= std::sqrt(std::max(found, 0.25) / aim);
  }
  if (candidates.curvature.empty()) return noArea();
  return {ErrorCode::kBadArgument, "the surface has no place for so few samples: give a spacing"};
}

}  // namespace

Error SurfaceSampleParams::validate() const {
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (!(spacing >= 0) || !std::isfinite(spacing))
    return bad("the spacing of samples must be positive (0: by their number)");
  if ((spacing > 0) == (count > 0)) return bad("give a spacing or a number of samples");
  if (count > 100000000) return bad("more than 100 million samples are not made at once");
  return checkThreads(threads);
}

Error sampleSurface(const SLIMSurface& surface, const SurfaceSampleParams& params,
                    SurfaceSamples& samples, Progress* progress) {
  samples = SurfaceSamples();
  if (Error error = params.validate()) return error;
  if (Error error = surface.validate()) return error;
  if (surface.numLeaves() == 0) return badInput("the surface has no leaves: fit one");
  const int threads = resolveThreads(params.threads);
  const auto make = params.count > 0 ? sampleCount : sampleSpacing;
  if (Error error = make(surface, params, threads, progress, samples)) return error;
  samples.color = surfaceColors(surface, samples.position, samples.normal, threads);
  return {};
}

}  // namespace pcl_slim
