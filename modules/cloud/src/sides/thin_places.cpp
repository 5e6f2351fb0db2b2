// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Sides before the cover": whether a cloud needs sides.
#include <algorithm>
#include <cmath>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kPointsPerPlace = 1000;  ///< one place is looked at for this many points ...
constexpr std::size_t kLeastPlaces = 64, kMostPlaces = 256;  ///< ... within these bounds
constexpr std::size_t kPatch = 48;                           ///< points of its smallest patch ...
constexpr std::size_t kWider = 4;                            ///< ... and the factor to the next
constexpr std::size_t kPatchPoints =
    384;  ///< points looked at in a patch; larger patches are sampled
constexpr std::size_t kMostPatch =
    12288;  ///< points of the widest patch: wider ones cost more than a fit

/** Whether one sheet is above the other, and not side by side as the faces of an edge are. */
bool overlap(const Eigen::Matrix3Xd& local, double middle) {
  Eigen::Vector2d sum[2] = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  double count[2] = {0, 0};
  for (Eigen::Index i = 0; i < local.cols(); ++i) {
    const int side = local(0, i) > middle;
    count[side] += 1;
    sum[side] += local.col(i).tail<2>();
  }
  const Eigen::Vector2d means[2] = {sum[0] / count[0], sum[1] / count[1]};
  const Eigen::Vector2d between = means[1] - means[0];
  double squares[2] = {0, 0};
  for (Eigen::Index i = 0; i < local.cols(); ++i) {
    const int side = local(0, i) > middle;
    squares[side] += std::pow(between.dot(local.col(i).tail<2>() - means[side]), 2);
  }
  const double length_sq = between.squaredNorm();
  return length_sq * length_sq < 0.5 * (squares[0] / count[0] + squares[1] / count[1]);
}

/** Two sheets in a patch; a gap of 0: there is one. */
struct SheetGap {
  double gap = 0, within_sq = 0;  ///< distance of the two means, variance about them
};

/** Parts a patch by two-means on heights along its normal. */
SheetGap gapOf(const Eigen::Matrix3Xd& local, const SideConstants& constants) {
  const Eigen::ArrayXd heights = local.row(0).transpose().array();
  const auto total = static_cast<double>(heights.size());
  double middle = 0, above = 0, gap = 0;
  for (int pass = 0; pass < constants.passes; ++pass) {
    double sum = 0;
    above = 0;
    for (const double height : heights) {
      above += height > middle;
      sum += height > middle ? height : 0.0;
    }
    if (above < 1 || above > total - 1) return {};
    gap = sum / above + sum / (total - above);
    if (pass + 1 < constants.passes) middle = 0.5 * (sum / above - sum / (total - above));
  }
  const double between = above * (total - above) / total * gap * gap;
  const double within = std::max(0.0, heights.square().sum() - between) / total;
  const bool two = std::min(above, total - above) > constants.least_side * total &&
                   gap * gap > constants.apart * constants.apart * within && overlap(local, middle);
  return two ? SheetGap{gap, within} : SheetGap{};
}

/** Whether a patch's points are a rod, no wider across it than thick. */
bool formsRod(const Eigen::Vector3d& spreads, const SideConstants& constants) {
  return spreads[1] < constants.rod * spreads[2] && spreads[0] > constants.thick_rod * spreads[1];
}

/** Excess kurtosis of residuals: 0 of Gaussian noise; of two sheets, as many points on each at +- a
 * with noise s, -2 a^4 / (a^2 + s^2)^2. */
double excessOf(const PatchCubic& cubic) {
  const std::size_t count = cubic.places.size();
  double squares = 0, fourths = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double square = cubic.residuals[i] * cubic.residuals[i];
    squares += square;
    fourths += square * square;
  }
  return squares > 0 ? static_cast<double>(count) * fourths / (squares * squares) - 3 : 0;
}

/** What one place shows. */
struct PlaceFigures {
  double spacing = 0;    ///< by its smallest patch
  double variance = -1;  ///< of a cubic's residuals, where it fits; of two sheets, within each
  bool thin = false;     ///< no patch of one sheet alone fits, or two within one noise
  bool flat = false;     ///< the latter
  bool facing = false;   ///< one does, and beyond it there is another sheet
  bool near = false;     ///< two sheets that a fit may part by itself, or not
};

constexpr double kFilled = 0.15;  ///< a cubic's RMS residual over the radius of a patch that fits
constexpr double kRelief =
    4;  ///< growth of the variance to the next patch that is a rough surface's own
constexpr double kDeviations =
    1.5;  ///< standard deviations of the kurtosis by which residuals are flatter, too
constexpr double kClean =
    10.0;  ///< SideConstants::apart from which a fit parts sheets without help, ...
constexpr double kClearGap =
    3.0;  ///< ... but by smaller balls where they are this far apart [spacings]
constexpr int kBeyond =
    2;  ///< wider patches, after one that fits, in which a place's other side is sought

/** Looks at wider and wider patches of one place until one fits. */
class PlaceLook {
 public:
  explicit PlaceLook(const SideConstants& constants) : constants_(&constants) {}

  /** \return whether a wider patch must be looked at */
  bool look(const Patch& patch) {
    if (!(patch.radius > 0)) return false;
    if (!(figures_.spacing > 0))
      figures_.spacing = patch.radius * std::sqrt(M_PI / static_cast<double>(kPatch));
    if (fits_) return lookBeyond(patch);
    if (showsTwoSides(patch, figures_)) return false;
    thread_local PatchCubic cubic;
    fits_ = fitCubic(patch, cubic) && std::sqrt(cubic.variance) <= kFilled * patch.radius;
    // Relief of the surface itself grows with the patch; noise and the far side of a part do not.
    figures_.thin = !fits_ && !(last_ > 0 && cubic.variance > kRelief * last_);
    (fits_ ? figures_.variance : last_) = cubic.variance;
    return !(fits_ && partResiduals(cubic));
  }

  const PlaceFigures& figures() const { return figures_; }
  bool showsAnotherSide() const { return figures_.thin || figures_.facing || figures_.near; }
  /** The place has one side, whatever its patches show. */
  void setOneSided() { figures_.thin = figures_.flat = figures_.facing = figures_.near = false; }
  /** The place has two, though its patches may show one. */
  void setTwoSided() {
    if (showsAnotherSide()) return;
    figures_.thin = true;
    figures_.variance = -1;
  }

 private:
  /** Whether residuals are two sheets that seem one rough sheet: flatter than chance makes Gaussian
   * ones. */
  bool partResiduals(const PatchCubic& cubic) {
    const double deviation = std::sqrt(24 / static_cast<double>(cubic.places.size()));
    const double excess = excessOf(cubic);
    if (excess > -constants_->flatter - kDeviations * deviation) return false;
    figures_.thin = figures_.flat = true;
    figures_.variance *= 1 - std::sqrt(std::min(1.0, -0.5 * excess));
    return true;
  }

  /** Whether a patch is a rod or two sheets. The latter are thin unless they part by themselves. */
  bool showsTwoSides(const Patch& patch, PlaceFigures& figures) const {
    const auto axes = principalAxes(patch.points);
    figures.thin = formsRod(axes.eigenvalues(), *constants_);
    if (figures.thin) return true;
    Eigen::Matrix3Xd local(3, static_cast<Eigen::Index>(patch.points.size()));
    for (std::size_t i = 0; i < patch.points.size(); ++i)
      local.col(static_cast<Eigen::Index>(i)) = patch.points.at(i);
    local = axes.eigenvectors().transpose() * (local.colwise() - local.rowwise().mean()).eval();
    const SheetGap sheets = gapOf(local, *constants_);
    if (!(sheets.gap > 0)) return false;
    const double clean_sq = kClean * kClean * sheets.within_sq;
    figures.thin = sheets.gap * sheets.gap < clean_sq;
    figures.facing = !figures.thin && sheets.gap > kClearGap * figures.spacing;
    figures.near = !figures.thin && !figures.facing;
    return true;
  }

  /** Looks for another side in a patch wider than one that fits. \return whether to try a wider one
   */
  bool lookBeyond(const Patch& patch) {
    PlaceFigures beyond = figures_;
    if (showsTwoSides(patch, beyond)) {
      figures_.facing = beyond.thin || beyond.facing;
      return false;
    }
    return ++beyond_ < kBeyond;
  }

  const SideConstants* constants_;
  PlaceFigures figures_;
  double last_ = 0;  ///< variance of the patch before, which did not fit
  bool fits_ = false;
  int beyond_ = 0;  ///< wider patches looked at after one that fits
};

constexpr double kOneSided = 0.5;  ///< cosine of beams' angles that leaves a place one side

/** What the beams of a patch's points show of its sides. */
enum class BeamSides { kUnknown, kOne, kTwo };

/** One side where all neighbours were seen from about the direction that the sample was seen from;
 * two where a share of them was clearly seen from either side of the patch. */
BeamSides sidesByBeams(const PointStore& store, const std::vector<std::uint32_t>& neighbors,
                       std::size_t sample, const Patch& patch, const SideConstants& constants) {
  const auto beam = [&](std::size_t i) {
    return normalized(subtract(store.position(i), store.sensor(i)));
  };
  const Vector3 own = beam(sample);
  const Eigen::Vector3d axis = principalAxes(patch.points).eigenvectors().col(0);
  const Vector3 normal{axis[0], axis[1], axis[2]};
  double above = 0, below = 0;
  bool alike = true;
  for (const std::uint32_t i : neighbors) {
    const Vector3 other = beam(i);
    const double cosine = dot(other, normal);
    above += cosine > constants.clear_beam;
    below += cosine < -constants.clear_beam;
    alike = alike && dot(own, other) > kOneSided;
  }
  if (alike) return BeamSides::kOne;
  const double least = constants.least_side * static_cast<double>(neighbors.size());
  return std::min(above, below) > least ? BeamSides::kTwo : BeamSides::kUnknown;
}

constexpr double kFlatPlaces = 0.1;  ///< share of places that noise is taken from

ThinPlaces summarize(const std::vector<PlaceLook>& looks,
                     const std::vector<std::size_t>& looked_at) {
  ThinPlaces places;
  const double share = 1 / static_cast<double>(std::max<std::size_t>(looks.size(), 1));
  std::vector<double> spacings, variances;
  for (std::size_t s = 0; s < looks.size(); ++s) {
    const PlaceFigures& figure = looks[s].figures();
    if (looks[s].showsAnotherSide()) places.thin.push_back(looked_at[s]);
    places.share += figure.thin ? share : 0;
    places.flat += figure.flat ? share : 0;
    places.facing += figure.facing ? share : 0;
    places.near += figure.near ? share : 0;
    spacings.push_back(figure.spacing);
    if (figure.variance >= 0) variances.push_back(figure.variance);
  }
  if (!spacings.empty()) places.spacing = median(spacings);
  const double flat = share * static_cast<double>(variances.size());
  if (!variances.empty() && flat >= kFlatPlaces) places.noise = std::sqrt(median(variances));
  return places;
}

}  // namespace

ThinPlaces findThinPlaces(const PointStore& store, const SideConstants& constants,
                          const NoiseConstants& noise, int threads) {
  const std::size_t asked = std::clamp(store.size() / kPointsPerPlace, kLeastPlaces, kMostPlaces);
  const std::size_t most = std::clamp(store.size() / noise.most_part, kPatch, kMostPatch);
  ThinnedPlaces points(store, asked);
  const std::vector<std::size_t> looked_at = points.places();
  std::vector<PlaceLook> looks(points.size(), PlaceLook(constants));
  std::vector<char> open(looks.size(), 1);
  std::vector<double> radii(looks.size(), 0.0);
  threads = resolveThreads(threads);
  for (std::size_t k = kPatch; k <= most; k *= kWider) {
    if (std::none_of(open.begin(), open.end(), [](char o) { return o != 0; })) break;
    const std::size_t stride = std::max<std::size_t>(1, k / kPatchPoints);
    points.thinTo(stride, threads);
    points.forEach(threads, [&](const PointStore& part, NeighborSearch& search, std::size_t place,
                                std::size_t s) {
      if (!open[s]) return;
      thread_local Patch patch;
      const double about = probableSquare(radii[s], static_cast<double>(kWider));
      patchAbout(part, search, place, k / stride, patch, about);
      radii[s] = patch.radius;
      open[s] = looks[s].look(patch);
      if (!part.hasSensors() || !(patch.radius > 0)) return;
      thread_local std::vector<std::uint32_t> neighbors;
      search.nearestSet(place, k / stride, neighbors, static_cast<float>(about));
      const BeamSides sides = sidesByBeams(part, neighbors, place, patch, constants);
      if (sides == BeamSides::kOne) looks[s].setOneSided();
      if (sides != BeamSides::kTwo) return;
      looks[s].setTwoSided();
      open[s] = 0;
    });
  }
  return summarize(looks, looked_at);
}

}  // namespace pcl_slim::detail
