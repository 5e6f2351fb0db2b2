// SPDX-License-Identifier: BSD-3-Clause
// Motions that remain between places and a reference: recovered, with errors; what is undetermined.
#include "pcl_slim/compare/registration.h"

#include <gtest/gtest.h>

#include "rigid_motion.h"
#include "support/clouds.h"
#include "unit/compare/compare_meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** Places on a mesh: a random one on each triangle, moved along its normal by noise. */
std::vector<Vector3> placesOn(const TriangleMesh& mesh, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss(0, 1);
  std::vector<Vector3> places;
  for (const auto& c : mesh.triangles) {
    double u = static_cast<double>(random() >> 11) * 0x1p-53,
           v = static_cast<double>(random() >> 11) * 0x1p-53;
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vector3 a = mesh.vertices[c[0]], ab = subtract(mesh.vertices[c[1]], a),
                  ac = subtract(mesh.vertices[c[2]], a);
    const Vector3 n = normalized(cross(ab, ac));
    places.push_back(along(along(along(a, u, ab), v, ac), noise * gauss(random), n));
  }
  return places;
}

Registration registered(const DeviationReference& reference, const std::vector<Vector3>& positions,
                        RegistrationParams params = {}) {
  DeviationPlaces places;
  places.positions = positions.data();
  places.count = positions.size();
  const Result<Registration> made = registerPlaces(reference, places, params);
  EXPECT_TRUE(made) << made.error().message;
  return made ? *made : Registration();
}

void moveBy(const RigidMotion& motion, std::vector<Vector3>& places) {
  for (Vector3& p : places) p = motion.place(p);
}

TEST(Registration, MotionsComposeAndHaveMatrices) {
  const RigidMotion a = detail::rigidMotion({1, 2, 3}, {0.1, -0.4, 0.7}, {5, 5, 5});
  const RigidMotion b = detail::rigidMotion({-1, 0.5, 0}, {1, 0.2, 0}, {-2, 0, 1});
  const RigidMotion both = detail::composed(b, a);
  const Vector3 p = {0.3, -2, 9};
  EXPECT_NEAR(length(subtract(both.place(p), b.place(a.place(p)))), 0, 1e-12);
  EXPECT_NEAR(length(subtract(detail::rotationVector(a), {0.1, -0.4, 0.7})), 0, 1e-12);
  const auto m = both.matrix();
  for (std::size_t r = 0; r < 3; ++r) {
    const double x = m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3];
    EXPECT_NEAR(x, both.place(p)[r], 1e-12);
  }
  // A quarter turn about z.
  const RigidMotion turn = detail::rigidMotion({}, {0, 0, M_PI / 2}, {});
  EXPECT_NEAR(length(subtract(turn.place({1, 0, 0}), {0, 1, 0})), 0, 1e-12);
}

TEST(Registration, RecoversAMotionWithinItsErrors) {
  // A box has all six numbers. The error of each, over repeated noise, is what is stated.
  const TriangleMesh box = boxMesh(14, {1, 0.7, 0.4}, {1000, 2000, 30});
  const DeviationReference reference = referenceTo(box);
  const RigidMotion motion =
      detail::rigidMotion({0.02, -0.01, 0.015}, {0.01, 0.02, -0.015}, {1000, 2000, 30});
  double squares[6] = {};
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<Vector3> places = placesOn(box, 0.004, 100 + static_cast<unsigned>(run));
    moveBy(motion, places);
    const Registration found = registered(reference, places);
    ASSERT_EQ(found.rank, 6);
    EXPECT_TRUE(found.converged);
    // What is left of a place after both motions.
    const Vector3 back = found.motion.place(motion.place({1000, 2000, 30}));
    const Vector3 offset = subtract(back, {1000, 2000, 30});
    const Vector3 angle = detail::rotationVector(detail::composed(found.motion, motion));
    for (std::size_t a = 0; a < 3; ++a) {
      squares[a] += std::pow(offset[a] / found.translation_error[a], 2);
      squares[3 + a] += std::pow(angle[a] / found.rotation_error[a], 2);
    }
    EXPECT_NEAR(found.noise, 0.004, 6e-4);
  }
  // A mean of 20 squares of unit deviations is within .4 to 1.9 in 99.8 % of runs.
  for (const double square : squares) {
    EXPECT_GT(square / kRuns, 0.4);
    EXPECT_LT(square / kRuns, 1.9);
  }
}

/** The square [0, 2]^2 of the plane z = 0 in cells. */
TriangleMesh gridMesh(std::uint32_t columns, std::uint32_t rows) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= columns; ++i) {
    for (std::uint32_t j = 0; j <= rows; ++j)
      mesh.vertices.push_back({2.0 * i / columns, 2.0 * j / rows, 0});
  }
  for (std::uint32_t i = 0; i < columns; ++i) {
    for (std::uint32_t j = 0; j < rows; ++j) {
      const std::uint32_t v = (rows + 1) * i + j;
      mesh.triangles.push_back({v, v + rows + 1, v + rows + 2});
      mesh.triangles.push_back({v, v + rows + 2, v + 1});
    }
  }
  return mesh;
}

TEST(Registration, KnowsWhatAShapeDoesNotDetermine) {
  const TriangleMesh plane = gridMesh(20, 20);
  TriangleMesh cylinder = gridMesh(120, 10);  // its facets turn by 3 degrees
  for (Vector3& p : cylinder.vertices) {
    p = {std::cos(M_PI * p[0]), std::sin(M_PI * p[0]), 2 * p[1]};
  }
  const struct {
    TriangleMesh mesh;
    int rank;
  } bodies[] = {{plane, 3}, {trianglesOf(sphereMesh(30)), 3}, {cylinder, 4}};
  for (const auto& body : bodies) {
    const DeviationReference reference = referenceTo(body.mesh);
    std::vector<Vector3> places = placesOn(body.mesh, 0.002, 3);
    moveBy(detail::rigidMotion({0.003, 0.004, 0.005}, {0.004, -0.003, 0.005}, {1, 1, 0}), places);
    const Registration found = registered(reference, places);
    EXPECT_EQ(found.rank, body.rank);
    for (int k = 0; k < 6; ++k) {
      const RegistrationMode& mode = found.modes[static_cast<std::size_t>(k)];
      EXPECT_EQ(mode.determined, k < body.rank);
      EXPECT_EQ(std::isinf(mode.error), k >= body.rank);
      if (!mode.determined) {
        EXPECT_EQ(mode.value, 0);
      }
    }
    EXPECT_NEAR(found.rms_after, 0.002, 4e-4);
  }
  const DeviationReference reference = referenceTo(plane);
  std::vector<Vector3> places = placesOn(plane, 0.001, 5);
  for (Vector3& p : places) p = along(p, 0.05, {1, 1, 1});
  const Registration found = registered(reference, places);
  EXPECT_NEAR(found.translation[2], -0.05, 1e-3);
  EXPECT_NEAR(found.translation[0], 0, 1e-3);  // along the plane: undetermined, so not applied
  EXPECT_TRUE(std::isinf(found.translation_error[0]));
  EXPECT_TRUE(std::isinf(found.rotation_error[2]));
  EXPECT_LT(found.translation_error[2], 1e-3);
  EXPECT_LT(found.rotation_error[0], 1e-3);
}

TEST(Registration, ALocalChangeHasNoInfluence) {
  // A tenth of the places is pushed in by 5 deviations of the noise; a least-squares fit would take
  // up a tenth of it.
  const TriangleMesh box = boxMesh(20, {1, 0.7, 0.4});
  const DeviationReference reference = referenceTo(box);
  std::vector<Vector3> places = placesOn(box, 0.002, 9);
  std::size_t pushed = 0;
  for (Vector3& p : places) {
    const bool dent = p[2] > 0.39 && std::abs(p[0]) < 0.7 && std::abs(p[1]) < 0.5;
    if (dent) p[2] -= 0.01;
    pushed += dent;
  }
  ASSERT_GT(pushed, places.size() / 15);
  const Registration found = registered(reference, places);
  EXPECT_LT(std::abs(found.translation[2]), 4e-4);
  EXPECT_NEAR(found.noise, 0.002, 3e-4);
}

TEST(Registration, ErrorsGrowWithFewerIndependentPoints) {
  const TriangleMesh box = boxMesh(8, {1, 0.7, 0.4});
  const DeviationReference reference = referenceTo(box);
  const std::vector<Vector3> places = placesOn(box, 0.003, 1);
  RegistrationParams params;
  const Registration all = registered(reference, places, params);
  params.effective_count = static_cast<double>(places.size()) / 9;
  const Registration ninth = registered(reference, places, params);
  EXPECT_NEAR(ninth.translation_error[1], 3 * all.translation_error[1], 1e-12);
  EXPECT_EQ(ninth.translation, all.translation);
  EXPECT_NEAR(all.errorAt(all.motion.center, {0, 1, 0}), all.translation_error[1], 1e-12);
  EXPECT_GT(all.errorAt(along(all.motion.center, 5, {1, 0, 0}), {0, 1, 0}),
            all.translation_error[1]);
}

TEST(Registration, OnASurfaceAndTheSameForAnyThreads) {
  const Fitted fit = fitted(sceneCloud(measure::Shape::kBumpy, 20000, 0.001));
  const Result<DeviationReference> reference = DeviationReference::make(fit.surface, 1);
  ASSERT_TRUE(reference);
  const auto scene = measure::makeScene(measure::Shape::kBumpy, 5000, 0.001, 0, 21);
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < scene.points.size(); i += 3) {
    places.push_back({scene.points[i], scene.points[i + 1], scene.points[i + 2]});
  }
  const RigidMotion motion = detail::rigidMotion({0.01, -0.02, 0.01}, {0.01, 0.01, -0.02}, {});
  moveBy(motion, places);
  RegistrationParams one, four;
  one.feet.threads = 1;
  four.feet.threads = 4;
  const Registration found = registered(*reference, places, one);
  EXPECT_EQ(found.rank, 6);
  const Vector3 offset = found.motion.place(motion.place({0, 0, 0}));
  // 5 standard errors: of these 5,000 places, and of the fit's 20,000.
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_LT(std::abs(offset[a]), 6 * found.translation_error[a]);
  EXPECT_LT(found.translation_error[0], 1e-3);
  const Registration again = registered(*reference, places, four);
  EXPECT_EQ(found.translation, again.translation);
  EXPECT_EQ(found.rotation, again.rotation);
  EXPECT_EQ(found.rotation_error, again.rotation_error);
}

TEST(Registration, NamesWhatIsWrong) {
  const DeviationReference reference = referenceTo(boxMesh(2, {1, 1, 1}));
  const std::vector<Vector3> few = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  DeviationPlaces places;
  places.positions = few.data();
  places.count = few.size();
  const Result<Registration> made = registerPlaces(reference, places, {});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kBadInput);
  EXPECT_NE(made.error().message.find("only 3 places"), std::string::npos);
  RegistrationParams params;
  params.most_iterations = 0;
  EXPECT_EQ(registerPlaces(reference, places, params).error().code, ErrorCode::kBadArgument);
}

}  // namespace
