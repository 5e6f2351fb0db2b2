// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/carrier_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim {
namespace {

constexpr double kPi = 3.14159265358979323846;

/** A unit square of two triangles at z = 1. */
TriangleMesh unitSquare() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

double sumOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double longestEdge(const TriangleMesh& mesh) {
  double longest = 0.0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k)
      longest =
          std::max(longest, length(subtract(mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]])));
  }
  return longest;
}

/** A surface fitted to points of a sphere of radius 2 about (10, 0, 0). */
SLIMSurface sphereFit(std::size_t count, double noise) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 n = normalized({normal(random), normal(random), normal(random)});
    points.push_back(along({10, 0, 0}, 2.0 + noise * normal(random), n));
  }
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size();
  const auto store = PointStore::build(view, 1);
  SLIMSurface surface;
  const Error error = fitSurface(*store, FitParams(), surface);
  EXPECT_FALSE(error) << error.message;
  return surface;
}

TEST(CarrierMesh, DividesEdgesWithoutGaps) {
  for (const double edge : {0.3, 0.11, 0.05}) {
    CarrierParams params;
    params.longest_edge = edge;
    const auto made = carrierMeshOf(unitSquare(), params);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(made->longest_edge, edge);
    EXPECT_LE(longestEdge(made->mesh), edge * (1 + 1e-12));
    EXPECT_GT(longestEdge(made->mesh), 0.4 * edge);
    const MeshCensus census = censusOf(made->mesh);
    EXPECT_EQ(census.components, 1u);
    EXPECT_EQ(census.euler, 1);
    EXPECT_EQ(census.nonmanifold_edges, 0u);
    EXPECT_EQ(census.turned_edges, 0u);
    EXPECT_NEAR(made->area, 1.0, 1e-12);
    EXPECT_NEAR(sumOf(made->carrier.area), 1.0, 1e-9);
    EXPECT_EQ(made->carrier.num_components, 1u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(made->mesh.vertices[i], unitSquare().vertices[i]);
    EXPECT_TRUE(made->places.oriented);
    EXPECT_TRUE(made->places.sigma.empty());
    for (std::size_t i = 0; i < made->places.size(); ++i) {
      EXPECT_EQ(made->places.positions[i][2], 1.0);
      EXPECT_EQ(made->places.normals[i], (std::array<float, 3>{0, 0, 1}));
    }
  }
}

TEST(CarrierMesh, KeepsTheStandardErrorsOfAMesh) {
  TriangleMesh mesh = unitSquare();
  mesh.sigma = {0.1f, 0.1f, 0.3f, 0.3f};
  CarrierParams params;
  params.longest_edge = 0.2;
  const auto made = carrierMeshOf(mesh, params);
  ASSERT_TRUE(made) << made.error().message;
  ASSERT_EQ(made->places.sigma.size(), made->places.size());
  for (std::size_t i = 0; i < made->places.size(); ++i)  // they rise linearly with y
    EXPECT_NEAR(made->places.sigma[i], 0.1 + 0.2 * made->places.positions[i][1], 1e-6);
}

TEST(CarrierMesh, KeepsToTheMostPlaces) {
  CarrierParams params;
  for (const std::uint64_t most : {100u, 3000u}) {
    params.most_places = most;
    params.longest_edge = 0.001;
    const auto made = carrierMeshOf(unitSquare(), params);
    ASSERT_TRUE(made);
    EXPECT_LT(made->places.size(), 2 * most);
    EXPECT_GT(made->places.size(), most / 3);
  }
  params.longest_edge = 1e300;  // a mesh's own vertices alone
  EXPECT_EQ(carrierMeshOf(unitSquare(), params)->places.size(), 4u);
}

TEST(CarrierMesh, VerticesOfASurfaceAreOnIt) {
  const SLIMSurface surface = sphereFit(6000, 0.01);
  CarrierParams params;
  params.threads = 1;
  const auto made = carrierMeshOf(surface, params);
  ASSERT_TRUE(made) << made.error().message;
  const double spacing = std::sqrt(16 * kPi / 6000);
  EXPECT_NEAR(made->longest_edge, 2 * spacing, 0.02 * spacing);
  EXPECT_NEAR(made->area, 16 * kPi, 0.01 * 16 * kPi);
  EXPECT_NEAR(sumOf(made->carrier.area), made->area, 1e-6 * made->area);
  ASSERT_EQ(made->places.sigma.size(), made->places.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < made->places.size(); ++i) {
    const Vector3 from = subtract(made->places.positions[i], {10, 0, 0});
    sum += std::pow(length(from) - 2.0, 2);
    const auto& n = made->places.normals[i];
    EXPECT_GT(dot(normalized(from), {n[0], n[1], n[2]}), 0.99) << i;
    EXPECT_GT(made->places.sigma[i], 0.0f);
    EXPECT_LT(made->places.sigma[i], 0.011f);
  }
  EXPECT_LT(std::sqrt(sum / static_cast<double>(made->places.size())), 0.004);
  params.threads = 4;
  const auto again = carrierMeshOf(surface, params);
  ASSERT_TRUE(again);
  EXPECT_EQ(made->places.positions, again->places.positions);
  EXPECT_EQ(made->places.sigma, again->places.sigma);
  EXPECT_EQ(made->carrier.area, again->carrier.area);
}

TEST(CarrierMesh, RefusesWhatHasNoArea) {
  TriangleMesh mesh = unitSquare();
  for (Vector3& v : mesh.vertices) v = {1, 2, 3};
  EXPECT_FALSE(carrierMeshOf(mesh, {}));
  EXPECT_FALSE(carrierMeshOf(TriangleMesh(), {}));
  mesh = unitSquare();
  mesh.triangles.push_back({0, 1, 9});
  EXPECT_FALSE(carrierMeshOf(mesh, {}));
  CarrierParams bad;
  bad.longest_edge = -1;
  EXPECT_EQ(carrierMeshOf(unitSquare(), bad).error().code, ErrorCode::kBadArgument);
  EXPECT_FALSE(carrierMeshOf(SLIMSurface(), {}));
}

TEST(CarrierMesh, EdgesForASurfaceAreAboutTwoSpacingsOfItsPoints) {
  for (const std::size_t count : {3000u, 20000u}) {
    for (const double noise : {0.0, 0.01}) {
      const double spacing = std::sqrt(4 * kPi * 2.0 * 2.0 / static_cast<double>(count));
      EXPECT_NEAR(longestEdgeFor(sphereFit(count, noise)), 2 * spacing, 0.5 * spacing);
    }
  }
  EXPECT_EQ(longestEdgeFor(SLIMSurface()), 0.0);
}

}  // namespace
}  // namespace pcl_slim
