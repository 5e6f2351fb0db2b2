// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace pcl_slim {

/** \brief What a plane cuts out of one object: polylines in the plane's own coordinates. */
struct SectionOutline {
  std::string name;   ///< of the object, for the legend; UTF-8
  std::string color;  ///< of its lines, as SVG has it: "#1f4fb4"
  std::vector<std::vector<std::array<double, 2>>> lines;  ///< to the right and upwards, world units
};

/** \brief A drawing of outlines that share a plane: to scale, with a scale bar, the names of the
 * objects in their colours, and a title. Outlines are drawn in their order, later ones on top;
 * polylines of fewer than two points are left out. The same text for every run.
 * \param[in] title a line above the drawing; \param[in] unit of length, for the scale bar, or none
 * O(points). */
std::string sectionSvg(const std::vector<SectionOutline>& outlines, const std::string& title,
                       const std::string& unit);

}  // namespace pcl_slim
