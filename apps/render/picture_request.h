// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "common/options.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim {

/** \brief What a picture shows, as given on the command line. */
struct PictureRequest {
  std::string mode = "auto", range_text = "auto", map = "auto", unit, lighting = "auto";
  bool bar = false, white = false;
  double occlusion = 0.6;
  int supersampling = 2;
  std::array<double, 2> range{};  ///< of range_text; equal: automatic

  /** \brief Adds the options of the colours. The request must outlive the table's parse(). */
  void declareColors(OptionTable& table);
  /** \brief Adds those of shade, background and smoothness. */
  void declareFinish(OptionTable& table);

  /** \brief Reads range_text. */
  Error parse();

  /** \brief Whether the picture is to be ray-traced. */
  bool isTraced() const { return mode == "raytraced"; }

  /** \brief Parameters for a model with or without colours of its own, once parse() has gone well. */
  ShadingParams shadingFor(bool has_colors, int threads) const;
};

}  // namespace pcl_slim
