// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim::paper {

using Point2 = std::array<double, 2>;

/** \brief A drawing of lines, discs and text; x to the right, y downwards, pixels. */
class Svg {
 public:
  Svg(double width, double height);

  void circle(const Point2& center, double radius, const std::string& style);
  void line(const Point2& a, const Point2& b, const std::string& style);
  void rectangle(const Point2& corner, double width, double height, const std::string& style);
  void polyline(const std::vector<Point2>& points, const std::string& style);
  void polygon(const std::vector<Point2>& points, const std::string& style);
  /** \param[in] anchor start, middle or end */
  void text(const Point2& at, const std::string& anchor, const std::string& words,
            const std::string& style = "");
  Error save(const std::string& path) const;

 private:
  void shape(const char* name, const std::vector<Point2>& points, const std::string& style);

  std::string body_;
};

}  // namespace pcl_slim::paper
