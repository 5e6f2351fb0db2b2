// SPDX-License-Identifier: BSD-3-Clause
#include "measure/lists.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "measure/scenes.h"

namespace pcl_slim::measure {

namespace {

std::vector<std::string>
split(const std::string& list)
{
  std::vector<std::string> parts;
  std::stringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

bool
parseValue(const ListOption& option, const std::string& text, double& value)
{
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) return false;
  if (option.whole && value != std::floor(value)) return false;
  return value >= option.low && value <= option.high;
}

}  // namespace

Error
parseLists(const std::vector<ListOption>& options)
{
  for (const ListOption& option : options) {
    option.values->clear();
    for (const std::string& part : split(*option.text)) {
      double value = 0;
      if (!parseValue(option, part, value)) {
        std::ostringstream message;
        message << "option -" << option.name << " got '" << part << "'; give "
                << (option.whole ? "whole " : "") << "numbers from " << option.low << " to "
                << option.high << ", separated by commas";
        return {ErrorCode::kBadArgument, message.str()};
      }
      option.values->push_back(value);
    }
    if (option.values->empty()) {
      return {ErrorCode::kBadArgument,
              std::string("option -") + option.name + " is empty; give at least one number"};
    }
  }
  return {};
}

Error
parseShapes(const std::string& text, std::vector<std::string>& names)
{
  names = split(text);
  Shape shape;
  for (const std::string& name : names) {
    if (parseShape(name, shape)) continue;
    return {ErrorCode::kBadArgument,
            "unknown shape '" + name + "'; give sphere, torus, bumpy or relief"};
  }
  if (names.empty()) {
    return {ErrorCode::kBadArgument, "no shape is named; give sphere, torus, bumpy or relief"};
  }
  return {};
}

}  // namespace pcl_slim::measure
