// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "comparison/tables.h"

namespace pcl_slim_test {

using pcl_slim::comparison::Errors;
using pcl_slim::comparison::Method;
using pcl_slim::comparison::Scene;
using pcl_slim::comparison::Setting;

inline Errors errorsOf(const Scene& scene, Setting setting) {
  setting.threads = 1;    // tests run beside each other
  setting.judged = true;  // MLS costs by the point
  const auto run = runSetting(scene, setting);
  EXPECT_TRUE(run) << setting.text() << ": " << run.error().message;
  return run ? run->errors : Errors();
}

/** Judges every third point only. */
inline void judgeSome(Scene& scene) {
  scene.judged.resize(scene.size());
  for (std::size_t i = 0; i < scene.size(); ++i) scene.judged[i] = i % 3 == 0;
}

inline Setting slim(bool normals, int degree = 0, double penalty = 0) {
  Setting setting;
  setting.normals = normals;
  setting.degree = degree;
  setting.penalty = penalty;
  return setting;
}

inline Setting sharpSlim() {
  Setting setting;
  setting.normals = setting.sharp = true;
  return setting;
}

inline Setting mls(int order, int neighbours) {
  Setting setting;
  setting.method = Method::kMls;
  setting.degree = order;
  setting.neighbours = neighbours;
  return setting;
}

/** Each error at its own best setting, as one who knows the truth would choose it. */
inline Errors bestOf(const Scene& scene, const std::vector<Setting>& settings) {
  Errors best;
  for (const Setting& setting : settings) {
    const Errors e = errorsOf(scene, setting);
    // fmin passes over what a method does not give.
    best.position = std::fmin(best.position, e.position);
    best.worst = std::fmin(best.worst, e.worst);
    best.normal = std::fmin(best.normal, e.normal);
    best.curvature = std::fmin(best.curvature, e.curvature);
  }
  return best;
}

}  // namespace pcl_slim_test
