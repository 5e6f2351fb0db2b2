// SPDX-License-Identifier: BSD-3-Clause
// The rasteriser's kernels on every set of instructions that this processor has.
#include <gtest/gtest.h>

#include <cmath>

#include "support/instruction_sets.h"
#include "unit/render/sphere_view.h"
#include "unit/render/tracer/traced_scenes.h"

namespace pcl_slim {
namespace {

using namespace test;

/** \brief A wall that faces the camera, and one through it seen along its plane: its rays meet the
 * plane of the second nowhere but in the camera itself, where a perspective map has no depth. */
SLIMSurface wallsThroughTheCamera(int degree) {
  SLIMSurface surface = emptySurface(degree);
  addRectangle(surface, {-0.25, -0.25, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.5, 0.0}, {0.0, 0.0, 1.0},
               0.03125, 0.0625);
  addRectangle(surface, {-0.25, 0.0, -0.25}, {0.5, 0.0, 0.0}, {0.0, 0.0, 0.5}, {0.0, 1.0, 0.0},
               0.03125, 0.0625);
  return surface;
}

class InstructionSets : public testing::TestWithParam<int> {};

TEST_P(InstructionSets, PicturesAgreeWithTheReference) {
  const SLIMSurface surface = wallsThroughTheCamera(GetParam());
  Camera camera = frontCamera();
  camera.position = {0.0, 0.0, 1.0};
  for (const VisibleSides sides : {VisibleSides::kFront, VisibleSides::kBoth}) {
    RenderParams params;
    params.sides = sides;
    params.threads = 1;
    const GBuffer exact = referenceFrame(surface, camera, params);
    pcl_slim_test::forEachInstructionSet([&](const char* name) {
      const GBuffer buffer = rendered(surface, camera, params);
      std::size_t numbers = 0, agree = 0;
      for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
        numbers += !std::isnan(buffer.depth[i]) && !std::isnan(buffer.normal[i][0]);
        agree += buffer.covered(i) == exact.covered(i) &&
                 (!exact.covered(i) || std::abs(buffer.depth[i] - exact.depth[i]) < 1e-3f);
      }
      EXPECT_GT(exact.numCovered(), 1000u);
      EXPECT_EQ(numbers, buffer.numPixels()) << name;
      EXPECT_GE(agree, buffer.numPixels() * 99 / 100) << name;
    });
  }
}

// So far away that the square of its depth is no float.
TEST_P(InstructionSets, WhatIsTooFarToBeSeenLeavesAnEmptyPicture) {
  SLIMSurface surface = wallsThroughTheCamera(GetParam());
  surface.info.scale = 1e-38;
  Camera camera = frontCamera();
  camera.position = {0.3, -0.4, 1.0};
  pcl_slim_test::forEachInstructionSet(
      [&](const char* name) { EXPECT_EQ(rendered(surface, camera).numCovered(), 0u) << name; });
}

INSTANTIATE_TEST_SUITE_P(Degrees, InstructionSets, testing::Values(1, 2, 3, 4));

}  // namespace
}  // namespace pcl_slim
