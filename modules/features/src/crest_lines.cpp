// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/features/crest_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "lines/crest_tracer.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kStride = 4;     ///< stored points are tried in steps of this ...
constexpr std::size_t kNeighbors = 8;  ///< ... against this number of neighbours
constexpr std::size_t kSlice = 256;    ///< points looked at in one piece of work
constexpr double kSameSheet = 0.2;     ///< least cosine between two neighbours' normals

Vector3 toVector(const std::array<float, 3>& a) {
  return {a[0], a[1], a[2]};
}

class SeedFinder {
 public:
  SeedFinder(const PointStore& store, const Projection& projection, const SLIMSurface& surface)
      : projection_(projection), factor_(store.scale() / surface.info.scale) {
    for (std::size_t a = 0; a < 3; ++a) {
      shift_[a] = (store.origin()[a] - surface.info.origin[a]) / surface.info.scale;
    }
  }

  /** Adds the seed between two points, if a line of that type passes between them. */
  void tryPair(std::size_t i, std::size_t j, CrestType type, std::vector<CrestSeed>& seeds) const {
    if (projection_.supported[j] == 0) return;
    const Vector3 n = toVector(projection_.normal[i]), m = toVector(projection_.normal[j]);
    const double facing = dot(n, m);
    if (std::abs(facing) < kSameSheet) return;
    const CrestSide a = crestSide(projection_.principal[i], type, false);
    const CrestSide b = crestSide(projection_.principal[j], type, facing < 0);
    if (!(a.k > std::abs(a.other) && b.k > std::abs(b.other))) return;
    const Vector3 ta = toVector(a.t), tb = toVector(b.t);
    const Vector3 &p = projection_.position[i], &q = projection_.position[j];
    const double ahead = dot(subtract(q, p), ta);
    const double ea = ahead < 0 ? -a.e : a.e;
    const double eb = (ahead < 0) != (dot(ta, tb) < 0) ? -b.e : b.e;
    if (!(ea > 0 && eb <= 0)) return;
    const double share = ea / (ea - eb);
    const Vector3 between = along(p, share, subtract(q, p));
    CrestSeed seed;
    for (std::size_t c = 0; c < 3; ++c) seed.position[c] = shift_[c] + factor_ * between[c];
    seed.normal = share < 0.5 ? n : scaled(m, facing < 0 ? -1.0 : 1.0);
    seed.t = share < 0.5 ? ta : tb;
    seed.k = (a.k + share * (b.k - a.k)) / factor_;
    seeds.push_back(seed);
  }

 private:
  const Projection& projection_;
  double factor_;
  Vector3 shift_{};
};

/** Seeds between stored points and their neighbours, strongest first, ties by place.
 * \return one list a type; empty lists once cancelled. */
std::vector<std::vector<CrestSeed>> findCrestSeeds(const PointStore& store,
                                                   const Projection& projection,
                                                   const SLIMSurface& surface, int threads,
                                                   Progress* progress) {
  const SeedFinder finder(store, projection, surface);
  const std::size_t points = (store.size() + kStride - 1) / kStride;
  const std::size_t slices = (points + kSlice - 1) / kSlice;
  std::vector<std::vector<std::vector<CrestSeed>>> found(
      2, std::vector<std::vector<CrestSeed>>(slices));
  parallelFor(slices, threads, 1, [&](std::size_t slice, int) {
    if (progress != nullptr && progress->cancelled()) return;
    NeighborSearch search(store);
    std::vector<std::uint32_t> neighbors;
    std::vector<float> distances_sq;
    const std::size_t end = std::min((slice + 1) * kSlice, points);
    for (std::size_t s = slice * kSlice; s < end; ++s) {
      const std::size_t i = s * kStride;
      if (projection.supported[i] == 0) continue;
      search.nearest(i, kNeighbors + 1, neighbors, distances_sq);
      for (const std::uint32_t j : neighbors) {
        if (j == i) continue;
        finder.tryPair(i, j, CrestType::kRidge, found[0][slice]);
        finder.tryPair(i, j, CrestType::kRavine, found[1][slice]);
      }
    }
  });
  std::vector<std::vector<CrestSeed>> seeds(2);
  if (progress != nullptr && progress->cancelled()) return seeds;
  for (std::size_t type = 0; type < 2; ++type) {
    for (const auto& slice : found[type]) {
      seeds[type].insert(seeds[type].end(), slice.begin(), slice.end());
    }
    std::sort(seeds[type].begin(), seeds[type].end(), [](const CrestSeed& a, const CrestSeed& b) {
      return std::tie(b.k, a.position) < std::tie(a.k, b.position);
    });
  }
  return seeds;
}

/** Sums along a line, a closed one's last side included, in the vertices' units. */
struct LineSums {
  double length = 0, strength = 0, radius = 0, significance = 0;

  explicit LineSums(const TracedLine& line);
};

constexpr std::ptrdiff_t kAround =
    3;  ///< vertices to both sides of one that smooth its significance

/** Means of the significance over seven vertices; of fewer at an open end. */
std::vector<double> smoothed(const TracedLine& line) {
  const auto n = static_cast<std::ptrdiff_t>(line.vertices.size());
  std::vector<double> mean(line.vertices.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double sum = 0;
    std::ptrdiff_t count = 0;
    for (std::ptrdiff_t j = i - kAround; j <= i + kAround; ++j) {
      if (!line.closed && (j < 0 || j >= n)) continue;
      sum += line.vertices[static_cast<std::size_t>(((j % n) + n) % n)].significance;
      ++count;
    }
    mean[static_cast<std::size_t>(i)] = sum / static_cast<double>(count);
  }
  return mean;
}

/** Opens a closed line at a vertex that is not significant, if there is one. */
void openAtLowest(TracedLine& line, std::vector<double>& mean, double least) {
  const auto lowest = std::min_element(mean.begin(), mean.end());
  if (!line.closed || *lowest >= least) return;
  const std::ptrdiff_t at = lowest - mean.begin();
  std::rotate(mean.begin(), lowest, mean.end());
  std::rotate(line.vertices.begin(), line.vertices.begin() + at, line.vertices.end());
  line.closed = false;
}

LineSums::LineSums(const TracedLine& line) {
  const auto& v = line.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    radius += v[i].radius / static_cast<double>(v.size());
    significance += v[i].significance / static_cast<double>(v.size());
    if (i + 1 == v.size() && !line.closed) continue;
    const CrestVertex& next = v[(i + 1) % v.size()];
    const double side = pcl_slim::length(subtract(next.position, v[i].position));
    length += side;
    strength += 0.5 * side * (v[i].k + next.k);
  }
}

/** Keeps the stretches of traced lines that are significant against the noise and long and strong
 * enough, and counts the others. */
std::vector<TracedLine> keptStretches(const std::vector<TracedLine>& traced,
                                      const CrestParams& params, CrestStatistics& statistics) {
  std::vector<TracedLine> kept;
  for (TracedLine line : traced) {
    std::vector<double> mean = smoothed(line);
    openAtLowest(line, mean, params.significance);
    bool any = false;
    for (std::size_t begin = 0, end = 0; begin < mean.size(); begin = end + 1) {
      end = begin;
      double peak = 0;
      for (; end < mean.size() && mean[end] >= params.significance; ++end) {
        peak = std::max(peak, mean[end]);
      }
      if (peak < params.peak_significance || end < begin + 2) continue;
      any = true;
      TracedLine stretch;
      stretch.closed = line.closed;
      stretch.vertices.assign(line.vertices.begin() + static_cast<std::ptrdiff_t>(begin),
                              line.vertices.begin() + static_cast<std::ptrdiff_t>(end));
      const LineSums sums(stretch);
      if (sums.length < params.min_length * sums.radius) {
        ++statistics.short_lines;
      } else if (sums.strength < params.min_strength) {
        ++statistics.weak_lines;
      } else {
        kept.push_back(std::move(stretch));
      }
    }
    if (!any) ++statistics.insignificant;
  }
  return kept;
}

constexpr double kCleanNoise = 1e-6;  ///< of L: below it third derivatives are the more exact
constexpr std::size_t kSlices = 32;   ///< progress report and cancel check in between
constexpr float kSeedsShare = 0.1f;   ///< of the time

std::array<float, 3> toFloat(const Vector3& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

/** Mean radius of the leaves: what cells in which vertices are looked up go by. */
double meanRadius(const SLIMSurface& surface) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    sum += surface.radius[i];
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 1.0;
}

void addTo(CrestStatistics& sum, const CrestStatistics& part) {
  using Column = std::uint64_t CrestStatistics::*;
  for (const Column column :
       {&CrestStatistics::seeds, &CrestStatistics::seeds_on_lines,
        &CrestStatistics::seeds_insignificant, &CrestStatistics::seeds_failed,
        &CrestStatistics::traced, &CrestStatistics::joined, &CrestStatistics::ended,
        &CrestStatistics::faded, &CrestStatistics::requests}) {
    sum.*column += part.*column;
  }
}

/** Writes a line in world units at the end of the others. */
void append(const TracedLine& line, CrestType type, const SurfaceInfo& info, CrestLines& lines) {
  const double scale = info.scale;
  const bool ridge = type == CrestType::kRidge;
  for (const CrestVertex& v : line.vertices) {
    auto& position = lines.position.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) position[a] = info.origin[a] + scale * v.position[a];
    lines.normal.push_back(toFloat(v.normal));
    lines.tangent.push_back(toFloat(v.ahead));
    lines.k1.push_back(static_cast<float>((ridge ? v.k : -v.other) / scale));
    lines.k2.push_back(static_cast<float>((ridge ? v.other : -v.k) / scale));
    lines.prominence.push_back(static_cast<float>(v.prominence / scale));
    lines.significance.push_back(static_cast<float>(v.significance));
    lines.radius.push_back(static_cast<float>(v.radius * scale));
  }
  const LineSums sums(line);
  lines.line_begin.push_back(static_cast<std::uint32_t>(lines.position.size()));
  lines.type.push_back(type);
  lines.closed.push_back(line.closed ? 1 : 0);
  lines.length.push_back(sums.length * scale);
  lines.strength.push_back(sums.strength);
  lines.mean_significance.push_back(sums.significance);
}

struct KeptLine {
  TracedLine line;
  CrestType type;
  double strength;
};

void collect(const std::vector<std::unique_ptr<CrestTracer>>& tracers, const CrestParams& params,
             const SurfaceInfo& info, CrestLines& lines, CrestStatistics& statistics) {
  std::vector<KeptLine> kept;
  for (std::size_t type = 0; type < tracers.size(); ++type) {
    if (!tracers[type]) continue;
    addTo(statistics, tracers[type]->statistics());
    for (TracedLine& line : keptStretches(tracers[type]->lines(), params, statistics)) {
      const double strength = LineSums(line).strength;
      kept.push_back({std::move(line), static_cast<CrestType>(type), strength});
    }
  }
  std::sort(kept.begin(), kept.end(), [](const KeptLine& a, const KeptLine& b) {
    return std::tie(b.strength, a.type, a.line.vertices[0].position) <
           std::tie(a.strength, b.type, b.line.vertices[0].position);
  });
  for (const KeptLine& line : kept) append(line.line, line.type, info, lines);
}

Error checkInput(const PointStore& store, const Projection& projection,
                 const SLIMSurface& surface) {
  if (projection.position.size() != store.size() || projection.principal.size() != store.size()) {
    return {ErrorCode::kBadArgument,
            "the projection is not of these points with extremality; project them so"};
  }
  return surface.validate();
}

/** Follows the seeds of both types, a slice of each in turn. */
Error followAll(const std::vector<std::vector<CrestSeed>>& seeds,
                const std::vector<std::unique_ptr<CrestTracer>>& tracers, int threads,
                Progress* progress) {
  for (std::size_t slice = 0; slice < kSlices; ++slice) {
    if (progress != nullptr) {
      const float done = static_cast<float>(slice) / static_cast<float>(kSlices);
      progress->report(kSeedsShare + (1 - kSeedsShare) * done, "tracing");
    }
    parallelFor(tracers.size(), std::min<int>(threads, static_cast<int>(tracers.size())), 1,
                [&](std::size_t type, int) {
                  if (!tracers[type]) return;
                  const std::size_t n = seeds[type].size();
                  for (std::size_t i = n * slice / kSlices; i < n * (slice + 1) / kSlices; ++i) {
                    if (progress != nullptr && progress->cancelled()) return;
                    tracers[type]->follow(seeds[type][i]);
                  }
                });
    if (progress != nullptr && progress->cancelled()) {
      return {ErrorCode::kCancelled, "the tracing of lines was cancelled"};
    }
  }
  return {};
}

}  // namespace

Error CrestLines::validate() const {
  const std::size_t vertices = numVertices(), lines = numLines();
  const bool whole = normal.size() == vertices && tangent.size() == vertices &&
                     k1.size() == vertices && k2.size() == vertices &&
                     prominence.size() == vertices && significance.size() == vertices &&
                     radius.size() == vertices;
  if (!whole)
    return badInput("the lines have " + std::to_string(vertices) +
                    " vertices and another number of normals, tangents or other values: give each "
                    "vertex one of each");
  const bool all = closed.size() == lines && length.size() == lines && strength.size() == lines &&
                   mean_significance.size() == lines;
  if (!all)
    return badInput("there are " + std::to_string(lines) +
                    " lines and another number of lengths, strengths or other values: give each "
                    "line one of each");
  const bool ascending = line_begin.size() == lines + 1 && line_begin.front() == 0 &&
                         line_begin.back() == vertices &&
                         std::is_sorted(line_begin.begin(), line_begin.end());
  if (ascending) return {};
  return badInput("line_begin does not ascend from 0 to the number of vertices, " +
                  std::to_string(vertices) + ": give it an offset a line, and the end");
}

Error CrestParams::validate() const {
  if (!ridges && !ravines) {
    return {ErrorCode::kBadArgument, "neither ridges nor ravines are asked for; ask for one"};
  }
  if (!(significance >= 0 && peak_significance >= significance && peak_significance < 1e9)) {
    return {ErrorCode::kBadArgument,
            "significance must be 0 or more, and its peak at least that; set both"};
  }
  if (!(min_strength >= 0 && min_strength < 1e9 && min_length >= 0 && min_length < 1e9)) {
    return {ErrorCode::kBadArgument, "least strength and length must be 0 or more; raise them"};
  }
  if (!(step >= 0.02 && step <= 0.5)) {
    return {ErrorCode::kBadArgument, "the step must lie between .02 and .5 radii; change it"};
  }
  return {};
}

Error traceCrestLines(const PointStore& store, const Projection& projection,
                      const SLIMSurface& surface, const CrestParams& params, CrestLines& lines,
                      CrestStatistics* statistics, Progress* progress) {
  lines = CrestLines();
  CrestStatistics made;
  if (statistics != nullptr) *statistics = made;
  if (Error error = params.validate()) return error;
  if (Error error = checkInput(store, projection, surface)) return error;
  const int threads = resolveThreads(params.threads);
  if (progress != nullptr) progress->report(0.0f, "finding seeds");
  Stopwatch watch;
  const auto seeds = findCrestSeeds(store, projection, surface, threads, progress);
  made.seconds_seeds = watch.lap();

  const ProbeIndex index(surface);
  const double noise = std::sqrt(std::max(0.0, surface.info.lambda));
  const double radius = std::max(meanRadius(surface), 1e-6);
  std::vector<std::unique_ptr<CrestTracer>> tracers(2);
  for (const CrestType type : {CrestType::kRidge, CrestType::kRavine}) {
    if (!(type == CrestType::kRidge ? params.ridges : params.ravines)) continue;
    tracers[static_cast<std::size_t>(type)] = std::make_unique<CrestTracer>(
        index, type, params, CurvatureNoise(surface.info), noise < kCleanNoise, radius);
  }
  if (Error error = followAll(seeds, tracers, threads, progress)) return error;
  collect(tracers, params, surface.info, lines, made);
  made.seconds_trace = watch.lap();
  if (statistics != nullptr) *statistics = made;
  if (progress != nullptr) progress->report(1.0f, "tracing");
  return {};
}

}  // namespace pcl_slim
