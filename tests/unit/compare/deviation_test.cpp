// SPDX-License-Identifier: BSD-3-Clause
// Distances from surfaces and meshes near and far, against exact bodies; what has no counterpart.
#include "pcl_slim/compare/deviation.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/clouds.h"
#include "support/sphere_surface.h"
#include "unit/compare/compare_meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** Points of a surface with its normals, as places. */
struct Places {
  std::vector<Vector3> positions;
  std::vector<std::array<float, 3>> normals;

  void add(const Vector3& p, const Vector3& n) {
    positions.push_back(p);
    normals.push_back(
        {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
  }
  DeviationPlaces view() const {
    DeviationPlaces made;
    made.positions = positions.data();
    made.count = positions.size();
    if (!normals.empty()) {
      made.normals = normals.data();
      made.oriented = true;
    }
    return made;
  }
  Cloud cloud() const {
    Cloud made;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto& n = normals[i];
      made.add(positions[i], {n[0], n[1], n[2]});
    }
    return made;
  }
};

/** Places of a plate's two faces, 2 wide, at these heights, in a grid. */
Places plate(double low, double high, int n = 60) {
  Places made;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = (2.0 * i + 1) / n - 1, y = (2.0 * j + 1) / n - 1;
      made.add({x, y, high}, {0, 0, 1});
      made.add({x, y, low}, {0, 0, -1});
    }
  }
  return made;
}

Deviations measured(const DeviationReference& reference, const DeviationPlaces& places,
                    const DeviationParams& params = {}) {
  Deviations made;
  const Error error = measureDeviations(reference, places, params, made);
  EXPECT_FALSE(error) << error.message;
  EXPECT_EQ(made.size(), places.count);
  return made;
}

std::size_t countOf(const Deviations& d, FootState state) {
  return static_cast<std::size_t>(std::count(d.state.begin(), d.state.end(), state));
}

/** Exact points of the unit sphere about a place. */
Cloud sphereCloud(std::size_t count, const Vector3& at) {
  Cloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double r = std::sqrt(1 - z * z), a = 2.399963229728653 * static_cast<double>(i);
    const Vector3 n = {r * std::cos(a), r * std::sin(a), z};
    cloud.add(along(at, 1, n), n);
  }
  return cloud;
}

TEST(Deviation, OfASphereAtAnyDistance) {
  const Vector3 at = {500, -20, 3};
  const Fitted fit = fitted(sphereCloud(8000, at));
  const DeviationReference reference = referenceTo(fit.surface);
  EXPECT_TRUE(reference.oriented());
  Places places;
  std::vector<double> truth;
  for (const double radius : {0.15, 0.6, 0.97, 1.0, 1.01, 1.3, 3.0, 40.0}) {
    for (const Vector3& d : randomPlaces(60, 1, 3)) {
      const Vector3 n = normalized(d);
      places.add(along(at, radius, n), n);
      truth.push_back(radius - 1);
    }
  }
  const DeviationPlaces view = places.view();
  const Deviations d = measured(reference, view);
  EXPECT_EQ(countOf(d, FootState::kFound), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    // The fit is within 1e-5 of the sphere; distances are stored as floats.
    EXPECT_NEAR(d.distance[i], truth[i], 2e-5 + 1e-6 * std::abs(truth[i])) << i;
    const Vector3 off = subtract(d.foot(view, i), at);
    EXPECT_NEAR(length(off), 1, 2e-5);
    // Feet converge to 1e-4 of a ball, and places near the centre magnify their angle.
    const auto& n = d.normal[i];
    const auto& own = places.normals[i];
    EXPECT_GT(n[0] * own[0] + n[1] * own[1] + n[2] * own[2], 0.99999f);
    EXPECT_GT(dot(normalized(off), {own[0], own[1], own[2]}), 0.99999);
  }
}

TEST(Deviation, OfATorusIsTheNearestOfAll) {
  const auto truth = [](const Vector3& p) {
    return measure::truthAt(measure::Shape::kTorus, p).distance;
  };
  const Fitted fit = fitted(sceneCloud(measure::Shape::kTorus, 20000, 0));
  const DeviationReference reference = referenceTo(fit.surface);
  const Bounds box = reference.bounds();
  Places places;
  places.positions = randomPlaces(1000, 0.5 * box.diagonal(), 5);
  const Deviations d = measured(reference, places.view());
  for (std::size_t i = 0; i < places.positions.size(); ++i) {
    ASSERT_EQ(d.state[i], FootState::kFound);
    EXPECT_NEAR(d.distance[i], truth(places.positions[i]), 1e-4 * box.diagonal());
  }
}

TEST(Deviation, OfAPatchEndsAtItsBorder) {
  Places square = plate(0, 0);
  Places top;
  for (std::size_t i = 0; i < square.positions.size(); i += 2) {
    top.add(square.positions[i], {0, 0, 1});
  }
  const Fitted fit = fitted(top.cloud());
  const DeviationReference reference = referenceTo(fit.surface);
  Places places;
  for (const double z : {-0.5, 0.01, 0.2, 2.0}) {
    for (const Vector3& p : randomPlaces(100, 2, 7)) {
      const double off = std::max(std::abs(p[0]), std::abs(p[1]));
      // The trim maps end the patch near its outermost points, 1/60 inside.
      if (std::abs(off - 1) > 0.1) places.add({p[0], p[1], z}, {0, 0, 1});
    }
  }
  const Deviations d = measured(reference, places.view());
  for (std::size_t i = 0; i < d.size(); ++i) {
    const Vector3& p = places.positions[i];
    const bool inside = std::max(std::abs(p[0]), std::abs(p[1])) < 1;
    EXPECT_EQ(d.state[i], inside ? FootState::kFound : FootState::kBorder)
        << p[0] << " " << p[1] << " " << p[2];
    if (inside) {
      EXPECT_NEAR(d.distance[i], p[2], 1e-5);
    }
    EXPECT_EQ(d.classOf(i) == DeviationClass::kNoCounterpart, !inside);
  }
}

TEST(Deviation, ThinPartsCompareWithTheirOwnSide) {
  // A plate .1 thick that moved by half of that: its lower face is between the two before.
  const double t = 0.1;
  const Places moved = plate(0, t);
  const Fitted fit = fitted(plate(-t / 2, t / 2).cloud());
  const DeviationReference references[] = {referenceTo(fit.surface),
                                           referenceTo(boxMesh(7, {1, 1, t / 2}))};
  for (const DeviationReference& reference : references) {
    ASSERT_TRUE(reference.oriented());
    const Deviations d = measured(reference, moved.view());
    std::size_t found = 0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (d.state[i] != FootState::kFound) continue;  // next to the borders
      ++found;
      const bool up = moved.normals[i][2] > 0;
      EXPECT_NEAR(d.distance[i], up ? t / 2 : -t / 2, 1e-4);
    }
    EXPECT_GT(found, d.size() * 9 / 10);
    // Without sides each place takes the nearest.
    DeviationParams nearest;
    nearest.feet.sides = false;
    const Deviations n = measured(reference, moved.view(), nearest);
    for (std::size_t i = 0; i < n.size(); ++i) {
      const Vector3& p = moved.positions[i];
      const bool at_rim = std::max(std::abs(p[0]), std::abs(p[1])) > 1 - t;
      if (n.state[i] != FootState::kFound || at_rim) continue;
      EXPECT_NEAR(std::abs(n.distance[i]), t / 2, 1e-4);
    }
  }
}

/** The inside of a room: a box whose normals point into it, as a scan from within sees it. */
Places room(const Vector3& half, double step) {
  Places made;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      for (double u = -half[b] + step / 2; u < half[b]; u += step) {
        for (double v = -half[c] + step / 2; v < half[c]; v += step) {
          Vector3 p{}, n{};
          p[a] = side * half[a];
          p[b] = u;
          p[c] = v;
          n[a] = -side;
          made.add(p, n);
        }
      }
    }
  }
  return made;
}

TEST(Deviation, NothingIsMatchedThroughAWall) {
  const Vector3 half = {2, 1.5, 1};
  TriangleMesh inner = boxMesh(6, half);
  for (auto& triangle : inner.triangles) std::swap(triangle[1], triangle[2]);
  const Fitted fit = fitted(room(half, 0.06).cloud());
  const DeviationReference references[] = {referenceTo(fit.surface), referenceTo(inner)};
  // The outer faces of the same walls, .2 away: they face as the opposite walls of the room do.
  Places outer = room({2.2, 1.7, 1.2}, 0.2);
  for (auto& n : outer.normals) {
    for (float& x : n) x = -x;
  }
  for (const DeviationReference& reference : references) {
    ASSERT_TRUE(reference.oriented());
    const Deviations d = measured(reference, outer.view());
    EXPECT_EQ(countOf(d, FootState::kFound), 0u);
    DeviationParams near;
    near.feet.max_distance = 0.5;
    const Deviations bounded = measured(reference, outer.view(), near);
    EXPECT_EQ(countOf(bounded, FootState::kFound), 0u);
    EXPECT_GT(countOf(bounded, FootState::kFacesAway), outer.positions.size() * 8 / 10);
    // The room's own walls, moved inwards, have counterparts.
    const Deviations own = measured(reference, room({1.9, 1.4, 0.9}, 0.2).view());
    EXPECT_GT(countOf(own, FootState::kFound), own.size() * 95 / 100);
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (own.state[i] != FootState::kFound) continue;
      EXPECT_NEAR(own.distance[i], 0.1, 2e-2);
    }
  }
}

TEST(Deviation, PlacesBesideSharpEdgesKeepSmallDistances) {
  // Noise moves points of the top past the edge, where the side is nearer but faces away.
  const Vector3 half = {1, 1, 1};
  const DeviationReference reference = referenceTo(boxMesh(2, half));
  Places places;
  for (const double out : {0.001, 0.01}) {
    for (const double z : {-0.01, -0.001, 0.001, 0.01}) {
      for (const double y : {-0.5, 0.1, 0.7}) places.add({1 + out, y, 1 + z}, {0, 0, 1});
    }
  }
  const Deviations d = measured(reference, places.view());
  for (std::size_t i = 0; i < d.size(); ++i) {
    ASSERT_EQ(d.state[i], FootState::kFound);
    const Vector3& p = places.positions[i];
    EXPECT_NEAR(d.distance[i], std::hypot(p[0] - 1, p[2] - 1), 1e-7);
  }
}

TEST(Deviation, SaysWhyThereIsNoCounterpart) {
  const DeviationReference reference = referenceTo(boxMesh(1, {1, 1, 1}));
  Places places;
  places.add({0, 0, 3}, {0, 0, 1});
  places.add({0, std::numeric_limits<double>::quiet_NaN(), 0}, {0, 0, 1});
  places.add({0, 0, 1.2}, {0, 0, 1});
  DeviationParams params;
  params.feet.max_distance = 1.5;
  const Deviations d = measured(reference, places.view(), params);
  EXPECT_EQ(d.state[0], FootState::kTooFar);
  EXPECT_EQ(d.state[1], FootState::kNotFinite);
  EXPECT_EQ(d.state[2], FootState::kFound);
  EXPECT_TRUE(std::isnan(d.distance[0]));
  EXPECT_EQ(d.classOf(1), DeviationClass::kNoCounterpart);
}

TEST(Deviation, LevelsOfDetectionCombineBothErrors) {
  EXPECT_DOUBLE_EQ(levelOfDetection(3, 4, 1), 1.96 * 6);
  TriangleMesh square;
  square.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Result<DeviationReference> reference =
      DeviationReference::make(square, {0.04f, 0, 0.04f, 0.04f}, 1);
  ASSERT_TRUE(reference);
  Places places;
  places.add({0.75, 0.25, 0.12}, {0, 0, 1});  // half way between vertices 1 and the diagonal
  places.add({0.75, 0.25, 0.02}, {0, 0, 1});
  std::vector<float> sigma = {0.03f, -1};
  DeviationPlaces view = places.view();
  view.sigma = sigma.data();
  DeviationParams params;
  params.registration_error = 0.01;
  const Deviations d = measured(*reference, view, params);
  EXPECT_NEAR(d.sigma_reference[0], 0.02, 1e-8);
  EXPECT_NEAR(d.detection[0], levelOfDetection(0.03, 0.02, 0.01), 1e-7);
  EXPECT_NEAR(d.detection[1], levelOfDetection(0, 0.02, 0.01), 1e-7);
  EXPECT_EQ(d.classOf(0), DeviationClass::kSignificant);
  EXPECT_EQ(d.classOf(1), DeviationClass::kSame);
}

TEST(Deviation, HasTheSidesOfPlacesWhereTheReferenceHasNone) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 2}};  // turned differently
  const DeviationReference reference = referenceTo(mesh);
  EXPECT_FALSE(reference.oriented());
  Places places;
  places.add({0.7, 0.3, 0.1}, {0, 0, 1});
  places.add({0.3, 0.7, 0.1}, {0, 0, 1});
  const Deviations d = measured(reference, places.view());
  EXPECT_FLOAT_EQ(d.distance[0], 0.1f);
  EXPECT_FLOAT_EQ(d.distance[1], 0.1f);
}

TEST(Deviation, KnowsWhetherSidesAgree) {
  const Fitted fit = fitted(sceneCloud(measure::Shape::kBumpy, 5000, 0.002));
  const DeviationReference reference = referenceTo(fit.surface);
  const Cloud cloud = sceneCloud(measure::Shape::kBumpy, 3000, 0.002);
  Places places;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float* n = cloud.normals.data() + 3 * i;
    const double* p = cloud.points.data() + 3 * i;
    places.add({p[0], p[1], p[2]}, {n[0], n[1], n[2]});
  }
  const Result<double> same = facingShare(reference, places.view(), {});
  ASSERT_TRUE(same);
  EXPECT_GT(*same, 0.99);
  for (auto& n : places.normals) n = {-n[0], -n[1], -n[2]};
  EXPECT_LT(*facingShare(reference, places.view(), {}), 0.01);
  EXPECT_TRUE(std::isnan(*facingShare(reference, {}, {})));
}

TEST(Deviation, IsTheSameForAnyNumberOfThreads) {
  const Fitted fit = fitted(sceneCloud(measure::Shape::kBumpy, 5000, 0.002));
  const DeviationReference reference = referenceTo(fit.surface);
  Places places;
  places.positions = randomPlaces(4000, 0.5 * reference.bounds().diagonal(), 9);
  DeviationParams one, four;
  one.feet.threads = 1;
  four.feet.threads = 4;
  const Deviations a = measured(reference, places.view(), one),
                   b = measured(reference, places.view(), four);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.offset, b.offset);
  EXPECT_EQ(a.detection, b.detection);
}

TEST(Deviation, SurvivesLeavesThatDoNotAgree) {
  // Random polynomials: the surface is not smooth, and each foot is at the distance that it states.
  const SLIMSurface surface = sphereSurface(4, 300);
  const DeviationReference reference = referenceTo(surface);
  Places places;
  for (const Vector3& p : randomPlaces(500, 3, 31)) {
    places.add(along(surface.info.origin, 1, p), normalized(p));
  }
  places.add({1e300, 0, 0}, {0, 0, 1});
  places.add({1e30, 1e30, 0}, {0, 0, 0});
  std::vector<ReferenceFoot> feet;
  ASSERT_FALSE(reference.find(places.view(), {}, feet));
  std::size_t found = 0;
  for (std::size_t i = 0; i + 2 < feet.size(); ++i) {
    if (feet[i].state != FootState::kFound) continue;
    ++found;
    const double off = length(subtract(places.positions[i], feet[i].position));
    EXPECT_LE(std::abs(feet[i].distance), off * (1 + 1e-6) + 1e-9);
    EXPECT_NEAR(length(feet[i].normal), 1, 1e-6);
    EXPECT_TRUE(std::isfinite(feet[i].sigma));
  }
  EXPECT_GT(found, 100u);
}

TEST(Deviation, NamesWhatIsWrong) {
  EXPECT_EQ(DeviationReference::make(SLIMSurface()).error().code, ErrorCode::kBadInput);
  EXPECT_EQ(DeviationReference::make(boxMesh(1, {1, 1, 1}), {1.0f}).error().code,
            ErrorCode::kBadInput);
  const DeviationReference reference = referenceTo(boxMesh(1, {1, 1, 1}));
  Deviations made;
  DeviationParams params;
  params.registration_error = -1;
  EXPECT_EQ(measureDeviations(reference, {}, params, made).code, ErrorCode::kBadArgument);
  params.registration_error = 0;
  params.feet.max_distance = std::numeric_limits<double>::infinity();
  EXPECT_EQ(measureDeviations(reference, {}, params, made).code, ErrorCode::kBadArgument);
  EXPECT_FALSE(measureDeviations(reference, {}, {}, made));
  EXPECT_EQ(made.size(), 0u);
}

}  // namespace
