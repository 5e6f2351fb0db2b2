// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/sensor_rows.h"

namespace pcl_slim::measure {

namespace {

const std::vector<double> kCameraRadii = {0.03, 0.06, 0.12, 0.2};
const std::vector<double> kWaveRadii = {0.01, 0.02, 0.03, 0.06};

SensorRow byCamera(const std::string& solids, const std::string& how, const DepthCamera& camera) {
  const bool waves = solids.rfind("wave", 0) == 0;
  return {solids + ", " + how,
          [=](std::uint64_t seed) { return scanByCamera(namedSolids(solids), camera, seed); },
          waves ? kWaveRadii : kCameraRadii};
}

/** The same image by other sensors. */
struct NamedCamera {
  const char* name;
  DepthCamera camera;
};

DepthCamera camera(double sigma, int box_x, int box_y, double step) {
  DepthCamera camera;
  camera.sigma = sigma;
  camera.correlated_x = box_x;
  camera.correlated_y = box_y;
  camera.step = step;
  return camera;
}

DepthCamera vga(DepthCamera camera) {
  camera.width = 640;
  camera.height = 480;
  camera.focal = 585;
  return camera;
}

DepthCamera stereo(int box) {
  DepthCamera made = camera(0.1, box, box, 0);
  made.focal = made.disparity_focal = 400;
  made.baseline = 0.1;
  return made;
}

DepthCamera depthSteps() {
  DepthCamera made = camera(0, 1, 1, 0);
  made.depth_step = 0.005;
  return made;
}

std::vector<NamedCamera> cameras() {
  return {{"white", camera(0.06, 1, 1, 0)},
          {"3 px + 1/8 px", camera(0.06, 3, 3, 0.125)},
          {"1/8 px", camera(0, 1, 1, 0.125)},
          {"2 px", camera(0.06, 2, 2, 0)},
          {"5 px", camera(0.06, 5, 5, 0)},
          {"9 px", camera(0.06, 9, 9, 0)},
          {"5 px + 1/8 px", camera(0.06, 5, 5, 0.125)},
          {"9 px + 1/8 px", camera(0.06, 9, 9, 0.125)},
          {".2 px, 3 px + 1/8 px", camera(0.2, 3, 3, 0.125)},
          {"rows 5 x 1 px", camera(0.06, 5, 1, 0)},
          {"640 x 480, 5 px + 1/8 px", vga(camera(0.06, 5, 5, 0.125))},
          {"stereo 3 px", stereo(3)},
          {"stereo 7 px", stereo(7)},
          {"5 mm steps", depthSteps()}};
}

void addBaselines(std::vector<SensorRow>& rows) {
  for (double baseline : {0.05, 0.15}) {
    for (const char* solids : {"room", "balls"}) {
      DepthCamera made = camera(0.06, 3, 3, 0.125);
      made.baseline = baseline;
      const std::string how = baseline < 0.1 ? "50 mm, 3 px + 1/8 px" : "150 mm, 3 px + 1/8 px";
      rows.push_back(byCamera(solids, how, made));
    }
  }
}

/** Lidars of fewer rings, further apart. */
void addLidars(std::vector<SensorRow>& rows) {
  struct Rings {
    int count;
    double lowest, highest;  // elevation [degrees]
    int steps;
  };
  constexpr Rings kRings[] = {{64, -25, 5, 1800},  {128, -22, 22, 1024}, {40, -16, 7, 1800},
                              {32, -30, 10, 1800}, {32, -16, 15, 1080},  {24, -25, 3, 1200},
                              {16, -15, 15, 1800}, {16, -15, 15, 900}};
  for (const Rings& rings : kRings) {
    for (double sigma : {0.01, 0.03}) {
      TurningLidar lidar;
      lidar.rings = rings.count;
      lidar.lowest = rings.lowest;
      lidar.highest = rings.highest;
      lidar.steps = rings.steps;
      lidar.sigma = sigma;
      const std::string how = std::to_string(rings.count) + " x " + std::to_string(rings.steps) +
                              (sigma < 0.02 ? ", 1 cm" : ", 3 cm");
      rows.push_back(
          {"street, lidar " + how,
           [=](std::uint64_t seed) { return scanByLidar(namedSolids("street"), lidar, seed); },
           {0.25, 0.5, 1.0, 2.0}});
    }
  }
}

void addOthers(std::vector<SensorRow>& rows) {
  DepthCamera mixed = camera(0.06, 3, 3, 0.125);
  mixed.mixed = 0.5;
  rows.push_back(byCamera("balls", "mixed pixels, 3 px + 1/8 px", mixed));
  rows.push_back({"street, lidar",
                  [](std::uint64_t seed) { return scanByLidar(namedSolids("street"), {}, seed); },
                  {0.25, 0.5, 1.0}});
  for (double shift : {0.0, 0.0003, 0.0006}) {
    LayeredScan layers;
    layers.shift = shift;
    const std::string how = shift > 0.0004 ? ".6 mm" : shift > 0 ? ".3 mm" : "0";
    rows.push_back(
        {"figure, layers off by " + how,
         [=](std::uint64_t seed) { return scanInLayers(namedSolids("figure"), layers, seed); },
         {0.005, 0.01, 0.02}});
  }
}

}  // namespace

std::vector<SensorRow> sensorRows(const std::string& part) {
  std::vector<SensorRow> rows;
  for (const char* solids :
       {"room", "hall", "frontal hall", "balls", "wave40", "wave15", "wave6"}) {
    for (const NamedCamera& named : cameras())
      rows.push_back(byCamera(solids, named.name, named.camera));
  }
  addBaselines(rows);
  addOthers(rows);
  addLidars(rows);
  std::vector<SensorRow> chosen;
  for (const SensorRow& row : rows) {
    if (row.name.find(part) != std::string::npos) chosen.push_back(row);
  }
  return chosen;
}

}  // namespace pcl_slim::measure
