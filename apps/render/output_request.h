// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/web/page.h"
#include "render/picture_request.h"

namespace pcl_slim {

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
  int color_error = PageParams().color_error;

  /** \brief Adds -precision and -color_error. */
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
  bool is_surface, is_splats, is_page, trim;
  const PictureRequest& picture;
  const LineRequest& lines;
  const ShadingParams& shading;
};

/** \brief A line for each option that was given and changes nothing. */
std::vector<std::string> idleOptions(const OptionTable& table, const DrawnThing& drawn);

}  // namespace pcl_slim
