// SPDX-License-Identifier: BSD-3-Clause
// A hand of capsules that run smoothly into each other.
#include <algorithm>
#include <cmath>
#include <random>

#include "paper/study.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim::paper {

namespace {

struct Capsule {
  Vector3 a, b;
  double from, to;  ///< radii at the ends
};

const std::vector<Capsule>& bones() {
  static const std::vector<Capsule> kBones = {
      {{0.0, -0.35, 0.0}, {0.0, 0.15, 0.0}, 0.17, 0.2},       // wrist and palm
      {{-0.16, -0.1, 0.0}, {-0.17, 0.25, 0.02}, 0.13, 0.11},  // edge of the hand
      {{0.14, -0.1, 0.0}, {0.16, 0.28, 0.02}, 0.13, 0.11},
      {{0.19, 0.3, 0.02}, {0.28, 0.72, 0.06}, 0.085, 0.065},  // fingers
      {{0.06, 0.33, 0.02}, {0.09, 0.84, 0.08}, 0.09, 0.068},
      {{-0.07, 0.32, 0.02}, {-0.1, 0.78, 0.07}, 0.085, 0.065},
      {{-0.19, 0.28, 0.02}, {-0.27, 0.6, 0.05}, 0.072, 0.055},
      {{0.2, -0.05, 0.03}, {0.45, 0.28, 0.14}, 0.1, 0.07},  // thumb
  };
  return kBones;
}

double distanceTo(const Capsule& capsule, const Vector3& p) {
  const Vector3 axis = subtract(capsule.b, capsule.a), from = subtract(p, capsule.a);
  const double t = std::clamp(dot(from, axis) / dot(axis, axis), 0.0, 1.0);
  return length(along(from, -t, axis)) - (capsule.from + t * (capsule.to - capsule.from));
}

/** Negative inside; a soft minimum, so that fingers grow out of the palm. */
double handFunction(const Vector3& p) {
  constexpr double kSoftness = 0.025;
  double sum = 0;
  for (const Capsule& bone : bones()) sum += std::exp(-distanceTo(bone, p) / kSoftness);
  return -kSoftness * std::log(sum);
}

Vector3 gradientAt(const Vector3& p) {
  constexpr double kStep = 1e-5;
  Vector3 g{};
  for (std::size_t a = 0; a < 3; ++a) {
    Vector3 low = p, high = p;
    low[a] -= kStep;
    high[a] += kStep;
    g[a] = (handFunction(high) - handFunction(low)) / (2 * kStep);
  }
  return g;
}

}  // namespace

Model handModel(std::size_t count) {
  Model model;
  model.name = "hand-like";
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> x(-0.4, 0.6), y(-0.6, 1.0), z(-0.25, 0.3);
  // Places in a thin shell are spread over the surface evenly; steps of Newton bring them onto it.
  constexpr double kShell = 0.01;
  while (model.points.size() < count) {
    Vector3 p = {x(random), y(random), z(random)};
    if (std::abs(handFunction(p)) > kShell) continue;
    for (int i = 0; i < 4; ++i) {
      const Vector3 g = gradientAt(p);
      p = along(p, -handFunction(p) / dot(g, g), g);
    }
    const Vector3 n = normalized(gradientAt(p));
    model.points.push_back(p);
    for (const double value : n) model.normals.push_back(static_cast<float>(value));
  }
  return model;
}

Error savePoints(const Model& model, const std::string& path) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(model.points.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    text += std::string("\nproperty float ") + name;
  text += "\nend_header\n";
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    std::array<float, 6> row{};
    for (std::size_t a = 0; a < 3; ++a) {
      row[a] = static_cast<float>(model.points[i][a]);
      row[3 + a] = model.normals[3 * i + a];
    }
    text.append(reinterpret_cast<const char*>(row.data()), sizeof(row));
  }
  return writeFile(path, text.data(), text.size());
}

Error saveHand(const StudySettings& settings) {
  return savePoints(handModel(100000), settings.out + "/hand.ply");
}

}  // namespace pcl_slim::paper
