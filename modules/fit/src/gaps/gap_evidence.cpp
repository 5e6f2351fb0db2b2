// SPDX-License-Identifier: BSD-3-Clause
#include "gaps/gap_evidence.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kWider = 1.15;       ///< steps of the discs' diameters
constexpr double kMostDiscs = 400.0;  ///< looked at of one diameter, about
constexpr float kFlat[3] = {0.0f, 0.0f, 0.0f};

/** The y at which points leave 2 (1 + y) exp(-y) discs each, so many in all. */
double
areaOfRarestDisc(double discs, double points)
{
  double y = 1.0;
  for (int step = 0; step < 50; ++step) y = std::log(2.0 * points * (1.0 + y) / discs);
  return y;
}

}  // namespace

GapEvidence::GapEvidence(const TrimConstants& constants, std::size_t points)
    : constants_(constants),
      rarest_(areaOfRarestDisc(constants.false_gaps, std::max(10.0, static_cast<double>(points)))),
      chance_(2.0 * std::sqrt(rarest_ / kPi))
{
}

bool
GapEvidence::findGaps(const SheetPoints& points, const SheetHeight& sheet, const KnownRegion& known,
                      double spacing, double hole, bool with_folds)
{
  spacing_ = spacing;
  hole_ = hole;
  near_.mark(points, known, constants_.known, constants_.evidence_cell * hole);
  if (!with_folds) near_.hideFolds(sheet, constants_.steepest);
  return near_.findGaps(hole);
}

/** Marks the cells of discs of one diameter that are too empty for chance. */
void
GapEvidence::findUnlikely(double diameter)
{
  const double reach = constants_.core + 0.5 * diameter;
  const auto stride =
      static_cast<int>(std::ceil(std::sqrt(static_cast<double>(wide_.numCenters()) / kMostDiscs)));
  const double by_leaf = 0.25 * kPi * diameter * diameter / (spacing_ * spacing_);
  const bool surely = by_leaf >= constants_.unevenness * rarest_;
  middles_.reset(wide_.side());
  bool any = false;
  for (int y = stride / 2; y < wide_.side(); y += stride) {
    for (int x = stride / 2; x < wide_.side(); x += stride) {
      if (!wide_.isCenter(x, y) || real_.test(x, y)) continue;
      const double u = wide_.middle(x), v = wide_.middle(y);
      if (u * u + v * v > reach * reach) continue;
      if (!surely && wide_.numMissing(x, y, diameter) < rarest_) continue;
      middles_.set(x, y);
      any = true;
    }
  }
  if (any) wide_.addDiscs(middles_, diameter, real_);
}

/** Adds a place of each gap that reaches the leaf's core where a disc is too empty for chance.
 * \return whether no other gap is left there. */
bool
GapEvidence::addReal(std::vector<LeafGaps::Place>& real)
{
  bool all = true;
  for (const GapGrid::Run& run : near_.runs()) {
    std::uint8_t& done = done_[static_cast<std::size_t>(run.gap)];
    const double v = near_.middle(run.y);
    const int y = wide_.cellOf(v);
    for (int x = run.first; x <= run.last && !done; ++x) {
      const double u = near_.middle(x);
      if (u * u + v * v > constants_.core * constants_.core) continue;
      done = real_.test(wide_.cellOf(u), y);
      if (done) {
        real.push_back({static_cast<float>(u), static_cast<float>(v), 0});
      } else {
        all = false;
      }
    }
  }
  return all;
}

void
GapEvidence::findReal(const SheetPoints& seen, const SheetHeight& sheet,
                      std::vector<LeafGaps::Place>& real)
{
  const double radius = view(spacing_);
  const bool wider = radius > constants_.known;
  const SheetHeight seen_as = wider ? SheetHeight{1, kFlat} : sheet;
  wide_.mark(seen, KnownRegion(seen_as.degree, seen_as.c, radius), radius,
             constants_.gap_cell * hole_);
  if (!wider) wide_.hideFolds(sheet, constants_.steepest);
  real_.reset(wide_.side());
  done_.assign(static_cast<std::size_t>(near_.numGaps()), 0);
  real.clear();
  for (double diameter = std::max(hole_, chance_ * spacing_);
       wide_.findCenters(diameter) && !addReal(real); diameter *= kWider) {
    findUnlikely(diameter);
  }
  addReal(real);
}

}  // namespace pcl_slim::detail
