// SPDX-License-Identifier: BSD-3-Clause
// What shows the side of a cloud, and whether a scan's spacing shows its sensor.
#include "pcl_slim/cloud/side_evidence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "support/side_scans.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

using Place = std::array<double, 3>;

TEST(SideEvidence, IsTheStrongest) {
  Cloud cloud = boxCloud({1, 1, 1}, 2000, 0);
  const std::vector<double> sensors(cloud.points.size(), 5.0);
  CloudView view = cloud.view();
  view.sensors = sensors.data();
  view.sensors_stride = 3 * sizeof(double);
  view.sensor = Place{0, 0, 7};
  const Place given{1, 2, 3};
  const auto expectSource = [&](SideSource with, SideSource without) {
    const auto store = PointStore::build(view, 1);
    ASSERT_TRUE(store) << store.error().message;
    const SideEvidence asked = findSideEvidence(*store, given),
                       found = findSideEvidence(*store, {});
    EXPECT_EQ(asked.source, with) << nameOf(asked.source);
    EXPECT_EQ(found.source, without) << nameOf(found.source);
    EXPECT_EQ(asked.eye.has_value(), with == SideSource::kViewpoint);
    if (asked.eye) {
      EXPECT_EQ(*asked.eye, given);
    }
    if (without == SideSource::kViewpoint) {
      EXPECT_EQ(found.eye, (Place{0, 0, 7}));
    }
  };
  expectSource(SideSource::kNormals, SideSource::kNormals);
  const auto store = PointStore::build(view, 1);
  EXPECT_EQ(findSensorEvidence(*store, given).source, SideSource::kViewpoint);
  EXPECT_EQ(findSensorEvidence(*store, {}).source, SideSource::kSensors);
  view.normal = nullptr;
  expectSource(SideSource::kViewpoint, SideSource::kSensors);
  view.sensors = nullptr;
  expectSource(SideSource::kViewpoint, SideSource::kViewpoint);
  view.sensor.reset();
  expectSource(SideSource::kViewpoint, SideSource::kNone);
}

TEST(SideEvidence, TheOriginIsTheLastOfAll) {
  const Cloud room = scannedRoom();
  CloudView view = room.view();
  const auto bare = PointStore::build(view, 1);
  const SideEvidence found = findSideEvidence(*bare, {});
  EXPECT_EQ(found.source, SideSource::kOrigin);
  EXPECT_EQ(found.eye, (Place{0, 0, 0}));
  EXPECT_EQ(findSideEvidence(*bare, Place{1, 0, 0}).source, SideSource::kViewpoint);
  view.sensor = Place{0.5, 0, 0};
  const auto known = PointStore::build(view, 1);
  EXPECT_EQ(findSideEvidence(*known, {}).source, SideSource::kViewpoint);
}

TEST(SideEvidence, SourcesHaveNames) {
  EXPECT_STREQ(nameOf(SideSource::kNone), "none");
  EXPECT_STREQ(nameOf(SideSource::kNormals), "normals");
  EXPECT_STREQ(nameOf(SideSource::kSensors), "sensors");
  EXPECT_STREQ(nameOf(SideSource::kViewpoint), "viewpoint");
  EXPECT_STREQ(nameOf(SideSource::kOrigin), "origin");
  EXPECT_STREQ(nameOf(SideSource::kThinParts), "thin_parts");
  EXPECT_STREQ(nameOf(SideSource::kOutward), "outward");
}

TEST(SideEvidence, NotesNameTheRemedy) {
  NormalAgreement good, flipped, random;
  flipped.opposed = flipped.contradicted = 0.0123;
  random.opposed = random.contradicted = 0.25;
  random.axis = 0.5;
  for (const SideSource quiet :
       {SideSource::kNone, SideSource::kNormals, SideSource::kSensors, SideSource::kViewpoint})
    EXPECT_TRUE(sideNotes(quiet, good, "-viewpoint X,Y,Z").empty()) << nameOf(quiet);
  const std::string outward =
      "sides: outward (no sensor known; -viewpoint X,Y,Z if it was scanned from inside)";
  NormalAgreement thin;  // the sides of thin parts
  thin.opposed = 0.2;
  EXPECT_TRUE(sideNotes(SideSource::kNormals, thin, "R").empty());
  using Notes = std::vector<std::string>;
  EXPECT_EQ(sideNotes(SideSource::kOutward, good, "-viewpoint X,Y,Z"), Notes{outward});
  EXPECT_EQ(sideNotes(SideSource::kThinParts, good, "-viewpoint X,Y,Z"), Notes{outward});
  EXPECT_EQ(
      sideNotes(SideSource::kOrigin, good, "R"),
      Notes{"sides: towards the origin, as the points' spacing shows a scanner there (R if it "
            "was elsewhere)"});
  EXPECT_EQ(sideNotes(SideSource::kNormals, flipped, "R"),
            Notes{"normals of 1.2 % of the neighbours are opposed: used without their signs"});
  EXPECT_EQ(
      sideNotes(SideSource::kOutward, random, "-viewpoint X,Y,Z"),
      (Notes{"normals of 25.0 % of the neighbours are opposed: not used, as they have no axes "
             "in common either",
             outward}));
}

/** Some clouds by name. */
struct NamedCloud {
  std::string name;
  Cloud cloud;
};

std::vector<NamedCloud> scansFromTheOrigin() {
  measure::DepthCamera camera;
  camera.width = 160;
  camera.height = 120;
  camera.focal = 146;
  measure::TurningLidar lidar;
  lidar.steps = 600;
  std::vector<NamedCloud> scans;
  for (const char* name : {"room", "hall", "balls"})
    scans.push_back({name, aboutSensor(scanByCamera(measure::namedSolids(name), camera, 5))});
  scans.push_back({"street", aboutSensor(scanByLidar(measure::namedSolids("street"), lidar, 5))});
  scans.push_back({"room of walls", scannedRoom()});
  return scans;
}

/** Random points of half a sphere, evenly spread. */
Cloud evenShell() {
  Cloud cloud;
  std::mt19937_64 random(4);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 8000; ++i) {
    const Vector3 n = normalized({gauss(random), gauss(random), gauss(random)});
    cloud.add(n[0], n[1], std::abs(n[2]));
  }
  return cloud;
}

std::vector<NamedCloud> bodies() {
  std::vector<NamedCloud> result{
      {"sphere", sceneCloud(measure::Shape::kSphere, 8000, 0.001).withoutNormals()},
      {"torus", sceneCloud(measure::Shape::kTorus, 8000, 0.001).withoutNormals()},
      {"cube", boxCloud({1, 1, 1}, 8000, 0.002).withoutNormals()},
      {"shell", evenShell()},
      {"far torus", sceneCloud(measure::Shape::kTorus, 8000, 0.001).withoutNormals()}};
  Cloud& far = result.back().cloud;
  for (std::size_t i = 0; i < far.points.size(); i += 3) {
    far.points[i] += 5e5;
    far.points[i + 1] += 5e6;
  }
  return result;
}

double spreadAtOrigin(const Cloud& cloud) {
  return scannerSpread(storeOf(cloud), {0, 0, 0});
}

TEST(ScannerSpread, IsSmallWhereAScannerWas) {
  for (const NamedCloud& scan : scansFromTheOrigin())
    EXPECT_LT(spreadAtOrigin(scan.cloud), kMostScannerSpread) << scan.name;
}

TEST(ScannerSpread, IsLargeWhereNoneWas) {
  for (const NamedCloud& body : bodies()) EXPECT_GT(spreadAtOrigin(body.cloud), 0.95) << body.name;
  // The room from another place of it, and merged from two.
  Cloud moved = scannedRoom();
  for (std::size_t i = 0; i < moved.points.size(); i += 3) moved.points[i] += 3;
  EXPECT_GT(spreadAtOrigin(moved), 0.95);
}

TEST(ScannerSpread, OfTooFewPointsIsOne) {
  const Cloud room = scannedRoom();
  for (const std::size_t count : {1, 10, 30}) {
    Cloud few;
    for (std::size_t i = 0; i < count; ++i)
      few.add(room.points[300 * i], room.points[300 * i + 1], room.points[300 * i + 2]);
    EXPECT_EQ(spreadAtOrigin(few), 1) << count;
  }
  Cloud line;
  for (int i = 0; i < 2000; ++i) line.add(i, 2 * i, 3);
  EXPECT_GE(spreadAtOrigin(line), 1);
}

Cloud mapped(const Cloud& cloud, const std::function<Vector3(const Vector3&)>& map) {
  Cloud result;
  for (std::size_t i = 0; i < cloud.points.size(); i += 3) {
    const Vector3 p = map({cloud.points[i], cloud.points[i + 1], cloud.points[i + 2]});
    result.add(p[0], p[1], p[2]);
  }
  return result;
}

/** Turned about an axis through the origin. */
Cloud turnedAbout(const Cloud& cloud, const Vector3& axis, double angle) {
  const Vector3 w = normalized(axis);
  return mapped(cloud, [&](const Vector3& p) {
    const Vector3 level = scaled(p, std::cos(angle));
    return along(along(level, std::sin(angle), cross(w, p)), (1 - std::cos(angle)) * dot(w, p), w);
  });
}

Cloud thinnedTo(const Cloud& cloud, double share) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud result;
  for (std::size_t i = 0; i < cloud.points.size(); i += 3) {
    if (unit(random) < share) result.add(cloud.points[i], cloud.points[i + 1], cloud.points[i + 2]);
  }
  return result;
}

TEST(ScannerSpread, DecidesTheSameForACloudInOtherForms) {
  std::vector<NamedCloud> all = scansFromTheOrigin();
  const std::size_t scans = all.size();
  for (NamedCloud& body : bodies()) all.push_back(std::move(body));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Cloud& cloud = all[k].cloud;
    const auto expectSame = [&](const Cloud& other, const std::string& form) {
      const SideEvidence found = findSideEvidence(storeOf(other), {});
      EXPECT_EQ(found.source, k < scans ? SideSource::kOrigin : SideSource::kNone)
          << all[k].name << " " << form << ": " << spreadAtOrigin(other);
    };
    expectSame(cloud, "as it is");
    expectSame(turnedAbout(cloud, {1, 0, 0}, 1.2), "turned about x");
    expectSame(turnedAbout(cloud, {0, 1, 1}, 2.5), "turned about y + z");
    expectSame(turnedAbout(cloud, {1, -2, 3}, 0.4), "turned aslant");
    expectSame(thinnedTo(cloud, 0.8), "thinned to 80 %");
    expectSame(thinnedTo(cloud, 0.5), "thinned to 50 %");
    expectSame(mapped(cloud,
                      [](Vector3 p) {
                        for (double& x : p) x = 1e-3 * std::round(1e3 * x);
                        return p;
                      }),
               "rounded to mm");
    expectSame(mapped(cloud, [](const Vector3& p) { return scaled(p, 1e-3); }), "in km");
    expectSame(mapped(cloud, [](const Vector3& p) { return scaled(p, 1e3); }), "in mm");
  }
}

}  // namespace
