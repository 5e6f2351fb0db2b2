// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

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

}  // namespace pcl_slim::detail
