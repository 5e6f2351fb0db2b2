// SPDX-License-Identifier: BSD-3-Clause
#include "ball.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "least_squares/least_squares.h"
#include "pcl_slim/core/extent.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

void takeEveryNth(const BlockList& blocks, std::size_t stride, BlockList& taken) {
  taken.clear();
  for (std::size_t b = 0; b < blocks.size(); b += stride) taken.push_back(blocks[b]);
}

constexpr double kNormalLength = 1e-6;  ///< least length of a mean of unit normals in float

/** The mean normal; the site's own where the points' cancel. */
Vector3 meanNormal(const BallSums& sums, const BallSite& site) {
  const Vector3& n = sums.normal;
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length > kNormalLength * sums.weight) return {n[0] / length, n[1] / length, n[2] / length};
  return {site.normal[0], site.normal[1], site.normal[2]};
}

/** The direction of least spread; z where all points coincide. */
Vector3 leastSpread(const BallSums& sums) {
  const auto& s = sums.second;
  const double inverse = 1.0 / sums.weight;
  const Eigen::Vector3d mean =
      Eigen::Vector3d(sums.first[0], sums.first[1], sums.first[2]) * inverse;
  Eigen::Matrix3d covariance;
  covariance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  covariance = covariance * inverse - mean * mean.transpose();
  covariance /= std::max(covariance.trace(), 1e-300);  // no division by 0
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(covariance);
  const Eigen::Vector3d n = axes.eigenvectors().col(0);
  if (!n.allFinite() || n.squaredNorm() < 0.5) return {0.0, 0.0, 1.0};
  return {n[0], n[1], n[2]};
}

/** The weighted sums of a ball that is framed already, in its frame. */
BallSums sumsOf(const BallBuffer& ball) {
  BallSums sums;
  for (std::size_t i = 0; i < ball.count; ++i) {
    const double g = evaluateKernel(WeightKernel::kPower4, ball.s_sq[i]);
    const double p[3] = {ball.u[i], ball.v[i], ball.w[i]};
    sums.weight += g;
    for (std::size_t a = 0, k = 0; a < 3; ++a) {
      sums.first[a] += g * p[a];
      for (std::size_t b = a; b < 3; ++b, ++k) sums.second[k] += g * p[a] * p[b];
    }
  }
  return sums;
}

/** The axes of one frame in coordinates of another. */
LocalFrame frameWithin(const LocalFrame& frame, const LocalFrame& other) {
  const auto coordinates = [&](const Vector3& axis) {
    return Vector3{dot(axis, other.u), dot(axis, other.v), dot(axis, other.w)};
  };
  LocalFrame within;
  within.u = coordinates(frame.u);
  within.v = coordinates(frame.v);
  within.w = coordinates(frame.w);
  return within;
}

/** The nearest place on the grid of centres. */
std::array<float, 3> onCenterGrid(const std::array<double, 3>& place, double grid) {
  std::array<float, 3> center;
  for (std::size_t a = 0; a < 3; ++a)
    center[a] = static_cast<float>(std::round(place[a] / grid) * grid);
  return center;
}

/** Turns a ball that has lost points to the direction of least spread of those that it kept.
 */
FramedBall reframed(const FramedBall& ball) {
  const BallSums sums = sumsOf(*ball.points);
  if (!(sums.weight > 0)) return ball;
  const LocalFrame old = ball.frame();
  const Vector3 local = leastSpread(sums);
  Vector3 normal;
  for (std::size_t a = 0; a < 3; ++a)
    normal[a] = local[0] * old.u[a] + local[1] * old.v[a] + local[2] * old.w[a];
  FramedBall result = ball;
  result.normal = snapNormal(normal);
  kernels::toFrame(frameWithin(result.frame(), old), 1.0f, *ball.points);
  return result;
}

}  // namespace

BallSite siteOf(const PointStore& store, const FitPlan& plan, std::size_t i, double radius) {
  const double noise_ratio = plan.noiseRatioAt(i, store.size());
  BallSite site;
  site.center = onCenterGrid(store.position(i), plan.center_grid);
  if (plan.with_normals) site.normal = store.normal(i);
  site.sided = site.normal != std::array<float, 3>{};
  site.radius = radius;
  site.lambda = noise_ratio * plan.energy.lambda;
  site.noise = noise_ratio * plan.noise;
  return site;
}

GatheredBall BallGatherer::gather(const BallSite& site, std::size_t stride) {
  const BlockList* blocks = &nearby_.within(site.center, site.radius);
  if (stride > 1) {
    takeEveryNth(*blocks, stride, sampled_);
    blocks = &sampled_;
  }
  GatheredBall ball;
  ball.site = site;
  ball.points = &points_;
  const BallQuery query{site.center, static_cast<float>(site.radius),
                        site.sided ? site.normal.data() : nullptr, plan_.min_dot,
                        plan_.normal_error > 0};
  kernels::gatherBall(store_, *blocks, query, !site.sided, points_, ball.sums);
  gathered_ += points_.count;
  return ball;
}

bool normalIsAlone(const GatheredBall& ball, const FitPlan& plan) {
  if (!plan.with_normals || !plan.skip_lone_normals) return false;
  const BallConstants& constants = plan.constants.ball;
  const BallSums& sums = ball.sums;
  const auto on_its_side = static_cast<double>(ball.points->count);
  if (on_its_side < constants.lone_share * static_cast<double>(sums.inside)) return true;
  const auto& n = sums.normal;
  const auto& own = ball.site.normal;
  return n[0] * own[0] + n[1] * own[1] + n[2] * own[2] < constants.lone_cosine * sums.weight;
}

FramedBall framed(const GatheredBall& ball, const FitPlan& plan) {
  const BallSite& site = ball.site;
  FramedBall result{site, {}, ball.points};
  result.normal = snapNormal(site.sided ? meanNormal(ball.sums, site) : leastSpread(ball.sums));
  if (plan.normal_error > 0) {
    // An error of the normal's direction has half its variance in each of two slopes.
    const double slope_error = plan.normal_error * site.radius;
    ball.points->slope_weight = 2.0 * site.noise / (slope_error * slope_error);
  }
  kernels::toFrame(result.frame(), static_cast<float>(site.radius), *ball.points);
  return result;
}

/** \brief The interval of residuals that belongs to the centre's sheet. */
struct SheetRange {
  bool split = false;
  float low = 0, high = 0;
};

namespace {

constexpr int kMostBins = 128;  ///< room for the histogram

/** How many residuals fall into each of equally wide bins. */
struct Histogram {
  int bins;
  double from, to_bin;  ///< residual at the first bin's edge, and bins per length
  std::array<std::int32_t, kMostBins> count{};

  const std::int32_t* begin() const { return count.data(); }
  const std::int32_t* end() const { return count.data() + bins; }
};

Histogram histogramOf(const float* residuals, std::size_t count, std::size_t stride, float low,
                      double width, const SheetConstants& constants) {
  Histogram h;
  h.bins = std::min(constants.bins, kMostBins);
  h.from = low;
  h.to_bin = h.bins / width;
  for (std::size_t i = 0; i < count; i += stride) {
    const int bin = std::min(static_cast<int>((residuals[i] - h.from) * h.to_bin), h.bins - 1);
    h.count[static_cast<std::size_t>(bin)] += 1;
  }
  return h;
}

/** Bin after which Otsu's two classes part best. */
int otsuThreshold(const Histogram& h) {
  std::int64_t total = 0, moment = 0;
  for (int b = 0; b < h.bins; ++b) {
    total += h.begin()[b];
    moment += b * h.begin()[b];
  }
  std::int64_t below = 0, below_moment = 0;
  double best = -1;
  int threshold = 0;
  for (int b = 0; b < h.bins - 1; ++b) {
    below += h.begin()[b];
    below_moment += b * h.begin()[b];
    const std::int64_t both = below * (total - below);
    if (both <= 0) continue;
    // The variance between the classes, below * above * gap^2, over one denominator.
    const auto gap = static_cast<double>(below_moment * total - moment * below);
    const double between = gap * gap / static_cast<double>(both);
    if (between > best) {
      best = between;
      threshold = b;
    }
  }
  return threshold;
}

/** The deepest bin between two peaks, if it is deep enough; else the histogram's end. */
const std::int32_t* valleyOf(const Histogram& h, double depth_ratio) {
  const int threshold = otsuThreshold(h);
  const std::int32_t* lower_peak = std::max_element(h.begin(), h.begin() + threshold + 1);
  const std::int32_t* upper_peak = std::max_element(h.begin() + threshold + 1, h.end());
  // The depth is that of three bins: single empty bins are chance.
  const std::int32_t* valley = h.end();
  std::int32_t depth = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t* b = lower_peak + 1; b + 1 < upper_peak; ++b) {
    const std::int32_t three = b[-1] + b[0] + b[1];
    if (three < depth) {
      depth = three;
      valley = b;
    }
  }
  const bool deep = depth / 3.0 < depth_ratio * std::min(*lower_peak, *upper_peak);
  return deep ? valley : h.end();
}

/** Two sheets are far apart compared with their thickness; the ripple of one badly fitted sheet,
 * which has two peaks as well, is not. */
bool standsApart(const Histogram& h, int valley, double apart) {
  double count[2] = {}, sum[2] = {}, square[2] = {};
  for (int b = 0; b < h.bins; ++b) {
    const int side = b > valley;
    const std::int32_t here = h.begin()[b];
    count[side] += here;
    sum[side] += static_cast<double>(here) * b;
    square[side] += static_cast<double>(here) * b * b;
  }
  if (count[0] <= 0 || count[1] <= 0) return false;
  const double gap = sum[1] / count[1] - sum[0] / count[0];
  const double within =
      (square[0] - sum[0] * sum[0] / count[0]) + (square[1] - sum[1] * sum[1] / count[1]);
  return gap * gap > apart * apart * within / (count[0] + count[1]);
}

/** Looks for two sheets in the residuals of one ball (docs/theory.md, "Sheets").
 *
 * Otsu's threshold on a histogram; two sheets only if the valley between the peaks is low, and the
 * means of the sides are apart compared with their thickness. \param[in] center_residual residual
 * of the ball's centre. O(count).
 */
SheetRange findSheet(const float* residuals, std::size_t count, double center_residual,
                     const SheetConstants& constants) {
  SheetRange range;
  if (count < constants.points) return range;
  const auto [low, high] = extentOf(residuals, count);
  const double width = static_cast<double>(high) - low;
  if (!(width > 0)) return range;
  const std::size_t stride = count / constants.counted + 1;
  const Histogram h = histogramOf(residuals, count, stride, low, width, constants);
  const std::int32_t* const valley = valleyOf(h, constants.valley);
  if (valley == h.end()) return range;
  const auto at = static_cast<int>(valley - h.begin());
  if (!standsApart(h, at, constants.apart)) return range;
  double below = 0;
  for (const std::int32_t* b = h.begin(); b <= valley; ++b) below += *b;
  const std::size_t taken = count / stride;
  const auto counted = static_cast<double>(taken);
  const double least = constants.least_side * counted;
  if (below < least || counted - below < least) return range;
  const double cut = h.from + (static_cast<double>(at) + 0.5) / h.to_bin;
  range.split = true;
  range.low = center_residual <= cut ? low : static_cast<float>(cut);
  range.high = center_residual <= cut ? static_cast<float>(cut) : high;
  return range;
}

}  // namespace

FramedBall recentred(const FramedBall& ball, const FitPlan& plan, std::size_t stride,
                     BallGatherer& gatherer, RadiusSearch& search) {
  const BallConstants& constants = plan.constants.ball;
  const Trial& right = search.right();
  const double offset = right.fit.c[0];  // of the radius
  if (!right.supported || std::abs(offset) < constants.off_center ||
      std::abs(offset) > constants.largest_shift) {
    return ball;
  }
  BallSite site = ball.site;
  std::array<double, 3> moved;
  for (std::size_t a = 0; a < 3; ++a)
    moved[a] = site.center[a] + offset * site.radius * ball.normal[a];
  site.center = onCenterGrid(moved, plan.center_grid);
  const FramedBall result = framed(gatherer.gather(site, stride), plan);
  search.begin(*result.points, site.radius, 1.0);
  return result;
}

SheetRange SheetSplitter::sheetAt(const FramedBall& ball, const SheetConstants& constants,
                                  RadiusSearch& search) {
  const LocalFit& fit = search.right().fit;
  const double radius = ball.site.radius, e_sq = fit.residual_sq * radius * radius;
  if (fit.degree == 0 || e_sq <= constants.noise * search.noise()) return {};
  residuals_.resize(ball.points->count + BallBuffer::kPadding);
  kernels::ballResiduals(*ball.points, fit.degree, fit.c.data(), residuals_.data());
  return findSheet(residuals_.data(), ball.points->count, -fit.c[0], constants);
}

FramedBall SheetSplitter::ownSheet(FramedBall ball, const SheetConstants& constants,
                                   RadiusSearch& search) {
  bool split = false;
  for (int pass = 0; pass < constants.passes; ++pass) {
    const SheetRange range = sheetAt(ball, constants, search);
    if (!range.split) break;
    kernels::selectResiduals(*ball.points, residuals_.data(), range.low, range.high, kept_);
    std::swap(*ball.points, kept_);
    ball = reframed(ball);
    search.begin(*ball.points, ball.site.radius, 1.0);
    split = true;
  }
  split_ += split;
  return ball;
}

namespace {

/** Gives a linear surfel its plane's own normal: f is then w' - c_0, and only c_0 is left to store.
 */
void framePlane(SurfelRecord& surfel) {
  const LocalFrame frame({surfel.normal[0], surfel.normal[1], surfel.normal[2]});
  const double c0 = surfel.c[0], cu = surfel.c[1], cv = surfel.c[2];
  const double length = std::sqrt(1.0 + cu * cu + cv * cv);
  std::array<double, 3> normal;
  for (int a = 0; a < 3; ++a) normal[a] = frame.w[a] - cu * frame.u[a] - cv * frame.v[a];
  surfel.normal = snapNormal(normal);
  surfel.c = {static_cast<float>(c0 / length)};
}

/** Coefficients in units of r from those in units of the gather radius: c_ij rho^(i + j - 1). */
void setCoefficients(const Trial& trial, SurfelRecord& surfel) {
  surfel.c.fill(0.0f);
  double factor = 1.0 / trial.rho;
  for (int d = 0, k = 0; d <= trial.fit.degree; ++d, factor *= trial.rho) {
    for (int j = 0; j <= d; ++j, ++k) surfel.c[k] = static_cast<float>(trial.fit.c[k] * factor);
  }
}

/** Whether a surface can store a polynomial. Points in a row across their plane, as where x and y are in
 * another unit than z, give one that is too steep. */
bool isUsable(const SurfelRecord& surfel) {
  return std::all_of(surfel.c.begin(), surfel.c.end(),
                     [](float c) { return std::abs(c) <= kMostCoefficient; });
}

/** \brief The surfel of a ball whose radius is chosen: its polynomial in units of that radius,
 * without what noise adds to it on average (docs/theory.md, "Bias"). */
SurfelRecord recordOf(const FramedBall& ball, const RadiusChoice& choice, int level,
                      const BiasConstants& constants) {
  const Trial& trial = choice.trial;
  const double unit = ball.site.radius;
  SurfelRecord surfel;
  surfel.center = ball.site.center;
  surfel.normal = ball.normal;
  surfel.sided = ball.site.sided;
  surfel.radius = static_cast<float>(trial.rho * unit);
  surfel.error = static_cast<float>(std::sqrt(trial.fit.residual_sq) * unit);
  surfel.effective_count = static_cast<float>(trial.fit.n_eff);
  surfel.degree = static_cast<std::uint8_t>(trial.fit.degree);
  surfel.level = static_cast<std::uint8_t>(level);
  surfel.flags = choice.kind == RadiusChoice::Kind::kLeaf ? kSurfelLeaf : 0;
  if (choice.support_limited) surfel.flags |= kSurfelSupportLimited;
  setCoefficients(trial, surfel);
  const double share = ball.site.noise / (trial.rho * trial.rho * unit * unit);
  undoNoiseBias(constants, trial.fit.kernel, surfel.degree, share, surfel.c.data());
  if (surfel.degree == 1) framePlane(surfel);
  if (choice.kind != RadiusChoice::Kind::kLeaf && !isUsable(surfel)) {  // the parent of finer ones
    surfel.degree = 1;
    surfel.c.fill(0.0f);
  }
  return surfel;
}

}  // namespace

BallOutcome BallFitter::fit(std::size_t i, int level, SurfelRecord& surfel) {
  ++tried_;
  const BallSite site = siteOf(store_, plan_, i, plan_.levelRadius(level));
  search_.setNoise(site.lambda);
  if (tooWideAtAGlance(site, level, surfel)) return BallOutcome::kInternal;
  FramedBall ball;
  const BallOutcome outcome = prepare(site, 1, ball);
  if (outcome != BallOutcome::kLeaf) return outcome;
  if (plan_.internal_only) return widest(ball, level, surfel);
  const RadiusChoice choice = chooseRadius(ball);
  if (choice.kind == RadiusChoice::Kind::kSparse) {
    return withoutFit(ball, site, choice.trial, surfel);
  }
  if (missesItsCenter(choice)) return widest(ball, level, surfel);
  surfel = recordOf(ball, choice, level, plan_.constants.ball.bias);
  if (choice.kind == RadiusChoice::Kind::kLeaf && !isUsable(surfel))
    return widest(ball, level, surfel);
  return choice.kind == RadiusChoice::Kind::kLeaf ? BallOutcome::kLeaf : BallOutcome::kInternal;
}

/** Whether a leaf's surface passes its centre farther off than a ball can be moved: its frame is not
 * that of the surface there, as about a thin ridge, and the points of the centre are not on it. */
bool BallFitter::missesItsCenter(const RadiusChoice& choice) const {
  if (choice.kind != RadiusChoice::Kind::kLeaf || choice.support_limited || plan_.paper)
    return false;
  return std::abs(choice.trial.fit.c[0]) > plan_.constants.ball.largest_shift * choice.trial.rho;
}

/** The surfel at r_r, the parent of finer ones. */
BallOutcome BallFitter::widest(const FramedBall& ball, int level, SurfelRecord& surfel) {
  if (!search_.right().supported) return BallOutcome::kUnsupported;
  RadiusChoice choice;
  choice.kind = RadiusChoice::Kind::kInternal;
  choice.trial = search_.right();
  surfel = recordOf(ball, choice, level, plan_.constants.ball.bias);
  return BallOutcome::kInternal;
}

/** Gathers and frames the points of every stride-th block. \return kLeaf where a radius can be
 * sought. */
BallOutcome BallFitter::prepare(const BallSite& site, std::size_t stride, FramedBall& ball) {
  const GatheredBall gathered = gatherer_.gather(site, stride);
  if (gathered.empty()) return BallOutcome::kUnsupported;
  if (normalIsAlone(gathered, plan_)) return BallOutcome::kLoneNormal;
  ball = onItsFit(ownSheet(searchable(framed(gathered, plan_), 1.0)), stride);
  return BallOutcome::kLeaf;
}

/** Lets the radius search begin on a ball. \param[in] rho_right r_r in units of its radius */
FramedBall BallFitter::searchable(const FramedBall& ball, double rho_right) {
  search_.begin(*ball.points, ball.site.radius, rho_right);
  return ball;
}

FramedBall BallFitter::ownSheet(const FramedBall& ball) {
  if (!plan_.split_sheets) return ball;
  return splitter_.ownSheet(ball, plan_.constants.ball.sheets, search_);
}

FramedBall BallFitter::onItsFit(const FramedBall& ball, std::size_t stride) {
  return plan_.paper ? ball : recentred(ball, plan_, stride, gatherer_, search_);
}

/** Seeks the radius of a ball; one with too few points is gathered again one radius wider. */
RadiusChoice BallFitter::chooseRadius(FramedBall& ball) {
  RadiusChoice choice = search_.search();
  if (choice.kind == RadiusChoice::Kind::kSparse) {
    BallSite wider = ball.site;
    wider.radius /= kGolden;
    ball = searchable(framed(gatherer_.gather(wider), plan_), kGolden);
    choice = search_.fallBack();
  }
  if (choice.kind == RadiusChoice::Kind::kLeaf) choice.trial = search_.refine(choice);
  return choice;
}

/** Many points without even a plane are along a line: a finer level may find the band they are. The
 * ball looked at is one radius wider than the site's, so that it contains the points marked. */
BallOutcome BallFitter::withoutFit(const FramedBall& ball, const BallSite& site, const Trial& trial,
                                   SurfelRecord& surfel) {
  const bool many = ball.points->count >= plan_.constants.ball.line_points;
  if (!many || trial.fit.degree > 0) return BallOutcome::kUnsupported;
  ++lines_;
  surfel.center = site.center;
  surfel.normal = site.normal;
  surfel.sided = site.sided;
  surfel.radius = static_cast<float>(kGolden * site.radius);
  return BallOutcome::kLine;
}

/** A sample of some thousand points shows that a wide ball must be divided: the rest is not read.
 */
bool BallFitter::tooWideAtAGlance(const BallSite& site, int level, SurfelRecord& surfel) {
  if (plan_.paper) return false;
  const BallConstants& constants = plan_.constants.ball;
  const std::size_t stride = gatherer_.countBlocks(site) / constants.glance_blocks;
  if (stride < constants.glance_stride) return false;
  FramedBall ball;
  if (prepare(site, stride, ball) != BallOutcome::kLeaf || !search_.surelyInternal()) return false;
  return widest(ball, level, surfel) == BallOutcome::kInternal;
}

}  // namespace pcl_slim::detail
