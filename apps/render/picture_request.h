// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/render/traced_picture.h"
#include "pcl_slim/web/page.h"

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

/** \brief Lines over a picture, as given on the command line. */
struct LineRequest {
  std::string lines = "none", file;
  double width = LineStyle().width, curvature = PictureLineParams().crest_curvature;
  double slope = PictureLineParams().suggestive_derivative;
  double length = PictureLineParams().min_length;
  bool crest = false, contours = false;  ///< lines of these modes, over the picture
  bool sketch = false;                   ///< nothing but lines, on white

  /** \brief Adds the options. The request must outlive the table's parse(). */
  void declare(OptionTable& table);

  /** \brief Sets itself and the colours for the modes that are lines: over a shaded surface, or
   * alone on white. Other modes change nothing. */
  void applyMode(PictureRequest& colors);

  /** \brief Reads the file of lines, if one is named. */
  Error load();

  /** \brief Whether there is anything to draw. */
  bool any() const { return crest || contours || sketch || lines != "none" || !file.empty(); }

  /** \brief The lines of the file. */
  const std::vector<SpaceLine>& inSpace() const { return in_space_; }

  /** \brief Finds the lines of a view and draws them over its picture.
   * \param[in] rendering as the picture was made; \param[out] count lines drawn */
  Error draw(SurfaceRenderer& renderer, const Camera& camera, RenderParams rendering, Image& image,
             std::size_t& count) const;

  /** \brief Which lines are looked for in a view. */
  PictureLineParams finding(int threads) const;

 private:
  std::vector<SpaceLine> in_space_;
};

/** \brief A page in place of a picture, as given on the command line. */
struct PageRequest {
  double precision = PageParams().precision;

  /** \brief Adds -precision. */
  void declare(OptionTable& table);

  /** \brief Whether an output is a page, by its extension. */
  static bool isPage(const std::string& output);

  /** \brief Names the first option that makes no sense for the output. */
  static Error check(const OptionTable& table, const std::string& output, const std::string& mode);

  /** \brief What the page is called: the input's name without folder and extension. */
  static std::string titleOf(const std::string& input);
};

/** \brief What decides which options of a picture or page have an effect. */
struct DrawnThing {
  bool is_splats, is_page, trim;
  const PictureRequest& picture;
  const LineRequest& lines;
  const ShadingParams& shading;
};

/** \brief A line for each option that was given and changes nothing. */
std::vector<std::string>
idleOptions(const OptionTable& table, const DrawnThing& drawn);

}  // namespace pcl_slim
