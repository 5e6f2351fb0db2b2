// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/deviation_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "triangles/welding.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/** Values with weights, ascending. */
class WeightedValues {
 public:
  void add(double value, double weight) { values_.emplace_back(value, weight); }
  bool empty() const { return values_.empty(); }
  void sort() { std::sort(values_.begin(), values_.end()); }

  /** The value below which a share of all weight is; where all weights are 0, of the count. */
  double quantile(double share) const {
    if (values_.empty()) return kUnknown;
    double total = 0;
    for (const auto& entry : values_) total += entry.second;
    const bool counted = !(total > 0);
    if (counted) total = static_cast<double>(values_.size());
    double sum = 0;
    for (const auto& [value, weight] : values_) {
      sum += counted ? 1 : weight;
      if (sum >= share * total) return value;
    }
    return values_.back().first;
  }

 private:
  std::vector<std::pair<double, double>> values_;
};

/** Sums of one component, or of all. */
struct Sums {
  DeviationFigures figures;
  double mean_sum = 0, square_sum = 0;
  WeightedValues distances, sizes, detections;

  static void count(PlaceShare& share, double area) {
    ++share.places;
    share.area += area;
  }
  void add(double distance, double detection, double area);
  DeviationFigures finished();
};

void Sums::add(double distance, double detection, double area) {
  DeviationFigures& f = figures;
  count(f.measured, area);
  mean_sum += area * distance;
  square_sum += area * distance * distance;
  f.least = f.measured.places == 1 ? distance : std::min(f.least, distance);
  f.greatest = f.measured.places == 1 ? distance : std::max(f.greatest, distance);
  distances.add(distance, area);
  sizes.add(std::abs(distance), area);
  detections.add(detection, area);
  const double volume = area * std::abs(distance);
  (distance > 0 ? f.volume_up : f.volume_down) += volume;
  if (!(std::abs(distance) > detection)) return;
  count(distance > 0 ? f.significant_up : f.significant_down, area);
  (distance > 0 ? f.significant_volume_up : f.significant_volume_down) += volume;
}

DeviationFigures Sums::finished() {
  DeviationFigures& f = figures;
  distances.sort();
  sizes.sort();
  detections.sort();
  const double area = f.measured.area;
  f.mean = area > 0 ? mean_sum / area : kUnknown;
  f.rms = area > 0 ? std::sqrt(square_sum / area) : kUnknown;
  f.deviation = area > 0 ? std::sqrt(std::max(0.0, square_sum / area - f.mean * f.mean)) : kUnknown;
  f.absolute_95 = sizes.quantile(0.95);
  f.detection = detections.quantile(0.5);
  for (std::size_t k = 0; k < f.quantiles.size(); ++k) {
    f.quantiles[k] = distances.quantile(DeviationSummary::kQuantiles[k]);
  }
  if (distances.empty()) f.least = f.greatest = kUnknown;
  return f;
}

/** Counts a place against the tolerance. */
void judge(double distance, double detection, double area, const DeviationSummaryParams& params,
           ComponentVerdict& verdict) {
  const double low = params.tolerance_low, high = params.tolerance_high;
  if (distance - detection > high) {
    Sums::count(verdict.above, area);
  } else if (distance + detection < low) {
    Sums::count(verdict.below, area);
  } else if (distance + detection > high || distance - detection < low) {
    Sums::count(verdict.in_doubt, area);
  }
}

Error checkColumns(const Deviations& deviations, const DeviationCarrier& carrier) {
  const std::size_t n = deviations.size();
  const bool whole = deviations.detection.size() == n && deviations.state.size() == n &&
                     carrier.area.size() == n && carrier.component.size() == n;
  if (!whole) {
    return badInput("there are " + std::to_string(n) + " deviations and another number of areas, " +
                    "components or states: give each place one of each");
  }
  for (const std::uint32_t c : carrier.component) {
    if (c < carrier.num_components) continue;
    return badInput("a place is of component " + std::to_string(c) + " of " +
                    std::to_string(carrier.num_components) + ": correct it");
  }
  return {};
}

void fillHistogram(const Deviations& deviations, const DeviationCarrier& carrier,
                   const DeviationSummaryParams& params, const WeightedValues& sizes,
                   DeviationSummary& made) {
  double range = params.histogram_range;
  if (!(range > 0)) range = sizes.empty() ? 1 : sizes.quantile(0.995);
  if (!(range > 0)) range = 1;  // all distances are 0
  made.histogram_low = -range;
  made.histogram_high = range;
  made.histogram.assign(params.bins, 0);
  made.histogram_significant.assign(params.bins, 0);
  const auto bins = static_cast<double>(params.bins);
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    if (deviations.state[i] != FootState::kFound) continue;
    const double at = (deviations.distance[i] + range) / (2 * range) * bins;
    const auto bin = static_cast<std::size_t>(std::min(std::max(at, 0.0), bins - 1));
    made.histogram[bin] += carrier.area[i];
    if (deviations.classOf(i) == DeviationClass::kSignificant) {
      made.histogram_significant[bin] += carrier.area[i];
    }
  }
}

}  // namespace

Error DeviationSummaryParams::validate() const {
  if (has_tolerance && !(tolerance_low < tolerance_high)) {
    return {ErrorCode::kBadArgument,
            "the tolerance's lower limit is not below its upper one: give LOW,HIGH in this order"};
  }
  if (bins < 2 || bins > 65536) {
    return {ErrorCode::kBadArgument, "a histogram has 2 to 65536 bins: set a number of these"};
  }
  if (!(histogram_range >= 0) || !std::isfinite(histogram_range)) {
    return {ErrorCode::kBadArgument,
            "the histogram's range is negative or not finite: set a length, or 0"};
  }
  return {};
}

Result<DeviationCarrier> carrierOf(const TriangleMesh& mesh) {
  if (Error error = checkCorners(mesh)) return error;
  constexpr std::uint32_t kNone = 0xffffffffu;
  const WeldedTriangles welded = weld(mesh);
  std::size_t count = 0;
  const auto of_triangle = componentsOf(welded.triangles, welded.num_vertices, count);
  std::vector<std::uint32_t> of_vertex(welded.num_vertices, kNone);
  for (std::size_t t = 0; t < welded.triangles.size(); ++t) {
    for (const std::uint32_t v : welded.triangles[t]) of_vertex[v] = of_triangle[t];
  }
  DeviationCarrier carrier;
  const std::size_t n = mesh.vertices.size();
  carrier.area.assign(n, 0);
  carrier.component.resize(n);
  for (const std::uint32_t t : welded.original) {
    const auto& c = mesh.triangles[t];
    const Vector3 a = subtract(mesh.vertices[c[1]], mesh.vertices[c[0]]);
    const Vector3 b = subtract(mesh.vertices[c[2]], mesh.vertices[c[0]]);
    const double third = length(cross(a, b)) / 6;
    for (const std::uint32_t v : c) carrier.area[v] += third;
  }
  // Numbers in order of first vertices; lone vertices are components without area.
  std::vector<std::uint32_t> number(count, kNone);
  for (std::size_t v = 0; v < n; ++v) {
    std::uint32_t& own = of_vertex[welded.vertex[v]];
    if (own == kNone) {
      carrier.component[v] = carrier.num_components++;
      continue;
    }
    if (number[own] == kNone) number[own] = carrier.num_components++;
    carrier.component[v] = number[own];
  }
  return carrier;
}

DeviationCarrier evenCarrier(std::size_t places, double area) {
  DeviationCarrier carrier;
  carrier.area.assign(places, places > 0 ? area / static_cast<double>(places) : 0.0);
  carrier.component.assign(places, 0);
  carrier.num_components = places > 0 ? 1 : 0;
  return carrier;
}

Result<DeviationSummary> summarizeDeviations(const Deviations& deviations,
                                             const DeviationCarrier& carrier,
                                             const DeviationSummaryParams& params) {
  if (Error error = params.validate()) return error;
  if (Error error = checkColumns(deviations, carrier)) return error;
  DeviationSummary made;
  made.components.resize(carrier.num_components);
  std::vector<Sums> sums(carrier.num_components);
  Sums all;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const double area = carrier.area[i];
    ComponentVerdict& verdict = made.components[carrier.component[i]];
    Sums& own = sums[carrier.component[i]];
    for (Sums* s : {&all, &own}) Sums::count(s->figures.all, area);
    if (deviations.state[i] != FootState::kFound) {
      for (Sums* s : {&all, &own}) Sums::count(s->figures.no_counterpart, area);
      continue;
    }
    const double distance = deviations.distance[i], detection = deviations.detection[i];
    for (Sums* s : {&all, &own}) s->add(distance, detection, area);
    if (params.has_tolerance) judge(distance, detection, area, params, verdict);
  }
  made.total = all.finished();
  for (std::size_t c = 0; c < sums.size(); ++c) {
    ComponentVerdict& verdict = made.components[c];
    verdict.figures = sums[c].finished();
    verdict.passes = verdict.above.places == 0 && verdict.below.places == 0;
    made.passes = made.passes && verdict.passes;
  }
  fillHistogram(deviations, carrier, params, all.sizes, made);
  return made;
}

}  // namespace pcl_slim
