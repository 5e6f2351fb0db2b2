// SPDX-License-Identifier: BSD-3-Clause
// Figures of deviations by area, and verdicts of components.
#include "pcl_slim/compare/deviation_summary.h"

#include <gtest/gtest.h>

#include <numeric>

#include "unit/compare/compare_meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

Deviations deviationsOf(const std::vector<float>& distance, float detection) {
  Deviations d;
  d.distance = distance;
  d.sigma_reference.assign(distance.size(), 0);
  d.detection.assign(distance.size(), detection);
  d.state.assign(distance.size(), FootState::kFound);
  return d;
}

DeviationSummary summary(const Deviations& d, const DeviationCarrier& carrier,
                         const DeviationSummaryParams& params = {}) {
  Result<DeviationSummary> made = summarizeDeviations(d, carrier, params);
  EXPECT_TRUE(made) << made.error().message;
  return *made;
}

TEST(DeviationSummary, CarriersShareTheAreaOfAMesh) {
  TriangleMesh mesh = boxMesh(3, {1, 2, 3});
  append(boxMesh(2, {1, 1, 1}, {9, 0, 0}), mesh);
  mesh.vertices.push_back({0, 0, 50});
  for (const TriangleMesh& m : {mesh, soupOf(mesh)}) {
    const Result<DeviationCarrier> carrier = carrierOf(m);
    ASSERT_TRUE(carrier);
    // The soup has no vertex without a triangle.
    EXPECT_EQ(carrier->num_components, m.vertices.size() == mesh.vertices.size() ? 3u : 2u);
    std::vector<double> area(carrier->num_components, 0.0);
    for (std::size_t v = 0; v < m.vertices.size(); ++v) {
      area[carrier->component[v]] += carrier->area[v];
    }
    EXPECT_NEAR(area[0], 88, 1e-12);
    EXPECT_NEAR(area[1], 24, 1e-12);
  }
}

TEST(DeviationSummary, FiguresAreWeightedByArea) {
  DeviationCarrier carrier = evenCarrier(4, 0);
  carrier.area = {1, 2, 3, 4};
  Deviations d = deviationsOf({2, -1, 0.5f, 100}, 0.75f);
  d.state[3] = FootState::kBorder;
  const DeviationFigures f = summary(d, carrier).total;
  EXPECT_EQ(f.all.places, 4u);
  EXPECT_EQ(f.no_counterpart.area, 4);
  EXPECT_DOUBLE_EQ(f.mean, 1.5 / 6);
  EXPECT_DOUBLE_EQ(f.rms, std::sqrt((4 + 2 + 0.75) / 6));
  EXPECT_NEAR(f.deviation, std::sqrt(6.75 / 6 - 0.0625), 1e-12);
  EXPECT_EQ(f.absolute_95, 2);
  EXPECT_EQ(f.least, -1);
  EXPECT_EQ(f.greatest, 2);
  EXPECT_EQ(f.quantiles[3], 0.5);  // half of the area is at or below
  EXPECT_DOUBLE_EQ(f.volume_up, 3.5);
  EXPECT_DOUBLE_EQ(f.volume_down, 2);
  EXPECT_DOUBLE_EQ(f.netVolume(), 1.5);
  EXPECT_EQ(f.significant_up.area, 1);
  EXPECT_EQ(f.significant_down.area, 2);
  EXPECT_EQ(f.significant_volume_up, 2);
  EXPECT_EQ(f.significant_volume_down, 2);
}

TEST(DeviationSummary, HistogramsHaveAllMeasuredArea) {
  const std::size_t n = 1000;
  std::vector<float> distance(n);
  for (std::size_t i = 0; i < n; ++i) distance[i] = static_cast<float>(i) / 500 - 1;
  DeviationSummaryParams params;
  params.bins = 10;
  params.histogram_range = 0.5;
  const DeviationSummary s = summary(deviationsOf(distance, 0.25f), evenCarrier(n, 10), params);
  ASSERT_EQ(s.histogram.size(), 10u);
  EXPECT_NEAR(std::accumulate(s.histogram.begin(), s.histogram.end(), 0.0), 10, 1e-9);
  EXPECT_NEAR(s.histogram[4], 0.5, 0.02);          // a tenth of the range: a twentieth of the area
  EXPECT_NEAR(s.histogram[0], 2.75 + 0.25, 0.03);  // and what is beyond
  EXPECT_EQ(s.histogram_significant[4], 0);
  EXPECT_EQ(s.histogram_significant[0], s.histogram[0]);
}

TEST(DeviationSummary, ComponentsFailByWhatIsSurelyOutside) {
  DeviationCarrier carrier = evenCarrier(6, 6);
  carrier.component = {0, 0, 1, 1, 2, 2};
  carrier.num_components = 3;
  DeviationSummaryParams params;
  params.has_tolerance = true;
  params.tolerance_low = -1;
  params.tolerance_high = 2;
  // With a level of detection of .5, 2.4 may be within 2 and 2.6 is not.
  const DeviationSummary s =
      summary(deviationsOf({0, 2.4f, 0, 2.6f, -1.6f, 0}, 0.5f), carrier, params);
  EXPECT_TRUE(s.components[0].passes);
  EXPECT_EQ(s.components[0].in_doubt.places, 1u);
  EXPECT_FALSE(s.components[1].passes);
  EXPECT_EQ(s.components[1].above.places, 1u);
  EXPECT_FALSE(s.components[2].passes);
  EXPECT_EQ(s.components[2].below.area, 1);
  EXPECT_FALSE(s.passes);
  EXPECT_TRUE(summary(deviationsOf({0, 9, 0, 9, 9, 0}, 0.5f), carrier).passes);
}

TEST(DeviationSummary, NothingHasNoFigures) {
  const DeviationSummary s = summary({}, evenCarrier(0, 0));
  EXPECT_TRUE(std::isnan(s.total.mean));
  EXPECT_TRUE(std::isnan(s.total.absolute_95));
  EXPECT_TRUE(s.passes);
  EXPECT_EQ(s.histogram.size(), 64u);
}

TEST(DeviationSummary, NamesWhatIsWrong) {
  DeviationSummaryParams params;
  params.has_tolerance = true;
  params.tolerance_low = params.tolerance_high = 1;
  EXPECT_EQ(summarizeDeviations({}, evenCarrier(0, 0), params).error().code,
            ErrorCode::kBadArgument);
  EXPECT_EQ(summarizeDeviations({}, evenCarrier(3, 1), {}).error().code, ErrorCode::kBadInput);
}

}  // namespace
