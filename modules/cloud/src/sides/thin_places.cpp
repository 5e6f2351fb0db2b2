// SPDX-License-Identifier: BSD-3-Clause
// Whether a cloud needs sides (docs/sides.md, "Sides before the cover", "Whether").
#include <algorithm>
#include <cmath>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kPointsPerPlace = 1000;  ///< there is one place for this many points
constexpr std::size_t kLeastPlaces = 64;       ///< least number of places
constexpr std::size_t kMostPlaces = 256;       ///< largest number of places
constexpr std::size_t kPatch = 48;         ///< number of points of the smallest patch of a place
constexpr std::size_t kPatchFactor = 4;    ///< factor of this number to the next patch
constexpr std::size_t kPatchPoints = 384;  ///< most points used of a patch, evenly strided
/// Number of points of the widest patch. Wider ones would cost more than the fit.
constexpr std::size_t kMostPatch = 12288;

/** Two sheets in a patch. */
struct SheetGap {
  double gap = 0;        ///< distance of their means; 0: there is one sheet
  double within_sq = 0;  ///< variance about the means
};

/** Separates a patch into two sheets by two-means on heights along its normal. */
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
                   gap * gap > constants.sheet_distance * constants.sheet_distance * within;
  return two ? SheetGap{gap, within} : SheetGap{};
}

/** Whether a patch is a rod: long, and about as wide as thick. */
bool formsRod(const Eigen::Vector3d& spreads, const SideConstants& constants) {
  return spreads[1] < constants.rod * spreads[2] && spreads[0] > constants.round_rod * spreads[1];
}

/** Excess kurtosis of residuals: 0 for Gaussian noise, and -2 a^4 / (a^2 + s^2)^2 for two equal
 * sheets at +- a under noise s. */
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

/** Figures of one place. */
struct PlaceFigures {
  double spacing = 0;    ///< spacing of the points of the smallest patch [local length]
  double variance = -1;  ///< residual variance of the cubic, or within two sheets; < 0: unknown
  bool thin = false;     ///< two sides that a fit would mix (docs/sides.md, "Whether")
  bool flat = false;     ///< thin, by the kurtosis of the residuals alone
  bool facing = false;   ///< two sides that a fit separates by itself
};

/// Largest RMS residual of a cubic that fits [radius of the patch].
constexpr double kMostResidual = 0.15;
/// Scatter of the kurtosis by chance [standard deviations].
constexpr double kKurtosisDeviations = 1.5;
/// Distance of two sheets from which a fit separates them [standard deviation within the sheets].
constexpr double kSeparateDistance = 10.0;
/// Number of patches, wider than one that fits, in which another side is sought.
constexpr int kPatchesBeyond = 2;

/** Examines wider and wider patches of one place until one fits. */
class PlaceTest {
 public:
  explicit PlaceTest(const SideConstants& constants) : constants_(&constants) {}

  /** \return whether a wider patch must be examined */
  bool examine(const Patch& patch) {
    if (!(patch.radius > 0)) return false;
    if (!(figures_.spacing > 0))
      figures_.spacing = patch.radius * std::sqrt(M_PI / static_cast<double>(kPatch));
    if (fits_) return examineBeyond(patch);
    if (showsTwoSides(patch, figures_)) return false;
    thread_local PatchCubic cubic;
    fits_ = fitCubic(patch, cubic) && std::sqrt(cubic.variance) <= kMostResidual * patch.radius;
    figures_.thin = !fits_;
    if (fits_) figures_.variance = cubic.variance;
    return !(fits_ && recognizeSheets(cubic));
  }

  const PlaceFigures& figures() const { return figures_; }
  bool showsAnotherSide() const { return figures_.thin || figures_.facing; }
  /** Overrides the patches: the place has one side. */
  void setOneSided() { figures_.thin = figures_.flat = figures_.facing = false; }
  /** Overrides the patches: the place has two sides. */
  void setTwoSided() {
    if (showsAnotherSide()) return;
    figures_.thin = true;
    figures_.variance = -1;
  }

 private:
  /** Recognises two sheets that look like one rough sheet: the distribution of the residuals is
   * flatter than a Gaussian one by more than chance. \return whether there are two */
  bool recognizeSheets(const PatchCubic& cubic) {
    const double deviation = std::sqrt(24 / static_cast<double>(cubic.places.size()));
    const double excess = excessOf(cubic);
    if (excess > -constants_->two_sheet_kurtosis - kKurtosisDeviations * deviation) return false;
    figures_.thin = figures_.flat = true;
    figures_.variance *= 1 - std::sqrt(std::min(1.0, -0.5 * excess));
    return true;
  }

  /** Whether a patch is a rod or two sheets. Sheets are thin unless a fit separates them. */
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
    // Top and slopes of a bump are one bent sheet.
    thread_local PatchCubic cubic;
    if (fitCubic(patch, cubic) && cubic.variance < sheets.within_sq) return false;
    const double clean_sq = kSeparateDistance * kSeparateDistance * sheets.within_sq;
    figures.thin = sheets.gap * sheets.gap < clean_sq;
    figures.facing = !figures.thin;
    return true;
  }

  /** Seeks another side in a patch wider than one that fits. \return whether a wider one must be
   * examined */
  bool examineBeyond(const Patch& patch) {
    PlaceFigures beyond = figures_;
    if (showsTwoSides(patch, beyond)) {
      figures_.facing = beyond.thin || beyond.facing;
      return false;
    }
    return ++patches_beyond_ < kPatchesBeyond;
  }

  const SideConstants* constants_;
  PlaceFigures figures_;
  bool fits_ = false;
  int patches_beyond_ = 0;  ///< number of patches examined after one that fits
};

/// Least cosine between the beams of a place with one side.
constexpr double kOneSidedCosine = 0.5;

/** Sides of a place by the beams of its points. */
enum class BeamSides { kUnknown, kOne, kTwo };

/** One side if all neighbours were seen from about the direction of the sample's beam. Two sides if
 * a share of them was clearly seen from either side of the patch. */
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
    alike = alike && dot(own, other) > kOneSidedCosine;
  }
  if (alike) return BeamSides::kOne;
  const double least = constants.least_side * static_cast<double>(neighbors.size());
  return std::min(above, below) > least ? BeamSides::kTwo : BeamSides::kUnknown;
}

ThinPlaces summarize(const std::vector<PlaceTest>& tests, const std::vector<std::size_t>& sampled) {
  ThinPlaces places;
  const double share = 1 / static_cast<double>(std::max<std::size_t>(tests.size(), 1));
  std::vector<double> spacings, variances;
  for (std::size_t s = 0; s < tests.size(); ++s) {
    const PlaceFigures& figure = tests[s].figures();
    if (tests[s].showsAnotherSide()) places.thin.push_back(sampled[s]);
    places.share += figure.thin ? share : 0;
    places.flat += figure.flat ? share : 0;
    places.facing += figure.facing ? share : 0;
    spacings.push_back(figure.spacing);
    if (figure.variance >= 0) variances.push_back(figure.variance);
  }
  if (!spacings.empty()) places.spacing = median(spacings);
  if (!variances.empty()) places.noise = std::sqrt(median(variances));
  return places;
}

}  // namespace

ThinPlaces findThinPlaces(const PointStore& store, const SideConstants& constants,
                          const NoiseConstants& noise, int threads) {
  const std::size_t count = std::clamp(store.size() / kPointsPerPlace, kLeastPlaces, kMostPlaces);
  const std::size_t most = std::clamp(store.size() / noise.most_part, kPatch, kMostPatch);
  ThinnedPlaces points(store, count);
  const std::vector<std::size_t> sampled = points.places();
  std::vector<PlaceTest> tests(points.size(), PlaceTest(constants));
  std::vector<char> open(tests.size(), 1);
  std::vector<double> radii(tests.size(), 0.0);
  threads = resolveThreads(threads);
  for (std::size_t k = kPatch; k <= most; k *= kPatchFactor) {
    if (std::none_of(open.begin(), open.end(), [](char o) { return o != 0; })) break;
    const std::size_t stride = std::max<std::size_t>(1, k / kPatchPoints);
    points.thinTo(stride, threads);
    points.forEach(threads, [&](const PointStore& part, NeighborSearch& search, std::size_t place,
                                std::size_t s) {
      if (!open[s]) return;
      thread_local Patch patch;
      const double about = probableSquare(radii[s], static_cast<double>(kPatchFactor));
      patchAbout(part, search, place, k / stride, patch, about);
      radii[s] = patch.radius;
      open[s] = tests[s].examine(patch);
      if (!part.hasSensors() || !(patch.radius > 0)) return;
      thread_local std::vector<std::uint32_t> neighbors;
      search.nearestSet(place, k / stride, neighbors, static_cast<float>(about));
      const BeamSides sides = sidesByBeams(part, neighbors, place, patch, constants);
      if (sides == BeamSides::kOne) tests[s].setOneSided();
      if (sides != BeamSides::kTwo) return;
      tests[s].setTwoSided();
      open[s] = 0;
    });
  }
  return summarize(tests, sampled);
}

}  // namespace pcl_slim::detail
