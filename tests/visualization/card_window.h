// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "visualization/test_window.h"

namespace pcl_slim::test {

/** \brief A window in which both back ends draw one surface. */
class CardTest : public WindowTest {
 protected:
  CardTest() {
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(0.6, 0.6, 0.6);
    renderer->AddActor(actor);
  }

  /** \brief A picture by one of the two, which must be who draws it. */
  Image pictureBy(RayBackend backend) {
    mapper->setBackend(backend);
    const Image image = picture();
    EXPECT_EQ(mapper->getStatistics().on_card, backend == RayBackend::kOpenGL);
    EXPECT_FALSE(mapper->getError()) << mapper->getError().message;
    return image;
  }

  /** \brief Share of pixels that the two draw differently by more than 2 of 255. */
  double difference() {
    const Image cpu = pictureBy(RayBackend::kCPU);
    EXPECT_GT(shareDrawn(cpu), 0.05);
    return shareDifferent(cpu, pictureBy(RayBackend::kOpenGL), 2);
  }

  // Rays at a silhouette or on the border between two leaves fall to either side by rounding.
  static constexpr double kFewPixels = 12.0 / (160 * 120);
};

}  // namespace pcl_slim::test
