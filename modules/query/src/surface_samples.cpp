// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/random.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** \brief A node of a leaf's grid, on the leaf, in world coordinates. */
struct Node {
  std::uint64_t number;
  double rank;  ///< random, in [0, 1): nodes are tried in this order
  std::array<double, 3> position;
  std::array<float, 3> normal;  ///< of the leaf
};

/** \brief A place of the blended surface, in world coordinates. */
struct ProjectedNode {
  std::uint64_t number;
  double rank;
  std::array<double, 3> position;
  std::array<float, 3> normal;
  std::array<float, 2> curvature;  ///< mean and Gaussian
};

constexpr std::uint32_t kNone = 0xffffffffu;

std::uint64_t mixed(std::uint64_t bits) {
  return SplitMix{bits}.next();
}

/** \brief Samples in cells as wide as the spacing, found by a hash of the cell. */
class SampleTable {
 public:
  /** \param[in] oriented samples that face apart do not count as near */
  SampleTable(double spacing, bool oriented) : spacing_(spacing), oriented_(oriented) {}

  void add(const ProjectedNode& sample) {
    samples_.push_back(sample);
    next_.push_back(kNone);
    if (kSlotsPerSample * samples_.size() > heads_.size()) grow();
    link(static_cast<std::uint32_t>(samples_.size() - 1));
  }

  /** \brief Whether a sample is nearer to a place than the spacing. */
  bool isNear(const std::array<double, 3>& place, const std::array<float, 3>& normal) const {
    const double most = spacing_ * spacing_;
    return anyAround(place, normal, [&](std::uint32_t, double d) { return d < most; });
  }

  /** \brief The sample nearest to sample i and nearer than a bound, of those in the cells around:
   * surely found if it is nearer than the spacing. */
  std::pair<std::uint32_t, double> nearest(std::uint32_t i, double bound) const {
    std::pair<std::uint32_t, double> best{kNone, bound * bound};
    anyAround(samples_[i].position, samples_[i].normal, [&](std::uint32_t j, double d) {
      if (j != i && d < best.second) best = {j, d};
      return false;
    });
    return best;
  }

  const std::vector<ProjectedNode>& samples() const { return samples_; }

 private:
  static constexpr std::size_t kSlotsPerSample =
      4;  ///< at least: few slots have two cells' samples

  /** Calls found(j, squared distance) for the samples around a place that face as it does, until it
   * returns true. \return whether it did */
  template <typename Found>
  bool anyAround(const std::array<double, 3>& place, const std::array<float, 3>& normal,
                 const Found& found) const {
    if (samples_.empty()) return false;
    constexpr std::int64_t kSteps[] = {0, -1, 1};  // the cell of the place comes first
    const std::uint64_t here = hashOfCell(place);
    for (const std::int64_t z : kSteps) {
      for (const std::int64_t y : kSteps) {
        for (const std::int64_t x : kSteps) {
          const std::size_t slot = slotOf(here + hashOf(x, y, z));
          for (std::uint32_t j = heads_[slot]; j != kNone; j = next_[j]) {
            const auto& p = samples_[j].position;
            const auto& n = samples_[j].normal;
            const double d[3] = {p[0] - place[0], p[1] - place[1], p[2] - place[2]};
            if (oriented_ && !(normal[0] * n[0] + normal[1] * n[1] + normal[2] * n[2] > 0.0f))
              continue;
            if (found(j, d[0] * d[0] + d[1] * d[1] + d[2] * d[2])) return true;
          }
        }
      }
    }
    return false;
  }

  /** Cells in a row are in slots in a row, and so in a cache line. */
  static std::uint64_t hashOf(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) + static_cast<std::uint64_t>(y) * SplitMix::kStep +
           static_cast<std::uint64_t>(z) * 0xbf58476d1ce4e5b9u;
  }

  std::uint64_t hashOfCell(const std::array<double, 3>& place) const {
    constexpr double kMost = 1e18;  // places farther from the origin, in spacings, share cells
    std::int64_t cell[3];
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] =
          static_cast<std::int64_t>(std::clamp(std::floor(place[a] / spacing_), -kMost, kMost));
    return hashOf(cell[0], cell[1], cell[2]);
  }

  std::size_t slotOf(std::uint64_t hash) const {
    return static_cast<std::size_t>(hash) & (heads_.size() - 1);
  }

  void link(std::uint32_t i) {
    std::uint32_t& head = heads_[slotOf(hashOfCell(samples_[i].position))];
    next_[i] = head;
    head = i;
  }

  void grow() {
    constexpr std::size_t kFirstSlots = 1024;
    heads_.assign(std::max(kFirstSlots, 2 * heads_.size()), kNone);
    for (std::uint32_t i = 0; i + 1 < samples_.size(); ++i) link(i);
  }

  double spacing_;
  bool oriented_;
  std::vector<ProjectedNode> samples_;
  std::vector<std::uint32_t> heads_;  ///< the last sample of a slot
  std::vector<std::uint32_t> next_;   ///< the one before it in its slot
};

/** \brief The numbers of the samples that are left of a set thinned to a given size: those nearest to
 * another are left out, one of each pair first. O(samples). */
std::vector<std::uint32_t> thinned(const SampleTable& table, double spacing, std::size_t count) {
  const auto size = static_cast<std::uint32_t>(table.samples().size());
  std::vector<std::uint32_t> kept(size);
  std::iota(kept.begin(), kept.end(), 0u);
  if (size <= count) return kept;
  struct Neighbor {
    double distance;
    std::uint32_t sample, nearest;
  };
  std::vector<Neighbor> neighbors;
  for (std::uint32_t i = 0; i < size; ++i) {
    const auto [j, distance] = table.nearest(i, 2 * spacing);
    neighbors.push_back({distance, i, j});
  }
  std::stable_sort(neighbors.begin(), neighbors.end(),
                   [](const Neighbor& a, const Neighbor& b) { return a.distance < b.distance; });
  std::vector<std::uint8_t> gone(size, 0);
  std::size_t left = size;
  for (const bool pairs : {true, false}) {
    for (const Neighbor& n : neighbors) {
      const bool widowed = n.nearest != kNone && gone[n.nearest] != 0;
      if (left == count || gone[n.sample] != 0 || (pairs && widowed)) continue;
      gone[n.sample] = 1;
      --left;
    }
  }
  kept.erase(
      std::remove_if(kept.begin(), kept.end(), [&](std::uint32_t i) { return gone[i] != 0; }),
      kept.end());
  return kept;
}

constexpr double kStep = 0.5;        ///< of the spacing: spacing of the nodes
constexpr double kReach = 0.5;       ///< of a ball's radius; see ProjectionParams
constexpr double kMostNodes = 4e9;   ///< of more, the samples take too much memory
constexpr double kLeastTrial = 500;  ///< samples of the first trial for a count, at least
constexpr double kMoreSamples = 8;   ///< factor of the samples of the next trial
constexpr double kSurplus = 1.03;    ///< samples over the count, at most, that are thinned
constexpr int kMostTrials = 12;
constexpr int kPasses = 7;        ///< each but the first takes as many nodes as all before it
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

/** \brief Nodes of the leaves' grids. None is kept: a pass takes those of some ranks. */
class LeafNodes {
 public:
  /** \param[in] step of the grids, local length */
  LeafNodes(const SLIMSurface& surface, double step, std::uint64_t seed)
      : surface_(surface), step_(step), seed_(mixed(seed)), leaves_(surface.leaves()) {
    first_.reserve(leaves_.size());
    std::uint64_t nodes = 0;
    for (const std::uint32_t leaf : leaves_) {
      first_.push_back(nodes);
      const auto side = static_cast<std::uint64_t>(sideOf(surface, leaf, step));
      nodes += side * side;
    }
  }

  std::size_t numLeaves() const { return leaves_.size(); }

  /** \brief Calls visit(node) for the nodes of a leaf with ranks in [low, high) that the leaf covers
   * inside its border. */
  template <typename Visit>
  void forEach(std::size_t at, double low, double high, const Visit& visit) const {
    const std::uint32_t i = leaves_[at];
    const LocalFrame frame({surface_.nx[i], surface_.ny[i], surface_.nz[i]});
    const double r = surface_.radius[i], reach = halfWidth(surface_.info);
    const double center[3] = {surface_.cx[i], surface_.cy[i], surface_.cz[i]};
    const TrimMap map = surface_.trimMap(i);
    const std::int64_t side = sideOf(surface_, i, step_);
    const double pitch = 2 * reach / static_cast<double>(side - 1);
    for (std::int64_t k = 0; k < side * side; ++k) {
      const std::uint64_t number = first_[at] + static_cast<std::uint64_t>(k);
      const double rank = SplitMix{seed_ ^ number}.nextShare();
      if (rank < low || rank >= high) continue;
      const std::int64_t column = k % side, row = k / side;
      const double u = pitch * static_cast<double>(column) - reach;
      const double v = pitch * static_cast<double>(row) - reach;
      if (u * u + v * v > reach * reach) continue;
      if (surface_.isOpen(i) && outsideShare(map, u, v) > 0.5) continue;
      const double h = evaluateHeight(surface_.degree[i], surface_.coefficientsOf(i), u, v);
      if (!(u * u + v * v + h * h < 1.0)) continue;
      Node node{number, rank, {}, {surface_.nx[i], surface_.ny[i], surface_.nz[i]}};
      for (std::size_t a = 0; a < 3; ++a) {
        const double local = center[a] + r * (u * frame.u[a] + v * frame.v[a] + h * frame.w[a]);
        node.position[a] = surface_.info.origin[a] + surface_.info.scale * local;
      }
      visit(node);
    }
  }

 private:
  const SLIMSurface& surface_;
  double step_;
  std::uint64_t seed_;
  std::vector<std::uint32_t> leaves_;
  std::vector<std::uint64_t> first_;  ///< number of the first node of each leaf
};

Error checkNodes(const SLIMSurface& surface, double step) {
  double nodes = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double side = 2 * halfWidth(surface.info) * surface.radius[i] / step + 3;
    if (surface.isLeaf(i)) nodes += side * side;
  }
  if (nodes < kMostNodes) return {};
  return {ErrorCode::kBadArgument, "so dense a sampling takes too much memory: raise the spacing"};
}

/** The nodes with ranks in [low, high) that no sample is near to. \param[in,out] tried counts nodes */
std::vector<Node> freeNodes(const LeafNodes& nodes, const SampleTable& table, double low,
                            double high, int threads, Progress* progress, std::uint64_t& tried) {
  struct Run {
    std::vector<Node> free;
    std::uint64_t tried = 0;
  };
  std::vector<Run> runs((nodes.numLeaves() + kRun - 1) / kRun);
  parallelFor(runs.size(), threads, 1, [&](std::size_t r, int) {
    if (progress != nullptr && progress->cancelled()) return;
    const std::size_t end = std::min(nodes.numLeaves(), (r + 1) * kRun);
    for (std::size_t at = r * kRun; at < end; ++at) {
      nodes.forEach(at, low, high, [&](const Node& node) {
        ++runs[r].tried;
        if (!table.isNear(node.position, node.normal)) runs[r].free.push_back(node);
      });
    }
  });
  std::vector<Node> free;
  for (const Run& run : runs) {
    free.insert(free.end(), run.free.begin(), run.free.end());
    tried += run.tried;
  }
  return free;
}

/** Moves nodes onto the blended surface, those that are inside its borders. Their order changes. */
Error projectNodes(const SLIMSurface& surface, const std::vector<Node>& nodes, int threads,
                   std::vector<ProjectedNode>& projected) {
  projected.clear();
  if (nodes.empty()) return {};
  CloudView view;
  view.xyz = &nodes.front().position;
  view.xyz_stride = sizeof(Node);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = nodes.size();
  const Result<PointStore> store = PointStore::build(view, threads);
  if (!store) return store.error();
  ProjectionParams params;
  params.curvature = true;
  params.reach = kReach;
  params.threads = threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, params, projection)) return error;
  const double scale = store->scale();
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (!projection.supported[i] || !projection.inside[i]) continue;
    const auto& [mean, gaussian] = projection.curvature[i];
    const Node& on_leaf = nodes[store->orderOfStore()[i]];
    ProjectedNode node{
        on_leaf.number,
        on_leaf.rank,
        {},
        projection.normal[i],
        {static_cast<float>(mean / scale), static_cast<float>(gaussian / scale / scale)}};
    for (std::size_t a = 0; a < 3; ++a)
      node.position[a] = store->origin()[a] + scale * projection.position[i][a];
    projected.push_back(node);
  }
  return {};
}

/** \brief Fills a table with a maximal set of samples: nodes, projected, in the order of their ranks,
 * none nearer than the spacing to one before. Only nodes without a sample near are projected. */
Error fillTable(const SLIMSurface& surface, double spacing, std::uint64_t seed, int threads,
                Progress* progress, SampleTable& table, std::uint64_t& tried) {
  const double step = kStep * spacing / surface.info.scale;
  if (Error error = checkNodes(surface, step)) return error;
  const LeafNodes nodes(surface, step, seed);
  std::vector<ProjectedNode> projected;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double low = pass > 0 ? std::exp2(pass - kPasses) : 0;
    const double high = std::exp2(pass + 1 - kPasses);
    if (progress != nullptr) progress->report(static_cast<float>(low), "sampling");
    const auto free = freeNodes(nodes, table, low, high, threads, progress, tried);
    if (progress != nullptr && progress->cancelled())
      return {ErrorCode::kCancelled, "the sampling was cancelled"};
    if (Error error = projectNodes(surface, free, threads, projected)) return error;
    std::sort(projected.begin(), projected.end(),
              [](const ProjectedNode& a, const ProjectedNode& b) { return a.rank < b.rank; });
    for (const ProjectedNode& node : projected) {
      if (!table.isNear(node.position, node.normal)) table.add(node);
    }
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

/** Takes samples, no more than a number, in the order of their nodes, in which neighbours are near
 * each other. */
void take(const SampleTable& table, double spacing, std::size_t count, SurfaceSamples& samples) {
  std::vector<std::uint32_t> kept = thinned(table, spacing, count);
  const std::vector<ProjectedNode>& from = table.samples();
  std::sort(kept.begin(), kept.end(),
            [&](std::uint32_t i, std::uint32_t j) { return from[i].number < from[j].number; });
  samples.spacing = spacing;
  for (const std::uint32_t i : kept) {
    samples.position.push_back(from[i].position);
    samples.normal.push_back(from[i].normal);
    samples.curvature.push_back(from[i].curvature);
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
  SampleTable table(params.spacing, surface.info.oriented);
  if (Error error = fillTable(surface, params.spacing, params.seed, threads, progress, table,
                              samples.candidates))
    return error;
  if (table.samples().empty()) return noArea();
  take(table, params.spacing, table.samples().size(), samples);
  return {};
}

/** Tries spacings until a few more samples than requested come out, and thins those. The first trials
 * have few samples: each shows the spacing that more of them take. Where the number jumps over
 * the few percent, the last trial repeats the one with the fewest samples that are enough. */
Error sampleCount(const SLIMSurface& surface, const SurfaceSampleParams& params, int threads,
                  Progress* progress, SurfaceSamples& samples) {
  const auto wanted = static_cast<double>(params.count);
  double target = wanted;
  while (target > kMoreSamples * kLeastTrial) target /= kMoreSamples;
  double spacing = guessSpacing(surface, target);
  bool found_any = false;
  double fewest = HUGE_VAL, best_spacing = 0;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    SampleTable table(spacing, surface.info.oriented);
    samples.candidates = 0;
    if (Error error =
            fillTable(surface, spacing, params.seed, threads, progress, table, samples.candidates))
      return error;
    const auto found = static_cast<double>(table.samples().size());
    found_any = found > 0;
    const bool close = found <= kSurplus * wanted + 1 || trial + 1 == kMostTrials;
    if (found >= wanted && close) {
      take(table, spacing, params.count, samples);
      return {};
    }
    if (found >= wanted && found < fewest) {
      fewest = found;
      best_spacing = spacing;
    }
    target = std::min(wanted, kMoreSamples * target);
    const double aim = target < wanted ? target : 0.5 * (1.0 + kSurplus) * wanted + 0.5;
    spacing *= std::sqrt(std::max(found, 0.25) / aim);
    if (trial + 2 == kMostTrials && best_spacing > 0) spacing = best_spacing;
  }
  if (!found_any) return noArea();
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
  if (Error error = make(surface, params, threads, progress, samples)) {
    samples = SurfaceSamples();
    return error;
  }
  samples.color = surfaceColors(surface, samples.position, samples.normal, threads);
  return {};
}

}  // namespace pcl_slim
