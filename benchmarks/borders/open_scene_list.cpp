// SPDX-License-Identifier: BSD-3-Clause
// The scenes of known borders, by name.
#include <cmath>

#include "borders/lists.h"
#include "borders/open_scenes.h"

namespace pcl_slim::borders {
namespace {

Hole disc(double u, double v, double diameter) {
  Hole hole;
  hole.centre = {u, v};
  hole.half = {0.5 * diameter, 0.5 * diameter};
  return hole;
}

Hole rectangle(const Flat& low, const Flat& high) {
  Hole hole;
  hole.round = false;
  hole.centre = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
  hole.half = {0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])};
  return hole;
}

/** \brief From the lower border up. */
Hole door(double left, double width, double height) {
  Hole hole = rectangle({left, 0.0}, {left + width, height});
  hole.notch = true;
  return hole;
}

Sheet box(ChartPointer chart, const Flat& low, const Flat& high) {
  Sheet sheet;
  sheet.chart = std::move(chart);
  sheet.low = low;
  sheet.high = high;
  return sheet;
}

/** \brief A square plate with n x n holes, one every pitch. */
Sheet plate(const ChartPointer& chart, int n, double diameter, double pitch) {
  const double side = pitch * std::max(n, 1);
  Sheet sheet = box(chart, {-0.5 * side, -0.5 * side}, {0.5 * side, 0.5 * side});
  for (int i = 0; i < n * n; ++i) {
    sheet.holes.push_back(
        disc(sheet.low[0] + pitch * (0.5 + i % n), sheet.low[1] + pitch * (0.5 + i / n), diameter));
  }
  return sheet;
}

Sheet polygon(ChartPointer chart, const std::vector<Flat>& corners) {
  Sheet sheet = box(std::move(chart), corners[0], corners[0]);
  for (const Flat& c : corners) {
    for (std::size_t a = 0; a < 2; ++a) {
      sheet.low[a] = std::min(sheet.low[a], c[a]);
      sheet.high[a] = std::max(sheet.high[a], c[a]);
    }
  }
  sheet.outline = corners;
  return sheet;
}

/** \brief All around a chart that closes. */
Sheet band(const ChartPointer& chart, double low, double high) {
  return box(chart, {0.0, low}, {chart->period(), high});
}

class List {
 public:
  OpenScene& add(const std::string& name, const std::vector<Sheet>& sheets) {
    scenes.emplace_back();
    scenes.back().name = name;
    scenes.back().sheets = sheets;
    return scenes.back();
  }

  /** \brief Plates of one kind; n holes a side of a diameter, one every pitch. */
  void addPlates(const std::string& kind, const ChartPointer& chart,
                 const std::vector<std::array<int, 3>>& sizes) {
    for (const auto& [n, diameter, pitch] : sizes) {
      add(kind + "-" + std::to_string(n * n) + "x" + std::to_string(diameter),
          {plate(chart, n, diameter, pitch)});
    }
  }

  std::vector<OpenScene> scenes;
};

void addPlates(List& list) {
  const std::array<int, 3> solid{0, 0, 150}, small{20, 4, 8}, least{12, 6, 12}, sieve{12, 8, 16},
      twelve{6, 12, 24}, twenty{4, 20, 40}, forty{2, 40, 80}, sixty{1, 60, 150};
  list.addPlates("flat", planeChart(), {solid, small, least, sieve, twelve, twenty, forty, sixty});
  list.addPlates("wavy", wavyChart(), {solid, least, sieve, sixty});
  list.addPlates("bent", cylinderChart(62.0), {solid, least, sieve, sixty});
  list.add("turned-0x0", {plate(planeChart(), 0, 0, 150)}).turned = 0.7;
  list.add("turned-144x8", {plate(planeChart(), 12, 8, 16)}).turned = 0.7;
  list.add("turned2-144x8", {plate(planeChart(), 12, 8, 16)}).turned = 1.9;
  list.add("turned2-36x12", {plate(planeChart(), 6, 12, 24)}).turned = 1.9;
  list.add("grid-0x0", {plate(planeChart(), 0, 0, 150)}).sampling = Sampling::kJittered;
  list.add("grid-144x8", {plate(planeChart(), 12, 8, 16)}).sampling = Sampling::kJittered;
}

void addSlabs(List& list) {
  const std::vector<Flat> l{{0, 0}, {160, 0}, {160, 50}, {60, 50}, {60, 140}, {0, 140}};
  const std::vector<Flat> t{{0, 90},   {50, 90},  {50, 0},    {110, 0},
                            {110, 90}, {160, 90}, {160, 140}, {0, 140}};
  const std::vector<Flat> u{{0, 0},    {160, 0}, {160, 140}, {110, 140},
                            {110, 45}, {50, 45}, {50, 140},  {0, 140}};
  list.add("slab-L", {polygon(planeChart(), l)});
  list.add("slab-T", {polygon(planeChart(), t)});
  list.add("slab-U", {polygon(planeChart(), u)});
  list.add("slab2-L", {polygon(planeChart(), l), polygon(planeChart(-8.0, -1.0), l)});
  list.add("slab2-U", {polygon(planeChart(), u), polygon(planeChart(-8.0, -1.0), u)});
  Sheet shaft = box(planeChart(), {0, 0}, {250, 187});
  shaft.holes = {rectangle({60, 80}, {85, 105})};
  list.add("slab-shaft", {shaft});
  list.add("slab-shaft-turned", {shaft}).turned = 0.7;
}

void addWalls(List& list) {
  Sheet wall = box(planeChart(), {0, 0}, {220, 60});
  wall.holes = {door(20, 20, 42), door(150, 36, 48), rectangle({60, 18}, {90, 46}),
                rectangle({104, 22}, {128, 46}), rectangle({196, 34}, {206, 46})};
  list.add("wall", {wall});
  Sheet room = band(roomChart(90, 60), 0.0, 55.0);
  room.holes = {door(20, 18, 40),
                rectangle({50, 20}, {76, 44}),
                rectangle({105, 20}, {135, 44}),
                rectangle({170, 24}, {182, 40}),
                rectangle({200, 20}, {226, 44}),
                door(262, 16, 40)};
  list.add("room", {room});
  list.add("wedge-90", {box(wedgeChart(0.5 * M_PI), {0, -70}, {140, 70})});
  list.add("wedge-60", {box(wedgeChart(M_PI / 3.0), {0, -70}, {140, 70})});
}

void addTubes(List& list) {
  list.add("pipe", {band(cylinderChart(20.0), 0.0, 160.0)});
  list.add("pipe-thin", {band(cylinderChart(6.0), 0.0, 200.0)});
  list.add("elbow", {band(elbowChart(16.0, 90.0), -80.0, 80.0)});
  Sheet holed = band(cylinderChart(32.0), 0.0, 120.0);
  for (int i = 0; i < 40; ++i) {
    holed.holes.push_back(disc((0.5 + i % 8) * holed.high[0] / 8.0, 12.0 + 24.0 * (i / 8), 8.0));
  }
  list.add("pipe-40x8", {holed});
  // 30 m, radius 2.5, a point every .08.
  const Sheet tunnel = band(cylinderChart(31.0, -1.0), 0.0, 375.0);
  list.add("tunnel", {tunnel}).turned = 0.7;
  list.add("tunnel-moving", {tunnel}).sampling = Sampling::kMoving;
  list.add("tunnel-profiles", {tunnel}).sampling = Sampling::kProfiles;
  list.add("branch", {band(cylinderChart(2.7), 0.0, 180.0)});
  Sheet sphere = band(sphereChart(42.0), -21.0 * M_PI, 21.0 * M_PI);
  sphere.whole = true;
  constexpr int kHoles = 32;
  for (int i = 0; i < kHoles; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kHoles, turn = 2.399963 * i;
    Hole hole = disc(42.0 * std::remainder(turn, 2.0 * M_PI), 42.0 * std::asin(z), 6.0 + i % 4 * 3);
    hole.cap = true;
    sphere.holes.push_back(hole);
  }
  list.add("sphere-32", {sphere});
}

}  // namespace

std::vector<OpenScene> openScenes(const std::string& words) {
  List list;
  addPlates(list);
  addSlabs(list);
  addWalls(list);
  addTubes(list);
  if (words == "all") return list.scenes;
  std::vector<OpenScene> chosen;
  for (const std::string& word : wordsOf(words)) {
    const std::size_t before = chosen.size();
    for (const OpenScene& scene : list.scenes) {
      if (scene.name.compare(0, word.size(), word) == 0) chosen.push_back(scene);
    }
    if (chosen.size() == before) return {};
  }
  return chosen;
}

}  // namespace pcl_slim::borders
