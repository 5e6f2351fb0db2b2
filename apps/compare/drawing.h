// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/program.h"
#include "compare/measurement.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/render/deviation_legend.h"
#include "pcl_slim/surface/surface.h"
#include "render/view_request.h"

namespace pcl_slim {

/** \brief A picture and a page of deviations, as given on the command line. */
struct DrawingRequest {
  std::string picture, page;  ///< files, or none
  std::string unit;           ///< of length, or none
  double range = 0.0;         ///< of the colours [world units]; 0: chosen
  bool white = false;
  int supersampling = 2;
  ViewRequest view;

  /** \brief Adds the options. The request must outlive the table's parse(). */
  void declare(OptionTable& table);
  /** \brief Checks what needs no object. */
  Error parse();
  bool any() const { return !picture.empty() || !page.empty(); }
};

/** \brief The measured object in the colours of its deviations. A surface is painted, a mesh has
 * them on its vertices. */
class DeviationDrawing {
 public:
  DeviationDrawing(const DrawingRequest& request, const Comparison& comparison, double level,
                   int threads);

  /** \brief Gives the object its colours; prints how long it took. */
  Error prepare(Console& console, Report& report);
  /** \brief Draws the picture, where one is wanted, and writes it. */
  Error drawPicture(Console& console, Report& report) const;
  /** \brief Writes the page, where one is wanted. \param[in] title of the page */
  Error writePage(const std::string& title, Console& console, Report& report) const;

 private:
  ChosenView viewFor(double right_margin) const;

  const DrawingRequest& request_;
  const Comparison& comparison_;
  int threads_;
  DeviationScale scale_;
  std::vector<std::array<std::uint8_t, 3>> colors_;  ///< of the places
  SLIMSurface surface_;                              ///< painted, unless the object is a mesh
  TriangleMesh mesh_;
};

}  // namespace pcl_slim
