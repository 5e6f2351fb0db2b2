// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "pcl_slim/web/page.h"

namespace pcl_slim::detail {

/** \brief Writes a JSON object, member by member. */
class JsonText {
 public:
  void member(const std::string& name, const std::string& json)
  {
    text_ += (text_.empty() ? "" : ",") + quoted(name) + ":" + json;
  }

  std::string object() const { return "{" + text_ + "}"; }

  /** \param[in] digits significant ones; 17 give every double back */
  static std::string number(double value, int digits = 17)
  {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
  }

  static std::string boolean(bool value) { return value ? "true" : "false"; }

  /** \brief A list of numbers from anything that a range-based loop takes. */
  template <typename Numbers>
  static std::string numbers(const Numbers& values, int digits = 17)
  {
    std::string text;
    for (const auto value : values) {
      text += (text.empty() ? "" : ",") + number(static_cast<double>(value), digits);
    }
    return "[" + text + "]";
  }

  /** \brief A string; what could end the page's script is written as its code. */
  static std::string quoted(const std::string& words)
  {
    std::string text = "\"";
    for (const char c : words) {
      if (static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\' || c == '<') {
        char code[8];
        std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
        text += code;
      } else {
        text += c;
      }
    }
    return text + "\"";
  }

 private:
  std::string text_;
};

/** \brief What the viewer takes from the command line and from the C++ renderer's tables. */
JsonText
pageOptions(const Camera& camera, const ShadingParams& shading, const PageParams& params);

/** \brief What is packed into a page, each part deflated. */
struct PageParts {
  std::vector<unsigned char> data;   ///< the model
  std::vector<unsigned char> lines;  ///< packLines()
  std::vector<std::uint8_t> still;   ///< picture as PNG, or empty
};

/** \brief Lines on a grid of 16 bits an axis, deflated. \param[in] origin, scale of the model, in whose
 * local units the viewer works */
Result<std::vector<unsigned char>>
packLines(const std::vector<SpaceLine>& lines, const std::array<double, 3>& origin, double scale);

/** \brief Fills the viewer's text, its script deflated. */
Result<std::string>
fillPage(const std::string& title, JsonText options, const PageParts& parts);

constexpr int kStillSize = 240;  ///< pixels along the longer side of the still picture
constexpr int kRangeSize = 400;  ///< the same of the frame that automatic ranges are taken from

/** \brief The picture that a page shows before, and instead of, its viewer: as PNG, in few colours. */
std::vector<std::uint8_t>
stillPicture(Image image);

/** \brief The same camera for a picture whose longer side is at most `longest` pixels. */
Camera
smallCamera(Camera camera, int longest);

}  // namespace pcl_slim::detail
