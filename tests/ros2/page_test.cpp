// SPDX-License-Identifier: BSD-3-Clause
// docs/ros2.md lists the parameters of each node as they are declared.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <string>

#include "cloud_work.h"

namespace pcl_slim_ros {
namespace {

std::string numberText(double value, bool whole) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  std::string made = text;
  if (!whole && made.find_first_of(".e") == std::string::npos) made += ".0";
  return made;
}

/** A default as a file of parameters has it; its type can be read from it. */
std::string defaultText(const Value& value) {
  if (const auto* on = std::get_if<bool>(&value)) return *on ? "true" : "false";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* real = std::get_if<double>(&value)) return numberText(*real, false);
  if (const auto* word = std::get_if<std::string>(&value)) return "\"" + *word + "\"";
  return "[]";
}

/** The line of the page about a parameter; a | would end a cell. */
std::string rowOf(const NodeParameter& parameter) {
  std::string range, description;
  if (parameter.range) {
    const auto [low, high] = *parameter.range;
    range = numberText(low, true) + " to " + numberText(high, true);
  }
  for (const char c : parameter.description) description += c == '|' ? "\\|" : std::string(1, c);
  return "| `" + parameter.name + "` | `" + defaultText(parameter.value) + "` | " + range + " | " +
         description + " |";
}

TEST(RosPage, EveryParameterHasItsLine) {
  std::ifstream file(PCL_SLIM_ROS_PACKAGE "/../../docs/ros2.md");
  std::set<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.insert(line);
  ASSERT_GT(lines.size(), 20u);
  for (const MakeWork make : {makeSmoothing, makeNormals, makeSplats}) {
    const auto work = make();
    for (const NodeParameter& parameter : work->parameters())
      EXPECT_EQ(lines.count(rowOf(parameter)), 1u) << rowOf(parameter);
  }
}

}  // namespace
}  // namespace pcl_slim_ros
