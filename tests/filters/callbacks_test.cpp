// SPDX-License-Identifier: BSD-3-Clause
// What a progress callback may do while a class runs, and outputs that are inputs.
#include <gtest/gtest.h>
#include <pcl/PolygonMesh.h>
#include <pcl/point_types.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "filters/door_suite.h"
#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/slim_colorizer.h"
#include "pcl_slim/filters/slim_crest_lines.h"
#include "pcl_slim/filters/slim_curvature_estimation.h"
#include "pcl_slim/filters/slim_deviation.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_mesh_smoother.h"
#include "pcl_slim/filters/slim_projection_smoother.h"
#include "pcl_slim/filters/slim_reconstruction.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::bumpySphere;
using Plain = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Plain>;

/** A class with its input; run() gives its error. */
struct Runner {
  std::string name;
  std::function<void(const Progress::Callback&)> watch;
  std::function<void()> dropInput;
  std::function<Error()> run;
};

template <typename Class>
Runner runnerOf(const char* name, const std::shared_ptr<Class>& object,
                std::function<void()> verb) {
  object->setInputCloud(bumpySphere<Plain>(3000));
  return {name,
          [object](const Progress::Callback& callback) { object->setProgressCallback(callback); },
          [object] { object->setInputCloud(nullptr); },
          [object, verb] {
            verb();
            return object->getError();
          }};
}

/** Every class that works on a cloud, with an input that nothing else has. */
std::vector<Runner> runners() {
  std::vector<Runner> all;
  const auto fit = std::make_shared<SLIMFit<Plain>>();
  all.push_back(runnerOf("fit", fit, [fit] {
    pcl::PointCloud<PointSLIM> surfels;
    fit->fit(surfels);
  }));
  const auto smoother = std::make_shared<SLIMProjectionSmoother<Plain, Plain>>();
  all.push_back(runnerOf("smoother", smoother, [smoother] {
    Cloud made;
    smoother->process(made);
  }));
  const auto curvature = std::make_shared<SLIMCurvatureEstimation<Plain, PointCurvature>>();
  all.push_back(runnerOf("curvature", curvature, [curvature] {
    pcl::PointCloud<PointCurvature> made;
    curvature->compute(made);
  }));
  const auto lines = std::make_shared<SLIMCrestLines<Plain>>();
  all.push_back(runnerOf("lines", lines, [lines] {
    pcl::PointCloud<PointCrest> made;
    lines->compute(made);
  }));
  const auto colorizer = std::make_shared<SLIMColorizer<Plain>>();
  SLIMFit<Plain> painted;
  painted.setInputCloud(bumpySphere<Plain>(3000));
  SLIMSurface surface;
  EXPECT_TRUE(painted.fit(surface)) << painted.getError().message;
  surface.colors.assign(surface.size() * kColorBytes, 1);
  colorizer->setSurface(surface);
  all.push_back(runnerOf("colorizer", colorizer, [colorizer] {
    pcl::PointCloud<pcl::PointXYZRGB> made;
    colorizer->colorize(made);
  }));
  const auto deviation = std::make_shared<SLIMDeviation<Plain>>();
  deviation->setReference(bumpySphere<Plain>(3000, 2));
  all.push_back(runnerOf("deviation", deviation, [deviation] {
    pcl::PointCloud<PointDeviation> made;
    deviation->compute(made);
  }));
  const auto mesh = std::make_shared<SLIMReconstruction<Plain>>();
  all.push_back(runnerOf("reconstruction", mesh, [mesh] {
    Cloud points;
    std::vector<pcl::Vertices> polygons;
    mesh->reconstruct(points, polygons);
  }));
  const auto splats = std::make_shared<ColorOctreeSplatSampler<Plain>>();
  all.push_back(runnerOf("splats", splats, [splats] {
    Cloud made;
    splats->filter(made);
  }));
  const auto surfels = std::make_shared<ColorOctreeSplatSampler<Plain>>();
  all.push_back(runnerOf("surfels", surfels, [surfels] {
    pcl::PointCloud<pcl::PointSurfel> made;
    surfels->sample(made);
  }));
  return all;
}

TEST(Callbacks, MayDropTheInputsLastReference) {
  for (const Runner& runner : runners()) {
    int calls = 0;
    runner.watch([&](float, const char*) {
      ++calls;
      runner.dropInput();
    });
    const Error error = runner.run();
    EXPECT_FALSE(error) << runner.name << ": " << error.message;
    EXPECT_GT(calls, 0) << runner.name;
  }
}

TEST(Callbacks, MayReplaceThemselves) {
  for (const Runner& runner : runners()) {
    int calls = 0;
    const std::string text(100, 'x');  // part of the callback, which would go with it
    runner.watch([&runner, &calls, text](float, const char*) {
      runner.watch(nullptr);
      calls += text.size() == 100 ? 1 : 100;
    });
    EXPECT_FALSE(runner.run()) << runner.name;
    EXPECT_EQ(calls, 1) << runner.name;
  }
}

TEST(Callbacks, MayThrowAnything) {
  for (const Runner& runner : runners()) {
    runner.watch([](float, const char*) { throw 7; });
    EXPECT_NE(runner.run().message.find("callback"), std::string::npos) << runner.name;
    runner.watch([](float, const char*) { throw std::runtime_error("enough"); });
    EXPECT_NE(runner.run().message.find("enough"), std::string::npos) << runner.name;
    runner.watch(nullptr);
    EXPECT_FALSE(runner.run()) << runner.name << " after one that failed";
  }
}

TEST(Aliases, ReconstructionMayReplaceItsInput) {
  SLIMReconstruction<Plain> reconstruction;
  const Cloud::Ptr cloud = bumpySphere<Plain>(3000);
  reconstruction.setInputCloud(cloud);
  Cloud apart;
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(apart, polygons);
  ASSERT_GT(polygons.size(), 1000u);
  std::vector<pcl::Vertices> again;
  reconstruction.reconstruct(*cloud, again);
  ASSERT_FALSE(reconstruction.getError()) << reconstruction.getError().message;
  EXPECT_EQ(again.size(), polygons.size());
  ASSERT_EQ(cloud->size(), apart.size());
  EXPECT_EQ((*cloud)[7].x, apart[7].x);
}

TEST(Aliases, AFailedReconstructionKeepsItsInput) {
  SLIMReconstruction<Plain> reconstruction;
  const Cloud::Ptr cloud = bumpySphere<Plain>(3000);
  reconstruction.setInputCloud(cloud);
  reconstruction.setTolerance(-1);
  std::vector<pcl::Vertices> polygons(3);
  reconstruction.reconstruct(*cloud, polygons);
  EXPECT_TRUE(reconstruction.getError());
  EXPECT_EQ(cloud->size(), 3000u);
  EXPECT_TRUE(polygons.empty());
}

TEST(ExtremeParameters, AreRefusedOrGiveAValidSurface) {
  for (const double value : {1e-300, 1e18, 1e30, 1e100, 1e300}) {
    for (int k = 0; k < 5; ++k) {
      SLIMFit<Plain> fit;
      fit.setInputCloud(bumpySphere<Plain>(1500));
      if (k == 0) fit.setPenalty(value);
      if (k == 1) fit.setMDLThreshold(value);
      if (k == 2) fit.setNoiseLevel(value);
      if (k == 3) fit.setNoise(value);
      if (k == 4) {
        fit.setViewPoint(0, 0, 9);
        fit.setNoiseModel(value, 0, 0);
      }
      SLIMSurface surface;
      if (!fit.fit(surface)) continue;
      const Error error = surface.validate();
      EXPECT_FALSE(error) << k << " " << value << ": " << error.message;
    }
  }
}

}  // namespace
}  // namespace pcl_slim
