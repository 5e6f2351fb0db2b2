// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "paper/study.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim::paper {

namespace {

constexpr double kWidth = 300, kHeight = 240, kLeft = 62, kTop = 26, kBottom = 44, kGap = 22;

/** Powers of ten that enclose all values of an axis. */
struct Axis {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();

  void take(double value) {
    if (!(value > 0)) return;
    low = std::min(low, std::log10(value));
    high = std::max(high, std::log10(value));
  }
  void pad() {
    const double margin = std::max(0.05, 0.05 * (high - low));
    low -= margin;
    high += margin;
  }
  double share(double value) const { return (std::log10(value) - low) / (high - low); }
};

std::string textAt(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + number("%.1f", x) + "\" y=\"" + number("%.1f", y) + "\" text-anchor=\"" +
         anchor + "\">" + text + "</text>\n";
}

std::string lineBetween(double x1, double y1, double x2, double y2, const std::string& color) {
  return "<line x1=\"" + number("%.1f", x1) + "\" y1=\"" + number("%.1f", y1) + "\" x2=\"" +
         number("%.1f", x2) + "\" y2=\"" + number("%.1f", y2) + "\" stroke=\"" + color + "\"/>\n";
}

/** Lines and labels at 1, 2 and 5 times the powers of ten. */
std::string grid(const Axis& axis, bool horizontal, double left) {
  std::string made;
  for (double power = std::floor(axis.low); power <= axis.high; ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = digit * std::pow(10, power), share = axis.share(value);
      if (share < 0 || share > 1 || (axis.high - axis.low > 1.5 && digit != 1.0)) continue;
      const std::string label = number("%g", value);
      if (horizontal) {
        const double x = left + share * kWidth;
        made += lineBetween(x, kTop, x, kTop + kHeight, "#ddd");
        made += textAt(x, kTop + kHeight + 14, "middle", label);
      } else {
        const double y = kTop + (1 - share) * kHeight;
        made += lineBetween(left, y, left + kWidth, y, "#ddd");
        made += textAt(left - 4, y + 4, "end", label);
      }
    }
  }
  return made;
}

std::string curveText(const Curve& curve, const Axis& x, const Axis& y, double left) {
  if (curve.x.size() == 1) {
    return "<circle r=\"4\" fill=\"" + curve.color + "\" cx=\"" +
           number("%.1f\" cy=\"", left + x.share(curve.x[0]) * kWidth) +
           number("%.1f\"/>\n", kTop + (1 - y.share(curve.y[0])) * kHeight);
  }
  std::string points;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!(curve.y[i] > 0)) continue;
    points += number("%.1f,", left + x.share(curve.x[i]) * kWidth) +
              number("%.1f ", kTop + (1 - y.share(curve.y[i])) * kHeight);
  }
  return "<polyline fill=\"none\" stroke-width=\"1.8\" stroke=\"" + curve.color + "\" points=\"" +
         points + "\"/>\n";
}

}  // namespace

Error savePlot(const std::string& path, const std::vector<std::string>& titles,
               const std::vector<std::vector<Curve>>& panels, const std::string& x_label,
               const std::string& y_label) {
  Axis x, y;
  for (const auto& panel : panels) {
    for (const Curve& curve : panel) {
      for (const double value : curve.x) x.take(value);
      for (const double value : curve.y) y.take(value);
    }
  }
  x.pad();
  y.pad();
  const double step = kLeft + kWidth + kGap, width = step * static_cast<double>(panels.size());
  const double height = kTop + kHeight + kBottom;
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number("%.0f", width) +
                     "\" height=\"" + number("%.0f", height) +
                     "\" font-family=\"sans-serif\" font-size=\"11\">\n"
                     "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double left = kLeft + static_cast<double>(i) * step;
    text += grid(x, true, left) + grid(y, false, left);
    text += textAt(left + kWidth / 2, kTop - 9, "middle", titles[i]);
    text += textAt(left + kWidth / 2, height - 10, "middle", x_label);
    double at = kTop + 14;
    for (const Curve& curve : panels[i]) {
      text += curveText(curve, x, y, left);
      const bool rising = curve.y.back() > curve.y.front();  // the other corner is free
      text += "<g fill=\"" + curve.color + "\">" +
              textAt(left + (rising ? 6 : kWidth - 6), at, rising ? "start" : "end", curve.label) +
              "</g>\n";
      at += curve.label.empty() ? 0 : 14;
    }
  }
  text += textAt(4, kTop - 9, "start", y_label) + "</svg>\n";
  return writeFile(path, text.data(), text.size());
}

}  // namespace pcl_slim::paper
