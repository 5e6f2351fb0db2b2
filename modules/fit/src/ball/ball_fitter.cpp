// SPDX-License-Identifier: BSD-3-Clause
#include "ball/ball_fitter.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "ball/noise_bias.h"
#include "ball/sheet_split.h"
#include "pcl_slim/surface/oct_normal.h"

namespace pcl_slim::detail {

namespace {

constexpr double kLoneNormal = 0.3;  ///< share of agreeing neighbours below which a normal is alone
constexpr double kTwoSheets =
    4.0;  ///< sheets that can be told apart leave e^2 above so many lambda
constexpr std::size_t kGlanceBlocks = 512;  ///< 8192 points: e^2 to some percent
constexpr std::size_t kLeastGlanceStride = 2;
constexpr double kOffCenter = 0.03;  ///< of r_r: a fit that passes its centre farther off is moved
/// n_eff per coefficient from which leaves are so few that half as many again, overlapping more, cost
/// little beside what blending gains.
constexpr double kWellSupported = 16.0;
constexpr double kGateMargin = 1e-6;  ///< of r: the least a coverage gate may be, for rounding

void
takeEveryNth(const BlockList& blocks, std::size_t stride, BlockList& taken)
{
  taken.clear();
  for (std::size_t b = 0; b < blocks.size(); b += stride) taken.push_back(blocks[b]);
}

/** Gives a linear surfel its plane's own normal: f is then w' - c_0, and only c_0 is left to store. */
void
framePlane(SurfelRecord& surfel)
{
  const LocalFrame frame({surfel.normal[0], surfel.normal[1], surfel.normal[2]});
  const double c0 = surfel.c[0], cu = surfel.c[1], cv = surfel.c[2];
  const double length = std::sqrt(1.0 + cu * cu + cv * cv);
  std::array<double, 3> normal;
  for (int a = 0; a < 3; ++a) normal[a] = frame.w[a] - cu * frame.u[a] - cv * frame.v[a];
  surfel.normal = snapNormal(normal);
  surfel.c = {static_cast<float>(c0 / length)};
}

}  // namespace

BallOutcome
BallFitter::fit(std::size_t i, int level, SurfelRecord& surfel)
{
  ++counters_.tried;
  listed_radius_ = -1.0f;
  const auto p = store_.position(i);
  for (int a = 0; a < 3; ++a) {
    center_[a] =
        static_cast<float>(std::round(p[a] / settings_.center_grid) * settings_.center_grid);
  }
  if (settings_.with_normals) gate_ = store_.normal(i);
  const double loudness = settings_.loudnessAt(i, store_.size());
  search_.setNoise(loudness * settings_.energy.lambda);
  noise_ = loudness * settings_.noise;
  const double r_right = settings_.levelRadius(level);
  if (!settings_.paper && tooWideAtAGlance(r_right, level, surfel)) return BallOutcome::kInternal;
  if (const BallOutcome outcome = prepare(r_right, 1); outcome != BallOutcome::kLeaf)
    return outcome;
  RadiusChoice choice = search_.search();
  if (choice.kind == RadiusChoice::Kind::kSparse) {
    gather_radius_ = r_right / kGolden;
    gather(gather_radius_);
    setFrame();
    search_.begin(ball_, gather_radius_, kGolden);
    choice = search_.fallBack();
    if (choice.kind == RadiusChoice::Kind::kSparse) return BallOutcome::kUnsupported;
  }
  if (choice.kind == RadiusChoice::Kind::kLeaf) choice.trial = search_.refine(choice);
  record(choice, level, surfel);
  return choice.kind == RadiusChoice::Kind::kLeaf ? BallOutcome::kLeaf : BallOutcome::kInternal;
}

/** Gathers one of so many blocks and frames them. \return kLeaf where a radius can be sought. */
BallOutcome
BallFitter::prepare(double radius, std::size_t stride)
{
  gather_radius_ = radius;
  stride_ = stride;
  if (!gather(radius)) return BallOutcome::kUnsupported;
  if (settings_.with_normals && settings_.skip_lone_normals && normalIsAlone()) {
    return BallOutcome::kLoneNormal;
  }
  setFrame();
  search_.begin(ball_, gather_radius_, 1.0);
  if (settings_.split_sheets) splitSheets();
  if (!settings_.paper) centerOnSurface();
  return BallOutcome::kLeaf;
}

/** Whether the ball's points turn elsewhere than the centre: too few share its side, or those that
 * do are the ball's rim, bent away from it. */
bool
BallFitter::normalIsAlone() const
{
  if (static_cast<double>(ball_.count) < kLoneNormal * static_cast<double>(sums_.inside))
    return true;
  const auto& n = sums_.normal;
  return n[0] * gate_[0] + n[1] * gate_[1] + n[2] * gate_[2] < kLoneNormal * sums_.weight;
}

/** Some thousand points tell that a wide ball must be divided: the rest need not be read. */
bool
BallFitter::tooWideAtAGlance(double radius, int level, SurfelRecord& surfel)
{
  const std::size_t stride = blocksWithin(center_, radius).size() / kGlanceBlocks;
  if (stride < kLeastGlanceStride) return false;
  const auto center = center_;
  if (prepare(radius, stride) == BallOutcome::kLeaf && search_.surelyInternal()) {
    record(RadiusChoice::internal(search_.right()), level, surfel);
    return true;
  }
  center_ = center;
  return false;
}

/** A centre that noise has thrown far off would see a lopsided part of the points: the ball moves
 * onto its own fit. */
void
BallFitter::centerOnSurface()
{
  const Trial& right = search_.right();
  const double offset = right.fit.c[0];  // of the radius
  if (!right.supported || std::abs(offset) < kOffCenter || std::abs(offset) > kLargestShift) return;
  for (int a = 0; a < 3; ++a) {
    const double moved = center_[a] + offset * gather_radius_ * normal_[a];
    center_[a] =
        static_cast<float>(std::round(moved / settings_.center_grid) * settings_.center_grid);
  }
  gather(gather_radius_);
  setFrame();
  search_.begin(ball_, gather_radius_, 1.0);
}

/** The blocks that meet a ball of this fit; those of the last one asked for are at hand. */
const BlockList&
BallFitter::blocksWithin(const std::array<float, 3>& center, double radius)
{
  const auto r = static_cast<float>(radius);
  if (r != listed_radius_ || center != listed_center_) {
    neighborhood_.blocksInBall(center.data(), r, blocks_);
    listed_center_ = center;
    listed_radius_ = r;
  }
  return blocks_;
}

bool
BallFitter::gather(double radius)
{
  const BlockList* blocks = &blocksWithin(center_, radius);
  if (stride_ > 1) {
    takeEveryNth(*blocks, stride_, sampled_);
    blocks = &sampled_;
  }
  const BallQuery query{center_, static_cast<float>(radius),
                        settings_.with_normals ? gate_.data() : nullptr, settings_.min_dot,
                        settings_.normal_error > 0};
  kernels::gatherBall(store_, *blocks, query, !settings_.with_normals, ball_, sums_);
  counters_.gathered += ball_.count;
  return ball_.count > 0 && sums_.weight > 0;
}

/** n_c: the mean normal of the ball, or the direction of least spread where none are given. */
std::array<double, 3>
BallFitter::frameNormal() const
{
  if (settings_.with_normals) {
    const auto& n = sums_.normal;
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 1e-6 * sums_.weight) return {n[0] / length, n[1] / length, n[2] / length};
    return {gate_[0], gate_[1], gate_[2]};
  }
  const auto& s = sums_.second;
  const double inverse = 1.0 / sums_.weight;
  const Eigen::Vector3d mean =
      Eigen::Vector3d(sums_.first[0], sums_.first[1], sums_.first[2]) * inverse;
  Eigen::Matrix3d covariance;
  covariance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  covariance = covariance * inverse - mean * mean.transpose();
  covariance /= std::max(covariance.trace(), 1e-300);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(covariance);
  const Eigen::Vector3d n = axes.eigenvectors().col(0);
  if (!n.allFinite() || n.squaredNorm() < 0.5) return {0.0, 0.0, 1.0};
  return {n[0], n[1], n[2]};
}

void
BallFitter::setFrame()
{
  normal_ = snapNormal(frameNormal());
  const LocalFrame frame({normal_[0], normal_[1], normal_[2]});
  if (settings_.normal_error > 0) {
    // An error of the normal's direction has half its variance in each of two slopes.
    const double slope_error = settings_.normal_error * gather_radius_;
    ball_.slope_weight = 2.0 * noise_ / (slope_error * slope_error);
  }
  kernels::toFrame(frame, static_cast<float>(gather_radius_), ball_);
}

void
BallFitter::record(const RadiusChoice& choice, int level, SurfelRecord& surfel) const
{
  const Trial& trial = choice.trial;
  surfel.center = center_;
  surfel.normal = normal_;
  surfel.radius = static_cast<float>(trial.rho * gather_radius_);
  surfel.error = static_cast<float>(std::sqrt(trial.fit.residual_sq) * gather_radius_);
  surfel.confidence = static_cast<float>(trial.fit.n_eff);
  surfel.degree = static_cast<std::uint8_t>(trial.fit.degree);
  surfel.level = static_cast<std::uint8_t>(level);
  surfel.flags = choice.kind == RadiusChoice::Kind::kLeaf ? kSurfelLeaf : 0;
  if (choice.support_limited) surfel.flags |= kSurfelForced;
  surfel.c.fill(0.0f);
  // From units of the gather radius to units of r: c_ij rho^(i + j - 1).
  double factor = 1.0 / trial.rho;
  for (int d = 0, k = 0; d <= trial.fit.degree; ++d, factor *= trial.rho) {
    for (int j = 0; j <= d; ++j, ++k) surfel.c[k] = static_cast<float>(trial.fit.c[k] * factor);
  }
  undoNoiseBias(surfel.degree, noise_ / (trial.rho * trial.rho * gather_radius_ * gather_radius_),
                surfel.c.data());
  if (surfel.degree == 1) framePlane(surfel);
}

void
BallFitter::cover(const SurfelRecord& surfel, float* coverage)
{
  const bool supported = surfel.confidence > kWellSupported * numCoefficients(surfel.degree);
  const double alpha = supported ? settings_.supported_alpha : settings_.alpha;
  const auto reach = static_cast<float>(alpha * surfel.radius);
  const BlockList& blocks = blocksWithin(surfel.center, reach);
  kernels::CoverLeaf leaf;
  leaf.ball = {surfel.center, reach, settings_.with_normals ? surfel.normal.data() : nullptr,
               settings_.min_dot};
  leaf.frame = LocalFrame({surfel.normal[0], surfel.normal[1], surfel.normal[2]});
  leaf.degree = surfel.degree;
  leaf.support_radius = surfel.radius;
  leaf.to_foot = !settings_.paper;
  leaf.c = surfel.c.data();
  leaf.max_residual =
      settings_.residual_gate > 0
          ? static_cast<float>(settings_.residual_gate * surfel.error + kGateMargin * surfel.radius)
          : surfel.radius;
  kernels::coverPoints(store_, blocks, leaf, settings_.cover_kernel, coverage);
}

void
BallFitter::mark(const SurfelRecord& surfel, std::uint8_t value, std::uint8_t* marks)
{
  const BlockList& blocks = blocksWithin(surfel.center, surfel.radius);
  const BallQuery query{surfel.center, surfel.radius,
                        settings_.with_normals ? surfel.normal.data() : nullptr, settings_.min_dot};
  kernels::markPoints(store_, blocks, query, value, marks);
}

/** Where the residuals at r_r show two sheets, keeps the centre's and frames it anew. */
bool
BallFitter::splitSheets()
{
  bool split = false;
  for (int pass = 0; pass < 2; ++pass) {
    const LocalFit& fit = search_.right().fit;
    const double e_sq = fit.residual_sq * gather_radius_ * gather_radius_;
    if (fit.degree == 0 || e_sq <= kTwoSheets * search_.noise()) break;
    residuals_.resize(ball_.count + BallBuffer::kPadding);
    kernels::ballResiduals(ball_, fit, residuals_.data());
    const SheetRange range = findSheet(residuals_.data(), ball_.count, -fit.c[0]);
    if (!range.split) break;
    kernels::selectResiduals(ball_, residuals_.data(), range.low, range.high, kept_);
    std::swap(ball_, kept_);
    reframe();
    search_.begin(ball_, gather_radius_, 1.0);
    split = true;
  }
  counters_.split_sheets += split;
  return split;
}

/** Turns a ball already in frame coordinates to the direction of least spread of what it kept. */
void
BallFitter::reframe()
{
  double weight = 0, first[3] = {}, second[6] = {};
  for (std::size_t i = 0; i < ball_.count; ++i) {
    const double g = evaluateKernel(WeightKernel::kPower4, ball_.s_sq[i]);
    const double p[3] = {ball_.u[i], ball_.v[i], ball_.w[i]};
    weight += g;
    for (int a = 0, k = 0; a < 3; ++a) {
      first[a] += g * p[a];
      for (int b = a; b < 3; ++b, ++k) second[k] += g * p[a] * p[b];
    }
  }
  if (!(weight > 0)) return;
  sums_.weight = weight;
  std::copy(first, first + 3, sums_.first.begin());
  std::copy(second, second + 6, sums_.second.begin());
  const LocalFrame old({normal_[0], normal_[1], normal_[2]});
  const auto local = frameNormal();
  std::array<double, 3> world;
  for (int a = 0; a < 3; ++a) {
    world[a] = local[0] * old.u[a] + local[1] * old.v[a] + local[2] * old.w[a];
  }
  normal_ = snapNormal(world);
  const LocalFrame now({normal_[0], normal_[1], normal_[2]});
  const auto inOld = [&](const std::array<double, 3>& axis) {
    const auto dot = [&](const std::array<double, 3>& other) {
      return axis[0] * other[0] + axis[1] * other[1] + axis[2] * other[2];
    };
    return std::array<double, 3>{dot(old.u), dot(old.v), dot(old.w)};
  };
  LocalFrame turn;
  turn.u = inOld(now.u);
  turn.v = inOld(now.v);
  turn.w = inOld(now.w);
  kernels::toFrame(turn, 1.0f, ball_);
}

}  // namespace pcl_slim::detail
