// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Sides before the cover": whether a cloud needs sides.
#include <algorithm>
#include <cmath>

#include "noise/patch_noise.h"
#include "noise/patch_scale.h"
#include "pcl_slim/cloud/detail/sides.h"

namespace pcl_slim::detail {

namespace {

/** Two sheets that lie over each other, and not side by side as the faces of an edge do. */
bool
overlap(const Eigen::Matrix3Xd& local, double middle)
{
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
SheetGap
gapOf(const Eigen::Matrix3Xd& local, const SideConstants& constants)
{
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
bool
formsRod(const Eigen::Vector3d& spreads, const SideConstants& constants)
{
  return spreads[1] < constants.rod * spreads[2] && spreads[0] > constants.thick_rod * spreads[1];
}

/** What one place shows. */
struct PlaceFigures {
  double spacing = 0;    ///< by its smallest patch
  double variance = -1;  ///< of a cubic's residuals, where it fits
  bool thin = false;     ///< no patch of one sheet alone fits
  bool facing = false;   ///< one does, and beyond it there is another sheet
};

/** Looks at patches of one place until one fits. */
class PlaceLook {
 public:
  PlaceLook(const PointStore& store, const SideConstants& constants, NeighborSearch& search)
      : store_(store), constants_(constants), search_(search)
  {
  }

  PlaceFigures look(std::size_t place, std::size_t most)
  {
    PlaceFigures figures;
    double last = 0;
    for (std::size_t k = constants_.patch; k <= most; k *= constants_.wider) {
      patchAbout(store_, search_, place, k, patch_);
      const Patch& patch = patch_;
      if (!(patch.radius > 0)) return figures;
      if (k == constants_.patch)
        figures.spacing = patch.radius * std::sqrt(M_PI / static_cast<double>(k));
      if (showsTwoSides(patch, figures)) return figures;
      thread_local PatchCubic cubic;
      figures.thin =
          !fitCubic(patch, cubic) || std::sqrt(cubic.variance) > constants_.filled * patch.radius;
      if (figures.thin) {
        // Relief of the surface itself grows with the patch; noise and the far side of a part do not.
        figures.thin = !(last > 0 && cubic.variance > constants_.relief * last);
        last = cubic.variance;
        continue;
      }
      figures.variance = cubic.variance;
      k *= constants_.wider;
      if (k > most) break;
      patchAbout(store_, search_, place, k, patch_);
      lookBeyond(patch_, figures);
      break;
    }
    return figures;
  }

 private:
  /** Whether a patch is a rod or two sheets. The latter are thin unless they part by themselves. */
  bool showsTwoSides(const Patch& patch, PlaceFigures& figures) const
  {
    const auto axes = principalAxes(patch.points);
    figures.thin = formsRod(axes.eigenvalues(), constants_);
    if (figures.thin) return true;
    Eigen::Matrix3Xd local(3, static_cast<Eigen::Index>(patch.points.size()));
    for (std::size_t i = 0; i < patch.points.size(); ++i)
      local.col(static_cast<Eigen::Index>(i)) = patch.points.at(i);
    local = axes.eigenvectors().transpose() * (local.colwise() - local.rowwise().mean()).eval();
    const SheetGap sheets = gapOf(local, constants_);
    if (!(sheets.gap > 0)) return false;
    const double clean_sq = constants_.clean * constants_.clean * sheets.within_sq;
    figures.thin = sheets.gap * sheets.gap < clean_sq;
    figures.facing = !figures.thin && sheets.gap > constants_.clear_gap * figures.spacing;
    return true;
  }

  /** Whether a patch wider than one that fits has another side. */
  void lookBeyond(const Patch& patch, PlaceFigures& figures) const
  {
    PlaceFigures beyond = figures;
    if (showsTwoSides(patch, beyond)) figures.facing = beyond.thin || beyond.facing;
  }

  const PointStore& store_;
  const SideConstants& constants_;
  NeighborSearch& search_;
  Patch patch_;
};

ThinPlaces
summarize(const std::vector<PlaceFigures>& figures, const SideConstants& constants)
{
  ThinPlaces places;
  const double share = 1 / static_cast<double>(std::max<std::size_t>(figures.size(), 1));
  std::vector<double> spacings, variances;
  for (const PlaceFigures& figure : figures) {
    places.share += figure.thin ? share : 0;
    places.facing += figure.facing ? share : 0;
    spacings.push_back(figure.spacing);
    if (!figure.thin && figure.variance >= 0) variances.push_back(figure.variance);
  }
  if (!spacings.empty()) places.spacing = median(spacings);
  const double flat = share * static_cast<double>(variances.size());
  if (!variances.empty() && flat >= constants.flat_places)
    places.noise = std::sqrt(median(variances));
  return places;
}

}  // namespace

ThinPlaces
findThinPlaces(const PointStore& store, const SideConstants& constants, const NoiseConstants& noise,
               int threads)
{
  const std::size_t asked = std::clamp(store.size() / constants.points_per_place,
                                       constants.least_places, constants.most_places);
  const std::size_t most =
      std::clamp(store.size() / noise.most_part, constants.patch, constants.most_patch);
  std::vector<PlaceFigures> figures(std::min(asked, store.size()));
  sampleStore(store, asked, 1, resolveThreads(threads),
              [&](NeighborSearch& search, std::size_t place, std::size_t s) {
                figures[s] = PlaceLook(store, constants, search).look(place, most);
                return 0.0;
              });
  return summarize(figures, constants);
}

}  // namespace pcl_slim::detail
