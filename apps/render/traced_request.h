// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/traced_picture.h"

namespace pcl_slim {

/** \brief A ray-traced picture, as given on the command line. */
struct TracedRequest {
  std::string lights_text = "auto";

  /** \brief A light as seen by the viewer: degrees to the right and up, strength, radius in degrees. */
  struct Light {
    double azimuth = 0.0, elevation = 0.0, strength = 0.0, spread = 0.0;
  };
  std::vector<Light> lights;  ///< of lights_text; none: the default ones

  /** \brief Adds -lights. The request must outlive the table's parse(). */
  void declare(OptionTable& table);

  /** \brief Reads lights_text. */
  Error parse();

  /** \brief The lights of a camera, once parse() has gone well. */
  std::vector<RayLight> lightsFor(const Camera& camera) const;
};

}  // namespace pcl_slim
