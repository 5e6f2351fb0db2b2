// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** \brief Where deviations were measured, and how much area each place is responsible for. */
struct DeviationCarrier {
  std::vector<double> area;              ///< one a place, world units squared
  std::vector<std::uint32_t> component;  ///< one a place, counted from 0 in order of first places
  std::uint32_t num_components = 0;
};

/** \brief The carrier that a mesh's vertices are: each has a third of the area of its triangles.
 * Components are connected by vertices; vertices of equal coordinates count as one. Vertices without
 * a triangle have no area. O(T log T). \return an error for an invalid mesh. */
PCL_SLIM_EXPORT Result<DeviationCarrier> carrierOf(const TriangleMesh& mesh);

/** \brief The carrier that evenly spread places are: each has the same share of an area, and all are
 * one component. */
PCL_SLIM_EXPORT DeviationCarrier evenCarrier(std::size_t places, double area);

/** \brief How deviations are summed up. */
struct PCL_SLIM_EXPORT DeviationSummaryParams {
  bool has_tolerance = false;
  double tolerance_low = 0, tolerance_high = 0;  ///< allowed distances, low < high
  std::size_t bins = 64;                         ///< of the histogram, 2 to 65536
  double histogram_range = 0;  ///< bins cover +-this; 0: the 99.5 % quantile of |distance|

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief Number and area of places. */
struct PlaceShare {
  std::uint64_t places = 0;
  double area = 0;
};

/** \brief Deviations of a component, or of all places; weighted by area. Places without counterpart
 * count in no figure but `all` and `no_counterpart`; figures of nothing are NaN. */
struct DeviationFigures {
  PlaceShare all, measured, no_counterpart, significant_up, significant_down;
  double mean = 0, rms = 0, deviation = 0;  ///< standard deviation about the mean
  double absolute_95 = 0;                   ///< 95 % quantile of |distance|
  double least = 0, greatest = 0;
  std::array<double, 7> quantiles{};      ///< of distance, at DeviationSummary::kQuantiles
  double detection = 0;                   ///< median level of detection
  double volume_up = 0, volume_down = 0;  ///< of all measured places; both are at least 0
  double significant_volume_up = 0, significant_volume_down = 0;  ///< of the significant ones
  double netVolume() const { return volume_up - volume_down; }
};

/** \brief Whether a component is within its tolerance. */
struct ComponentVerdict {
  DeviationFigures figures;
  PlaceShare above, below;  ///< beyond the tolerance by more than the level of detection
  PlaceShare in_doubt;      ///< beyond it, or within it, by less
  bool passes = true;       ///< no place is above or below; true without a tolerance
};

/** \brief The table of a comparison. */
struct DeviationSummary {
  static constexpr std::array<double, 7> kQuantiles = {0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975};

  DeviationFigures total;
  std::vector<ComponentVerdict> components;  ///< by DeviationCarrier::component
  bool passes = true;                        ///< all components do
  double histogram_low = 0, histogram_high = 0;
  std::vector<double> histogram;  ///< area in each bin; the outer bins have what is beyond them
  std::vector<double> histogram_significant;  ///< of it, significant
};

/** \brief Sums deviations up. Volumes are sums of area times distance: those between the reference
 * and the places where the surface is not strongly curved on the scale of the distance.
 *
 * A place fails where distance - detection > tolerance_high or distance + detection <
 * tolerance_low; it is in doubt where the interval of +- detection contains a limit.
 * \return an error for columns of different lengths or bad parameters. O(N log N); same for any
 * number of threads. */
PCL_SLIM_EXPORT Result<DeviationSummary> summarizeDeviations(const Deviations& deviations,
                                                             const DeviationCarrier& carrier,
                                                             const DeviationSummaryParams& params);

}  // namespace pcl_slim
