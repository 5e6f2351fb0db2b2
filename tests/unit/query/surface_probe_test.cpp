// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_probe.h"

#include "unit/features/crest_fit.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::CrestFit;

TEST(SurfaceProbe, AgreesWithProjectionAtStoredPoints) {
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
    // A clean fit's own gates are narrower than a probe's, so that a leaf more may count here and
    // there.
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

TEST(SurfaceProbe, ManyPlacesAtOnceAreAsOneByOne) {
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

TEST(SurfaceProbe, FarPlacesAreUnsupported) {
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
  const auto& counts = fit.fit.surface.effective_count;
  const float most = *std::max_element(counts.begin(), counts.end());
  EXPECT_LE(scale.effective_count, most);
  // Points of less noise than the surface's count as more, but are no more.
  SLIMSurface noisy = fit.fit.surface;
  noisy.info.lambda = 1e-4;
  const ProbeIndex noisy_index(noisy);
  const ProbeScale own =
      SurfaceProbe(noisy_index).scaleAt(fit.fit.projection.position[5], {0, 0, 0});
  EXPECT_LE(own.effective_count, most);
  EXPECT_GT(own.equivalent_count, 1.1 * own.effective_count);
}

/** Distances from places off a unit sphere's surface, in its own units. */
TEST(SurfaceProbe, DistancesAreThoseToTheSheet) {
  for (const bool normals : {true, false}) {
    auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kSphere, 5000, 0);
    if (!normals) cloud = cloud.withoutNormals();
    const auto fit = pcl_slim_test::fitted(cloud);
    const ProbeIndex index(fit.surface, ProbeUse::kExtraction);
    SurfaceProbe probe(index);
    probe.restart(0.02);
    const double scale = fit.surface.info.scale;
    std::size_t known = 0;
    for (std::size_t i = 0; i < fit.store.size(); i += 16) {
      Vector3 places[SurfaceProbe::kMost];
      SheetDistance found[SurfaceProbe::kMost];
      const std::size_t count = std::min(SurfaceProbe::kMost, fit.store.size() - i);
      for (std::size_t k = 0; k < count; ++k) {
        const Vector3 p = fit.store.position(i + k);
        const double off = 0.004 * (static_cast<double>(k) - 7.5);
        places[k] = along(p, off / scale, normalized(fit.world(p)));
      }
      probe.distances(places, count, found);
      for (std::size_t k = 0; k < count; ++k) {
        if (!found[k].known) continue;
        ++known;
        const double off = 0.004 * (static_cast<double>(k) - 7.5);
        EXPECT_NEAR(scale * std::abs(found[k].distance), std::abs(off), 2e-4);
        const Vector3 outward = normalized(fit.world(places[k]));
        const double facing =
            dot(outward, {found[k].normal[0], found[k].normal[1], found[k].normal[2]});
        EXPECT_GT(std::abs(facing), 0.999);
        EXPECT_EQ(found[k].distance * facing > 0, off > 0);
        EXPECT_TRUE(facing > 0 || !normals);
      }
    }
    EXPECT_EQ(known, fit.store.size());
    const Vector3 middle = {0, 0, 0};
    SheetDistance none;
    probe.distances(&middle, 1, &none);
    EXPECT_FALSE(none.known);
  }
}

TEST(SurfaceProbe, TellsWhereTheDataEnd) {
  const auto fit =
      pcl_slim_test::fitted(pcl_slim_test::sceneCloud(measure::Shape::kRelief, 5000, 0));
  ASSERT_TRUE(fit.surface.hasTrimMaps());
  const ProbeIndex index(fit.surface, ProbeUse::kExtraction);
  SurfaceProbe probe(index);
  probe.restart(0.02);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    const Vector3 p = fit.store.position(i);
    ProbeRequest request;
    request.positions = &p;
    request.count = 1;
    ProbeSample sample;
    probe.evaluate(request, &sample);
    if (sample.supported && sample.outside <= 0.5) ++inside;
  }
  EXPECT_GT(inside, fit.store.size() * 98 / 100) << "points are inside";
}

TEST(SurfaceProbe, EachPlaceCanHaveASide) {
  const CrestFit fit("sphere", 3000, 0);
  const ProbeIndex index(fit.fit.surface);
  SurfaceProbe probe(index);
  probe.restart(0.02);
  const Vector3 places[2] = {fit.fit.store.position(10), fit.fit.store.position(10)};
  const auto& n = fit.fit.projection.normal[10];
  const Vector3 sides[2] = {{n[0], n[1], n[2]}, {-n[0], -n[1], -n[2]}};
  ProbeRequest request;
  request.positions = places;
  request.sides = sides;
  request.count = 2;
  ProbeSample samples[2];
  probe.evaluate(request, samples);
  EXPECT_TRUE(samples[0].supported);
  EXPECT_FALSE(samples[1].supported);
}

}  // namespace
