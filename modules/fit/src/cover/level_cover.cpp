// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "cover/cover.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/random.h"

namespace pcl_slim::detail {

namespace {

/** A code one step before or after along an axis, whose bits the mask has. */
std::uint64_t stepAlong(std::uint64_t code, std::uint64_t mask, int step) {
  const std::uint64_t own = code & mask, one = mask & (0 - mask);
  const std::uint64_t moved = step < 0 ? own - one : step > 0 ? (own | ~mask) + one : own;
  return moved & mask;
}

/** The end of a run that starts at i: ever longer steps until it is left, then halving the last. */
template <typename InRun>
std::size_t endOfRun(const AlignedVector<std::uint32_t>& values, std::size_t i,
                     const InRun& in_run) {
  std::size_t step = 1;
  for (; i + step < values.size() && in_run(values[i + step]); step *= 2) i += step;
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i);
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), i + step));
  return static_cast<std::size_t>(std::partition_point(begin, last, in_run) - values.begin());
}

}  // namespace

void CoverCells::divide(const PointStore& store, const AlignedVector<std::uint32_t>& points,
                        double reach) {
  // A level may be finer than floats resolve: its reach is 0 then.
  const double levels = std::floor(-std::log2(2.0 * reach));
  const int depth = static_cast<int>(std::clamp(levels, 0.0, double{kMortonBits}));
  const int shift = 3 * (kMortonBits - depth);
  const auto codeOf = [&](std::uint32_t point) { return store.keys()[point] >> shift; };
  cells_.clear();
  for (std::size_t i = 0; i < points.size();) {
    const std::uint64_t code = codeOf(points[i]);
    const std::size_t end =
        endOfRun(points, i, [&](std::uint32_t point) { return codeOf(point) == code; });
    cells_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(end), code});
    i = end;
  }
  orderByColor();
}

std::uint32_t CoverCells::beside(std::uint32_t i, int x, int y, int z) const {
  constexpr std::uint64_t kZ = 0x1249249249249249ULL, kY = kZ << 1, kX = kZ << 2;
  const std::uint64_t own = cells_[i].code;
  const std::uint64_t code = stepAlong(own, kX, x) | stepAlong(own, kY, y) | stepAlong(own, kZ, z);
  const auto at =
      std::lower_bound(cells_.begin(), cells_.end(), code,
                       [](const Cell& cell, std::uint64_t value) { return cell.code < value; });
  const bool found = at != cells_.end() && at->code == code;
  return static_cast<std::uint32_t>((found ? at : cells_.end()) - cells_.begin());
}

void CoverCells::orderByColor() {
  color_begin_.fill(0);
  for (const Cell& cell : cells_) ++color_begin_[colorOf(cell) + 1];
  for (std::size_t c = 0; c < 8; ++c) color_begin_[c + 1] += color_begin_[c];
  by_color_.resize(cells_.size());
  for (std::uint32_t i = 0; i < by_color_.size(); ++i) by_color_[i] = i;
  std::stable_sort(by_color_.begin(), by_color_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Cell &first = cells_[a], &second = cells_[b];
    if (colorOf(first) != colorOf(second)) return colorOf(first) < colorOf(second);
    return first.end - first.begin > second.end - second.begin;
  });
}

namespace {

/** The points of a surfel's ball within a reach that are on its side of the normal bound. */
BallQuery queryOf(const SurfelRecord& surfel, float reach, const FitPlan& plan) {
  return {surfel.center, reach, surfel.sided ? surfel.normal.data() : nullptr, plan.min_dot};
}

/** \brief Adds a leaf's weight to the coverage of the points it covers (docs/theory.md, "Cover").
 * \param[in,out] nearby blocks, of a region that contains the leaf's ball \param[in,out] coverage
 * of each stored point */
void addCoverage(const PointStore& store, const FitPlan& plan, const SurfelRecord& surfel,
                 NearbyBlocks& nearby, float* coverage) {
  const CoverConstants& constants = plan.constants.cover;
  const bool supported =
      surfel.effective_count > constants.well_supported * numCoefficients(surfel.degree);
  const double alpha = supported ? plan.supported_alpha : plan.alpha;
  const auto reach = static_cast<float>(alpha * surfel.radius);
  kernels::CoverLeaf leaf;
  leaf.ball = queryOf(surfel, reach, plan);
  leaf.frame = LocalFrame({surfel.normal[0], surfel.normal[1], surfel.normal[2]});
  leaf.degree = surfel.degree;
  leaf.support_radius = surfel.radius;
  leaf.to_foot = !plan.paper;
  leaf.c = surfel.c.data();
  leaf.max_residual = plan.residual_bound > 0
                          ? static_cast<float>(plan.residual_bound * surfel.error +
                                               constants.residual_floor * surfel.radius)
                          : surfel.radius;
  kernels::coverPoints(store, nearby.within(surfel.center, reach), leaf, plan.cover_kernel,
                       coverage);
}

/** \brief Marks the points of an internal ball with the bits of value. */
void markBall(const PointStore& store, const FitPlan& plan, const SurfelRecord& surfel,
              std::uint8_t value, NearbyBlocks& nearby, std::uint8_t* marks) {
  kernels::markPoints(store, nearby.within(surfel.center, surfel.radius),
                      queryOf(surfel, surfel.radius, plan), value, marks);
}

/** \brief Marks the uncovered points within reach of a stored point with the bits of value.
 * \return the number of points that had none of these bits before. */
std::uint32_t markUncovered(const PointStore& store, const FitPlan& plan, std::uint32_t point,
                            double reach, std::uint8_t value, NearbyBlocks& nearby,
                            const float* coverage, std::uint8_t* marks) {
  const auto at = store.position(point);
  const std::array<float, 3> center = {static_cast<float>(at[0]), static_cast<float>(at[1]),
                                       static_cast<float>(at[2])};
  std::uint32_t count = 0;
  for (const std::uint32_t block : nearby.within(center, reach)) {
    const std::size_t begin = block * PointStore::kBlock;
    for (std::size_t i = begin; i < std::min(begin + PointStore::kBlock, store.size()); ++i) {
      const auto p = store.position(i);
      if (std::hypot(p[0] - at[0], p[1] - at[1], p[2] - at[2]) > reach) continue;
      if (coverage[i] >= plan.gamma || (marks[i] & value) != 0) continue;
      marks[i] |= value;
      ++count;
    }
  }
  return count;
}

constexpr std::uint8_t kNoFinerMark = 1;     ///< mark: no finer ball can cover this point
constexpr std::uint8_t kLoneNormalMark = 2;  ///< mark: passed over for its normal
constexpr std::uint8_t kFirstLevelMark = 4;  ///< mark: inside an internal ball of a level
constexpr std::uint8_t kLastLevelMark = 128;
// How work is shared out; no result depends on it.
constexpr std::size_t kSlice = 1 << 14;  ///< points a thread takes at a time
constexpr std::size_t kFewCells = 256;   ///< up to this number, colours leave threads idle
/// Share of an internal ball's radius within which it represents points where no leaves are made: a
/// leaf of the next level about such a point is inside the ball as level of detail needs it
/// (DetailSizes), since .64 r = .95 r - .5 kGolden r.
constexpr float kInnerShare = 0.64f;
constexpr char kCancelledMessage[] = "the fit was cancelled";

}  // namespace

LevelCover::LevelCover(const PointStore& store, const FitPlan& plan, int threads)
    : LevelCover(store, plan, threads, {0, store.size()}) {}

LevelCover::LevelCover(const PointStore& store, const FitPlan& plan, int threads, PointRange core)
    : store_(store),
      plan_(plan),
      threads_(threads),
      core_(core),
      level_mark_(kFirstLevelMark),
      done_marks_(kNoFinerMark | kFirstLevelMark) {
  for (int t = 0; t < threads; ++t) {
    workers_.push_back(std::make_unique<Worker>(store, plan));
  }
  const std::size_t padded = store.numBlocks() * PointStore::kBlock;
  coverage_.resize(padded);
  marks_.resize(padded);
  active_.resize(core.size());
  forSlices(padded, [&](std::size_t begin, std::size_t end) {
    std::fill(coverage_.begin() + begin, coverage_.begin() + end, 0.0f);
    std::fill(marks_.begin() + begin, marks_.begin() + end, std::uint8_t{0});
    for (std::size_t i = begin; i < std::min(end, active_.size()); ++i) {
      active_[i] = static_cast<std::uint32_t>(core.begin + i);
    }
  });
}

template <typename Body>
void LevelCover::forSlices(std::size_t count, const Body& body) const {
  parallelFor((count + kSlice - 1) / kSlice, threads_, 1,
              [&](std::size_t s, int) { body(s * kSlice, std::min(count, (s + 1) * kSlice)); });
}

Error LevelCover::run(int first_level, Progress* progress) {
  const double points = static_cast<double>(core_.size());
  first_level_ = first_level;
  for (int level = first_level;
       !active_.empty() && level <= plan_.constants.cover.last_level && plan_.allows(level);
       ++level) {
    if (!plan_.resolves(level)) {
      unresolved_ = active_.size();
      break;
    }
    if (progress != nullptr) {
      if (progress->cancelled()) return {ErrorCode::kCancelled, kCancelledMessage};
      progress->report(static_cast<float>(1.0 - static_cast<double>(active_.size()) / points),
                       "covering");
    }
    coverLevel(level);
    last_level_ = level;
  }
  if (progress != nullptr && progress->cancelled())
    return {ErrorCode::kCancelled, kCancelledMessage};
  return {};
}

void LevelCover::coverLevel(int level) {
  // A ball marks points within r_r of its centre, which may have moved by largest_shift r_r; a leaf
  // of the next larger radius covers points within alpha r_r / gamma.
  const double moved = 1.0 + plan_.constants.ball.largest_shift;
  cells_.divide(store_, active_,
                plan_.levelRadius(level) * std::max(moved, plan_.alpha / kGolden) + store_.drift());
  const std::size_t first = outputs_.size();
  outputs_.resize(first + cells_.size());
  if (threads_ > 1 && cells_.size() <= kFewCells) {
    shareCells(level, first);
  } else {
    for (int color = 0; color < 8; ++color) {
      const std::size_t begin = cells_.colorBegin(color), end = cells_.colorBegin(color + 1);
      parallelFor(end - begin, threads_, 1, [&](std::size_t i, int thread) {
        const std::uint32_t cell = cells_.byColor()[begin + i];
        coverCell(cells_[cell], level, thread, outputs_[first + cell]);
      });
    }
  }
  countBytes();
  endLevel(first);
}

CellVisits LevelCover::visitsOf(const CoverCells::Cell& cell) const {
  const std::uint32_t n = cell.end - cell.begin;
  const std::uint64_t start = mixBits(plan_.seed ^ mixBits(cell.code + 1)) % n;
  return {active_.data() + cell.begin, n, static_cast<std::uint32_t>(start)};
}

void LevelCover::coverCell(const CoverCells::Cell& cell, int level, int thread, Output& output) {
  BallFitter& fitter = worker(thread).fitter;
  const auto begin = static_cast<std::uint32_t>(worker(thread).arena.size());
  Output made{thread, begin, begin, false};
  CellVisits visits = visitsOf(cell);
  const auto is_done = [this](std::uint32_t point) { return isDone(point); };
  SurfelRecord surfel;
  bool prepared = false;
  for (std::uint32_t point; visits.next(is_done, point);) {
    if (!prepared) collectNearby(cell, level, fitter.nearby());
    prepared = true;
    const BallOutcome outcome = fitter.fit(point, level, surfel);
    keep(point, outcome, surfel, fitter.nearby(), worker(thread).arena, made);
  }
  made.end = static_cast<std::uint32_t>(worker(thread).arena.size());
  output = made;
}

/** Marks a point as done for good, and the uncovered points that are nearer to it than the spacing
 * of the grid of centres: no ball can cover them. \return the number of the latter. */
std::uint32_t LevelCover::giveUp(std::uint32_t point, NearbyBlocks& nearby) {
  const std::uint32_t count = markUncovered(store_, plan_, point, plan_.leastRadius(), kNoFinerMark,
                                            nearby, coverage_.data(), marks_.data());
  marks_[point] |= kNoFinerMark;
  return count;
}

/** Covers or marks the points of a fitted ball, as its outcome demands, and stores its surfel, if
 * any. */
void LevelCover::keep(std::uint32_t point, BallOutcome outcome, const SurfelRecord& surfel,
                      NearbyBlocks& nearby, std::vector<SurfelRecord>& surfels, Output& output) {
  output.lasts |= outcome != BallOutcome::kInternal && outcome != BallOutcome::kLine;
  switch (outcome) {
    case BallOutcome::kLeaf:
      if (surfel.radius < plan_.leastRadius()) {
        output.unresolved += giveUp(point, nearby);
        return;
      }
      addCoverage(store_, plan_, surfel, nearby, coverage_.data());
      if (coverage_[point] <=
          0.0f) {  // leaves about points with the same centre would miss it, too
        const std::uint8_t own = marks_[point];
        giveUp(point, nearby);
        marks_[point] = own;
      }
      marks_[point] |= surfel.flags & kSurfelSupportLimited ? kNoFinerMark : level_mark_;
      break;
    case BallOutcome::kInternal: {
      SurfelRecord inner = surfel;
      if (plan_.internal_only) inner.radius *= kInnerShare;
      markBall(store_, plan_, inner, level_mark_, nearby, marks_.data());
      marks_[point] |= level_mark_;
      break;
    }
    case BallOutcome::kLine:
      markBall(store_, plan_, surfel, level_mark_, nearby, marks_.data());
      marks_[point] |= level_mark_;
      return;
    case BallOutcome::kUnsupported:
      if (const std::uint32_t group = giveUp(point, nearby); group > 1) output.unresolved += group;
      return;
    case BallOutcome::kLoneNormal: marks_[point] = kNoFinerMark | kLoneNormalMark; return;
  }
  surfels.push_back(surfel);
}

/** Collects the blocks that any ball of the cell's centres can reach. */
void LevelCover::collectNearby(const CoverCells::Cell& cell, int level,
                               NearbyBlocks& nearby) const {
  float low[3] = {1, 1, 1}, high[3] = {-1, -1, -1};
  const BlockTree::Level& boxes = store_.tree().levels().front();
  const std::size_t last = active_[cell.end - 1] / PointStore::kBlock;
  for (std::size_t b = active_[cell.begin] / PointStore::kBlock; b <= last; ++b) {
    const float mins[3] = {boxes.min_x[b], boxes.min_y[b], boxes.min_z[b]};
    const float maxs[3] = {boxes.max_x[b], boxes.max_y[b], boxes.max_z[b]};
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], mins[a]);
      high[a] = std::max(high[a], maxs[a]);
    }
  }
  const double widest = 1.0 / kGolden + plan_.constants.ball.largest_shift;
  const auto reach = static_cast<float>(kReachMargin * plan_.levelRadius(level) * widest);
  for (int a = 0; a < 3; ++a) {
    low[a] -= reach;
    high[a] += reach;
  }
  nearby.collect(store_.tree(), low, high);
}

/** Drops the points that are done. A level that only divided its balls has none to drop: the next
 * one uses another mark and the same points. */
void LevelCover::endLevel(std::size_t first_output) {
  const auto begin = outputs_.begin() + static_cast<std::ptrdiff_t>(first_output);
  const bool lasts = std::any_of(begin, outputs_.end(), [](const Output& o) { return o.lasts; });
  if (lasts || level_mark_ == kLastLevelMark) {
    dropDone();
    level_mark_ = kFirstLevelMark;
  } else {
    level_mark_ = static_cast<std::uint8_t>(level_mark_ << 1);
  }
  done_marks_ = kNoFinerMark | level_mark_;
}

/** Keeps the points that are neither covered nor done with; level marks are wiped. */
void LevelCover::dropDone() {
  std::vector<std::size_t> kept((active_.size() + kSlice - 1) / kSlice);
  forSlices(active_.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t next = begin;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t point = active_[i];
      marks_[point] &= kNoFinerMark | kLoneNormalMark;
      active_[next] = point;
      next += !isDone(point);
    }
    kept[begin / kSlice] = next - begin;
  });
  std::size_t end = 0;
  for (std::size_t s = 0; s < kept.size(); ++s) {
    const auto begin = active_.begin() + static_cast<std::ptrdiff_t>(s * kSlice);
    const auto target = active_.begin() + static_cast<std::ptrdiff_t>(end);
    if (begin != target) std::copy_n(begin, kept[s], target);
    end += kept[s];
  }
  active_.resize(end);
}

PointCounts LevelCover::countPoints() const {
  const std::size_t n = core_.size();
  std::vector<PointCounts> parts((n + kSlice - 1) / kSlice);
  forSlices(n, [&](std::size_t begin, std::size_t end) {
    PointCounts& part = parts[begin / kSlice];
    for (std::size_t i = core_.begin + begin; i < core_.begin + end; ++i) {
      part.uncovered += coverage_[i] < plan_.gamma;
      part.unsupported += coverage_[i] <= 0.0f;
      part.lone_normals += (marks_[i] & kLoneNormalMark) != 0;
    }
  });
  PointCounts sum;
  sum.unresolved = unresolved_;
  for (const Output& output : outputs_) sum.unresolved += output.unresolved;
  for (const PointCounts& part : parts) {
    sum.uncovered += part.uncovered;
    sum.unsupported += part.unsupported;
    sum.lone_normals += part.lone_normals;
  }
  return sum;
}

void LevelCover::countBytes() {
  std::uint64_t bytes = outputs_.capacity() * sizeof(Output);
  for (const auto& worker : workers_) bytes += worker->arena.capacity() * sizeof(SurfelRecord);
  bytes += coverage_.size() * sizeof(float) + marks_.size() +
           active_.capacity() * sizeof(std::uint32_t) + cells_.memoryBytes();
  peak_bytes_ = std::max(peak_bytes_, bytes);
}

std::vector<LevelCover::Piece> LevelCover::pieces() const {
  std::vector<Piece> pieces;
  std::size_t first = 0;
  for (const Output& output : outputs_) {
    const SurfelRecord* records = worker(output.thread).arena.data();
    if (output.begin == output.end) continue;
    pieces.push_back({records + output.begin, records + output.end, first});
    first += output.end - output.begin;
  }
  return pieces;
}

BallCounters LevelCover::counters() const {
  BallCounters sum;
  for (const auto& worker : workers_) {
    const BallCounters counters = worker->fitter.counters();
    sum.gathered += counters.gathered;
    sum.split_sheets += counters.split_sheets;
    sum.tried += counters.tried;
    sum.lines += counters.lines;
    sum.fits += counters.fits;
  }
  return sum;
}

}  // namespace pcl_slim::detail
