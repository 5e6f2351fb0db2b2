// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/traced_picture.h"

namespace pcl_slim {

/** \brief What a picture shows, as given on the command line. */
struct PictureRequest {
  std::string mode = "auto", range_text = "auto", map = "auto", unit;
  bool lighting = true, bar = false, white = false;
  double occlusion = 0.6;
  int supersampling = 2;
  std::array<double, 2> range{};  ///< of range_text; equal: automatic

  /** \brief Adds the options of the colours. The request must outlive the table's parse(). */
  void declareColors(OptionTable& table);
  /** \brief Adds those of shade, background and smoothness. */
  void declareFinish(OptionTable& table);

  /** \brief Reads range_text. */
  Error parse();

  /** \brief Whether the surface is to be painted with its standard error. */
  bool isUncertainty() const { return mode == "uncertainty"; }

  /** \brief Whether the picture is to be ray-traced. */
  bool isTraced() const { return mode == "raytraced"; }

  /** \brief Parameters for a model with or without colours of its own, once parse() has gone well.
   */
  ShadingParams shadingFor(bool has_colors, int threads) const;
};

/** \brief A ray-traced picture, as given on the command line. */
struct TracedRequest {
  std::string lights_text = "auto";

  /** \brief A light as seen by the viewer: degrees to the right and up, strength, radius in
   * degrees. */
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
