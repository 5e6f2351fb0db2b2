// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_probe.h"

#include "unit/features/crest_fit.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::CrestFit;

TEST(SurfaceProbe, AgreesWithProjectionAtStoredPoints)
{
  const CrestFit fit("bumpy", 5000, 0);
  const ProbeIndex index(fit.fit.surface);
  SurfaceProbe probe(index);
  probe.restart(0.01);
  for (std::size_t i = 0; i < fit.fit.store.size(); i += 37) {
    ASSERT_EQ(fit.fit.projection.supported[i], 1);
    const Vector3 p = fit.fit.store.position(i);
    const auto& n = fit.fit.projection.normal[i];
    ProbeRequest request;
    request.positions = &p;
    request.count = request.with_directions = 1;
    request.extremality = true;
    request.side = {n[0], n[1], n[2]};
    ProbeSample sample;
    probe.evaluate(request, &sample);
    ASSERT_TRUE(sample.supported);
    const PrincipalFrame& frame = fit.fit.projection.principal[i];
    // A clean fit's own gates are narrower than a probe's, so that a leaf more may count here and there.
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(sample.position[a], fit.fit.projection.position[i][a], 1e-6);
      EXPECT_NEAR(sample.normal[a], n[a], 1e-4);
    }
    EXPECT_NEAR(sample.frame.k1, frame.k1, 1e-2 * (1 + std::abs(frame.k1)));
    EXPECT_NEAR(sample.frame.k2, frame.k2, 1e-2 * (1 + std::abs(frame.k2)));
    EXPECT_NEAR(std::abs(sample.frame.extremality1), std::abs(frame.extremality1),
                0.1 * (1 + std::abs(frame.extremality1)));
  }
}

TEST(SurfaceProbe, ManyPlacesAtOnceAreAsOneByOne)
{
  const CrestFit fit("ellipsoid", 5000, 0);
  const ProbeIndex index(fit.fit.surface);
  SurfaceProbe probe(index);
  probe.restart(0.05);
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < SurfaceProbe::kMost; ++i) {
    places.push_back(fit.fit.store.position(100 + i));
  }
  ProbeRequest request;
  request.positions = places.data();
  request.count = places.size();
  std::vector<ProbeSample> together(places.size());
  probe.evaluate(request, together.data());
  for (std::size_t i = 0; i < places.size(); ++i) {
    ProbeRequest single;
    single.positions = &places[i];
    single.count = single.with_directions = 1;
    ProbeSample sample;
    probe.evaluate(single, &sample);
    ASSERT_TRUE(sample.supported && together[i].supported);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(sample.position[a], together[i].position[a], 1e-7);
    }
    EXPECT_NEAR(sample.frame.k1, together[i].frame.k1, 1e-4);
    EXPECT_NEAR(sample.frame.k2, together[i].frame.k2, 1e-4);
  }
}

TEST(SurfaceProbe, FarPlacesAreUnsupported)
{
  const CrestFit fit("sphere", 2000, 0);
  const ProbeIndex index(fit.fit.surface);
  SurfaceProbe probe(index);
  const Vector3 p = {0, 0, 0};
  ProbeRequest request;
  request.positions = &p;
  request.count = 1;
  ProbeSample sample;
  probe.evaluate(request, &sample);
  EXPECT_FALSE(sample.supported);
  EXPECT_EQ(probe.scaleAt(p, {0, 0, 1}).radius, 0);
  const ProbeScale scale = probe.scaleAt(fit.fit.projection.position[5], {0, 0, 0});
  EXPECT_GT(scale.radius, 0);
  EXPECT_GT(scale.effective_count, 10);
}

}  // namespace
