// SPDX-License-Identifier: BSD-3-Clause
// What all classes have in common, of CONTRIBUTING.md, "Conventions of the classes".
#include <gtest/gtest.h>
#include <pcl/common/io.h>

#include <cmath>
#include <memory>
#include <type_traits>

#include "exact_clouds.h"
#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/estimated_normals.h"
#include "pcl_slim/filters/io/mesh_conversion.h"
#include "pcl_slim/filters/slim_colorizer.h"
#include "pcl_slim/filters/slim_crest_lines.h"
#include "pcl_slim/filters/slim_curvature_estimation.h"
#include "pcl_slim/filters/slim_deviation.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_mesh_smoother.h"
#include "pcl_slim/filters/slim_projection_smoother.h"
#include "pcl_slim/filters/slim_reconstruction.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using P = pcl::PointXYZ;
using Smoother = SLIMProjectionSmoother<P, pcl::PointNormal>;
using Curvature = SLIMCurvatureEstimation<P>;
using Reconstruction = SLIMReconstruction<P>;
using Sampler = ColorOctreeSplatSampler<P>;
using Colorizer = SLIMColorizer<P>;
using Deviation = SLIMDeviation<P>;

/** What calling a member of a class returns. */
template <typename Class, typename... Arguments>
using FitOf = decltype(std::declval<Class&>().fit(std::declval<Arguments>()...));
template <typename Class, typename Argument>
using ComputeOf = decltype(std::declval<Class&>().compute(std::declval<Argument>()));
template <typename Class, typename Argument>
using ProcessOf = decltype(std::declval<Class&>().process(std::declval<Argument>()));
template <typename Class, typename Argument>
using FilterOf = decltype(std::declval<Class&>().filter(std::declval<Argument>()));
template <typename Class, typename Argument>
using SampleOf = decltype(std::declval<Class&>().sample(std::declval<Argument>()));

// void where PCL's base class has a virtual function that returns nothing, else bool.
static_assert(std::is_same_v<bool, FitOf<SLIMFit<P>, SLIMSurface&>>);
static_assert(std::is_same_v<bool, FitOf<SLIMFit<P>, pcl::PointCloud<PointSLIM>&>>);
static_assert(std::is_same_v<bool, ComputeOf<SLIMCrestLines<P>, CrestLines&>>);
static_assert(std::is_same_v<bool, ComputeOf<SLIMCrestLines<P>, pcl::PointCloud<PointCrest>&>>);
static_assert(std::is_same_v<bool, ComputeOf<Curvature, pcl::PointCloud<PointCurvature>&>>);
static_assert(std::is_same_v<bool, ProcessOf<SLIMMeshSmoother, pcl::PolygonMesh&>>);
static_assert(std::is_same_v<bool, ComputeOf<Deviation, pcl::PointCloud<PointDeviation>&>>);
static_assert(std::is_same_v<bool, decltype(std::declval<Colorizer&>().colorize(
                                       std::declval<pcl::PointCloud<pcl::PointXYZRGB>&>()))>);
static_assert(std::is_same_v<bool, FilterOf<Sampler, pcl::PointCloud<P>&>>);
static_assert(std::is_same_v<bool, FilterOf<Sampler, pcl::Indices&>>);
static_assert(std::is_same_v<bool, SampleOf<Sampler, SplatSet&>>);
static_assert(std::is_same_v<bool, SampleOf<Sampler, pcl::PointCloud<pcl::PointSurfel>&>>);
static_assert(std::is_same_v<void, ProcessOf<Smoother, pcl::PointCloud<pcl::PointNormal>&>>);
static_assert(std::is_same_v<void, decltype(std::declval<Reconstruction&>().reconstruct(
                                       std::declval<pcl::PolygonMesh&>()))>);

template <typename Class>
class FitClasses : public testing::Test {};
using AllThatFit = testing::Types<SLIMFit<P>, SLIMCrestLines<P>, Curvature, Smoother,
                                  Reconstruction, SLIMMeshSmoother, Colorizer, Deviation>;
TYPED_TEST_SUITE(FitClasses, AllThatFit);

TYPED_TEST(FitClasses, TheLastOfParametersThatExcludeEachOtherCounts) {
  TypeParam fit;
  fit.setMaxSurfels(100);
  fit.setTargetError(1e-3);
  EXPECT_EQ(fit.getMaxSurfels(), 0u);
  EXPECT_EQ(fit.getTargetError(), 1e-3);
  fit.setMaxSurfels(100);
  EXPECT_EQ(fit.getTargetError(), 0);
  EXPECT_EQ(fit.getMaxSurfels(), 100u);
  fit.setPenalty(5);
  EXPECT_EQ(fit.getMaxSurfels(), 0u);
  fit.setMDLThreshold(0.01);
  EXPECT_EQ(fit.getPenalty(), 0);
  fit.setPenalty(5);
  EXPECT_EQ(fit.getMDLThreshold(), 0);
  fit.setTargetDistance(0.1);
  fit.setNoiseFactor(2);
  EXPECT_EQ(fit.getTargetDistance(), 0);
  fit.setPenalty(0);
  EXPECT_EQ(fit.getNoiseFactor(), 2) << "unsetting one does not unset another";

  double a = 0, b = 0, c = 0;
  fit.setNoise(0.01);
  fit.setNoiseLevel(1e-6);
  EXPECT_EQ(fit.getNoise(), 0);
  fit.setNoise(0.01);
  EXPECT_EQ(fit.getNoiseLevel(), 0);
  fit.setNoiseModel(0.001, 0, 0.002);
  EXPECT_EQ(fit.getNoise(), 0);
  fit.setNoiseLevel(1e-6);
  EXPECT_FALSE(fit.getNoiseModel(a, b, c));
  fit.setLocalNoise(true);
  fit.setNoiseModel(0.001, 0, 0.002);
  EXPECT_FALSE(fit.getLocalNoise().has_value());
  fit.setLocalNoise(true);
  EXPECT_FALSE(fit.getNoiseModel(a, b, c));
  EXPECT_FALSE(fit.getParams().validate());

  SensorNoise sensor;
  sensor.error[0] = 0.01;
  sensor.neighbors = 40;
  sensor.residual = {0.9, 0.9};
  fit.setSensorNoise(sensor);
  EXPECT_FALSE(fit.getLocalNoise().has_value());
  fit.setNoise(0.01);
  EXPECT_FALSE(fit.getSensorNoise().has_value());
  fit.setNoiseCorrelation(4);
  fit.setSensorNoise(sensor);
  EXPECT_EQ(fit.getNoise(), 0);
  EXPECT_EQ(fit.getNoiseCorrelation(), 0);
  EXPECT_FALSE(fit.getParams().validate());
  fit.setNoiseModel(0.001, 0, 0.002);
  EXPECT_FALSE(fit.getSensorNoise().has_value());

  fit.setViewPoint(1, 2, 3);
  fit.setSensorPositions({Eigen::Vector3d(0, 0, 1)});
  EXPECT_FALSE(fit.getViewPoint(a, b, c));
  fit.setViewPoint(1, 2, 3);
  EXPECT_FALSE(fit.getSensorPositions());
}

TEST(Conventions, TheLastBudgetOfASamplerCounts) {
  Sampler sampler;
  sampler.setMaxSplats(100);
  sampler.setTargetError(3);
  EXPECT_EQ(sampler.getMaxSplats(), 0u);
  sampler.setMaxSplats(100);
  EXPECT_EQ(sampler.getTargetError(), 0);
  sampler.setInputCloud(sphereCloud<P>(2000, 1, 0));
  SplatSet splats;
  EXPECT_TRUE(sampler.sample(splats)) << sampler.getError().message;
}

template <typename Class>
class SurfaceClasses : public testing::Test {};
using AllThatTakeASurface = testing::Types<SLIMCrestLines<P>, Curvature, Smoother, Reconstruction,
                                           SLIMMeshSmoother, Colorizer, Deviation>;
TYPED_TEST_SUITE(SurfaceClasses, AllThatTakeASurface);

TYPED_TEST(SurfaceClasses, ShareASurfaceOrCopyIt) {
  TypeParam user;
  EXPECT_FALSE(user.getSurface());
  auto shared = std::make_shared<SLIMSurface>();
  user.setSurface(shared);
  EXPECT_EQ(user.getSurface(), shared);
  const std::weak_ptr<SLIMSurface> seen = shared;
  shared.reset();
  EXPECT_FALSE(seen.expired()) << "it is kept";
  {
    SLIMSurface own;
    own.info.degree = 2;
    user.setSurface(own);
    EXPECT_NE(user.getSurface().get(), &own);
  }
  EXPECT_TRUE(seen.expired());
  ASSERT_TRUE(user.getSurface());
  EXPECT_EQ(user.getSurface()->info.degree, 2);
  user.setSurface(nullptr);
  EXPECT_FALSE(user.getSurface());
}

TEST(Conventions, HolesOfTheSurfaceAndOfTheMeshHaveNamesOfTheirOwn) {
  Reconstruction reconstruction;
  reconstruction.setHoleSize(12);
  EXPECT_EQ(reconstruction.getParams().hole_size, 12);
  EXPECT_EQ(reconstruction.getMeshHoleSize(), MeshParams().hole_size);
  reconstruction.setMeshHoleSize(9);
  EXPECT_EQ(reconstruction.getMeshParams().hole_size, 9);
  EXPECT_EQ(reconstruction.getHoleSize(), 12);

  // A hemisphere's hole of some 7 spacings in its top: closed by either.
  auto cloud = std::make_shared<pcl::PointCloud<P>>();
  for (const P& p : *sphereCloud<P>(8000, 1, 0))
    if (std::hypot(p.x, p.y) > 0.14f || p.z < 0) cloud->push_back(p);
  const auto borders = [&](double surface, double mesh) {
    Reconstruction made;
    made.setInputCloud(cloud);
    made.setHoleSize(surface);
    made.setMeshHoleSize(mesh);
    pcl::PolygonMesh triangles;
    made.reconstruct(triangles);
    EXPECT_FALSE(made.getError()) << made.getError().message;
    return made.getMeshStatistics().census.border_edges;
  };
  EXPECT_GT(borders(4, 4), 0u);
  EXPECT_EQ(borders(12, 4), 0u);
  EXPECT_EQ(borders(4, 12), 0u);
}

TEST(Conventions, APrintedWarningIsOneThatIsReturned) {
  const auto cloud = sphereCloud<P>(2000, 1, 0.002);
  const auto run = [](auto& door, const auto& verb) {
    testing::internal::CaptureStderr();
    verb();
    const std::string printed = testing::internal::GetCapturedStderr();
    EXPECT_NE(door.getWarning().find("sharp features have no effect"), std::string::npos)
        << door.getWarning();
    return printed;
  };
  const auto set = [&](auto& door) {
    door.setInputCloud(cloud);
    door.setSharpFeatures(true);
  };
  SLIMFit<P> fit;
  set(fit);
  SLIMSurface surface;
  EXPECT_EQ(run(fit, [&] { fit.fit(surface); }), "") << "no verb of PCL's";
  Smoother smoother;
  set(smoother);
  pcl::PointCloud<pcl::PointNormal> smooth;
  EXPECT_NE(run(smoother, [&] { smoother.process(smooth); }).find("sharp features"),
            std::string::npos);
  Curvature curvature;
  set(curvature);
  pcl::PointCloud<PointCurvature> curvatures;
  EXPECT_NE(run(curvature, [&] { curvature.compute(curvatures); }).find("sharp features"),
            std::string::npos);
  Reconstruction reconstruction;
  set(reconstruction);
  pcl::PolygonMesh mesh;
  EXPECT_NE(run(reconstruction, [&] { reconstruction.reconstruct(mesh); }).find("sharp features"),
            std::string::npos);
  reconstruction.setSharpFeatures(false);
  reconstruction.setViewPoint(0, 0, 9);
  testing::internal::CaptureStderr();
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(reconstruction.getWarning(), "");
}

TEST(Conventions, WhatIsNotKnownIsNan) {
  auto two = std::make_shared<pcl::PointCloud<P>>();
  two->push_back({0, 0, 0});
  two->push_back({1, 0, 0});
  two->push_back({std::nanf(""), 0, 0});
  two->is_dense = false;
  Smoother smoother;
  smoother.setInputCloud(two);
  pcl::PointCloud<pcl::PointNormal> smooth;
  testing::internal::CaptureStderr();  // a warning: two points are no surface
  smoother.process(smooth);
  testing::internal::GetCapturedStderr();
  ASSERT_EQ(smooth.size(), 3u);
  EXPECT_FALSE(smooth.is_dense);
  for (const auto& p : smooth) EXPECT_TRUE(std::isnan(p.normal_x) && std::isnan(p.curvature));

  auto cloud = sphereCloud<P>(2000, 1, 0);
  (*cloud)[5].z = std::nanf("");
  CloudView view;
  view.xyz = cloud->points.data();
  view.xyz_stride = sizeof(P);
  view.size = cloud->size();
  std::vector<float> normals;
  ASSERT_FALSE(estimateNormals(view, 10, {}, 1, normals));
  EXPECT_TRUE(std::isnan(normals[15]));
  EXPECT_FALSE(std::isnan(normals[18]));
}

}  // namespace
}  // namespace pcl_slim
