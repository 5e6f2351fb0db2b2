// SPDX-License-Identifier: BSD-3-Clause
#include "paper/svg.h"

#include "paper/study.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim::paper {

namespace {

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + number("%.2f", value) + "\"";
}

}  // namespace

Svg::Svg(double width, double height)
    : body_("<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", width) +
            attribute("height", height) +
            " font-family=\"DejaVu Sans, sans-serif\" font-size=\"13\">\n"
            "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n") {}

void Svg::circle(const Point2& center, double radius, const std::string& style) {
  body_ += "<circle" + attribute("cx", center[0]) + attribute("cy", center[1]) +
           attribute("r", radius) + " " + style + "/>\n";
}

void Svg::line(const Point2& a, const Point2& b, const std::string& style) {
  body_ += "<line" + attribute("x1", a[0]) + attribute("y1", a[1]) + attribute("x2", b[0]) +
           attribute("y2", b[1]) + " " + style + "/>\n";
}

void Svg::rectangle(const Point2& corner, double width, double height, const std::string& style) {
  body_ += "<rect" + attribute("x", corner[0]) + attribute("y", corner[1]) +
           attribute("width", width) + attribute("height", height) + " " + style + "/>\n";
}

void Svg::shape(const char* name, const std::vector<Point2>& points, const std::string& style) {
  body_ += std::string("<") + name + " " + style + " points=\"";
  for (const Point2& p : points) body_ += number("%.2f,", p[0]) + number("%.2f ", p[1]);
  body_ += "\"/>\n";
}

void Svg::polyline(const std::vector<Point2>& points, const std::string& style) {
  shape("polyline", points, "fill=\"none\" " + style);
}

void Svg::polygon(const std::vector<Point2>& points, const std::string& style) {
  shape("polygon", points, style);
}

void Svg::text(const Point2& at, const std::string& anchor, const std::string& words,
               const std::string& style) {
  body_ += "<text" + attribute("x", at[0]) + attribute("y", at[1]) + " text-anchor=\"" + anchor +
           "\" " + style + ">" + words + "</text>\n";
}

Error Svg::save(const std::string& path) const {
  const std::string text = body_ + "</svg>\n";
  return writeFile(path, text.data(), text.size());
}

}  // namespace pcl_slim::paper
