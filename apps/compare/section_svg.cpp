// SPDX-License-Identifier: BSD-3-Clause
// Outlines in a plane as an SVG drawing.
#include "compare/section_svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/options.h"

namespace pcl_slim {
namespace {

constexpr double kLongSide = 900;                       ///< of the outlines' box [pixels]
constexpr double kMargin = 30, kHead = 70, kFoot = 60;  ///< around it [pixels]
constexpr double kLeastWidth = 460;                     ///< so that texts have room [pixels]
constexpr double kBarShare = 0.25;  ///< of the box's width: the scale bar at most

struct Frame {
  std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};

  explicit Frame(const std::vector<SectionOutline>& outlines) {
    for (const SectionOutline& outline : outlines) {
      for (const auto& line : outline.lines) {
        for (const auto& p : line) add(p);
      }
    }
    if (!(low[0] <= high[0])) low = high = {0.0, 0.0};
  }

  void add(const std::array<double, 2>& p) {
    for (std::size_t a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  double width() const { return high[0] - low[0]; }
  double height() const { return high[1] - low[1]; }
  double side() const { return std::max({width(), height(), 1e-300}); }
};

/** The largest of 1, 2 and 5 times a power of ten that is not above a length. */
double roundLength(double most) {
  const double decade = std::pow(10.0, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= most) return step * decade;
  }
  return decade;
}

std::string xmlText(const std::string& words) {
  std::string text;
  for (const char c : printable(words)) {
    text += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return text;
}

std::string pixels(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string textAt(double x, double y, const std::string& words, const std::string& more = "") {
  return "<text x=\"" + pixels(x) + "\" y=\"" + pixels(y) + "\"" + more + ">" + xmlText(words) +
         "</text>\n";
}

std::string segment(double x0, double x1, double y, const std::string& color, double width) {
  return "<path d=\"M" + pixels(x0) + " " + pixels(y) + "H" + pixels(x1) + "\" stroke=\"" + color +
         "\" stroke-width=\"" + pixels(width) + "\"/>\n";
}

/** A bar of a round length with its number. */
std::string scaleBar(double pixels_per_unit, double x, double y, double room,
                     const std::string& unit) {
  const double length = roundLength(room / pixels_per_unit);
  const double end = x + length * pixels_per_unit;
  std::string text = segment(x, end, y, "#222", 2);
  for (const double at : {x, end}) {
    text += "<path d=\"M" + pixels(at) + " " + pixels(y - 5) + "V" + pixels(y + 5) +
            "\" stroke=\"#222\" stroke-width=\"2\"/>\n";
  }
  const std::string words = numberText(length) + (unit.empty() ? "" : " " + unit);
  return text + textAt(0.5 * (x + end), y + 22, words, " text-anchor=\"middle\"");
}

}  // namespace

std::string sectionSvg(const std::vector<SectionOutline>& outlines, const std::string& title,
                       const std::string& unit) {
  const Frame frame(outlines);
  const double scale = kLongSide / frame.side();
  const double box_width = scale * frame.width(), box_height = scale * frame.height();
  const double width = std::max(kLeastWidth, box_width + 2 * kMargin);
  const double height = kHead + box_height + kFoot + kMargin;
  const double left = 0.5 * (width - box_width), bottom = kHead + kMargin / 2 + box_height;

  const std::string size = pixels(width) + "\" height=\"" + pixels(height);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size +
                    "\" viewBox=\"0 0 " + pixels(width) + " " + pixels(height) +
                    "\" fill=\"none\" font-family=\"sans-serif\" font-size=\"14\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<g fill=\"#222\">\n" +
                    textAt(kMargin, 28, title);
  double y = 52;
  double x = kMargin;
  const double step =
      (width - 2 * kMargin) / static_cast<double>(std::max<std::size_t>(outlines.size(), 1));
  for (const SectionOutline& outline : outlines) {
    svg += segment(x, x + 26, y - 5, outline.color, 2.5) + textAt(x + 34, y, outline.name);
    x += step;
  }
  y = height - kMargin - 10;
  const double room = std::max(kBarShare * box_width, 60.0);
  svg += scaleBar(scale, kMargin, y, room, unit) + "</g>\n";
  for (const SectionOutline& outline : outlines) {
    svg += "<g stroke=\"" + outline.color + "\" stroke-width=\"1.2\" stroke-linejoin=\"round\">\n";
    for (const auto& line : outline.lines) {
      if (line.size() < 2) continue;
      std::string path;
      for (const auto& p : line) {
        path += (path.empty() ? "M" : "L") + pixels(left + scale * (p[0] - frame.low[0])) + " " +
                pixels(bottom - scale * (p[1] - frame.low[1]));
      }
      svg += "<path d=\"" + path + "\"/>\n";
    }
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace pcl_slim
