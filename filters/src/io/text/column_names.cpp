// SPDX-License-Identifier: BSD-3-Clause
#include "io/text/column_names.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace pcl_slim {

namespace {

struct Alias {
  const char *written, *name;
};

constexpr Alias kAliases[] = {
    {"easting", "x"},        {"northing", "y"},       {"elevation", "z"},
    {"height", "z"},         {"altitude", "z"},       {"r", "red"},
    {"g", "green"},          {"b", "blue"},           {"a", "alpha"},
    {"nx", "normal_x"},      {"ny", "normal_y"},      {"nz", "normal_z"},
    {"normalx", "normal_x"}, {"normaly", "normal_y"}, {"normalz", "normal_z"},
    {"i", "intensity"}};

bool
has(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/** Gives columns of one name different ones. */
void
makeUnique(std::vector<std::string>& names)
{
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string name = names[k];
    const auto before = names.begin() + static_cast<std::ptrdiff_t>(k);
    for (int copy = 2; std::find(names.begin(), before, names[k]) != before; ++copy)
      names[k] = name + "_" + std::to_string(copy);
  }
}

Result<std::vector<std::string>>
knownNames(const TextTable& table)
{
  std::vector<std::string> names;
  std::string written;
  for (const TextColumn& column : table.columns) {
    names.push_back(plainColumnName(column.name));
    written += (written.empty() ? "" : ", ") + column.name;
  }
  for (const Alias& alias : kAliases) {
    const auto at = std::find(names.begin(), names.end(), alias.written);
    if (at != names.end() && !has(names, alias.name)) *at = alias.name;
  }
  makeUnique(names);
  for (const char* axis : {"x", "y", "z"}) {
    const auto at = std::find(names.begin(), names.end(), axis);
    if (at == names.end() || !table.columns[static_cast<std::size_t>(at - names.begin())].numeric)
      return badInput("its columns are named " + written.substr(0, 200) +
                      "; name three of numbers x, y and z");
  }
  return names;
}

/** Whether three columns are unit vectors, or zero, in a sample of the rows. */
bool
areNormals(const TextTable& table, std::size_t first)
{
  constexpr std::size_t kSample = 1000;
  constexpr double kTolerance = 0.02;  // of the length: three decimals and their rounding
  if (first + 3 > table.columns.size()) return false;
  const std::size_t step = std::max<std::size_t>(1, table.rows() / kSample);
  std::size_t unit = 0, others = 0;
  for (std::size_t row = 0; row < table.rows(); row += step) {
    const double length =
        std::hypot(table.at(row, first), table.at(row, first + 1), table.at(row, first + 2));
    if (std::abs(length - 1.0) < kTolerance)
      ++unit;
    else if (length != 0.0 && std::isfinite(length))
      ++others;
  }
  return unit > 0 && others == 0;
}

bool
areColors(const TextTable& table, std::size_t first)
{
  if (first + 3 > table.columns.size()) return false;
  for (std::size_t k = first; k < first + 3; ++k) {
    const TextColumn& column = table.columns[k];
    if (!column.whole || !(column.least >= 0 && column.most <= 255)) return false;
  }
  return true;
}

std::vector<std::string>
guessedNames(const TextTable& table, bool intensity_first)
{
  const std::size_t count = table.columns.size();
  std::vector<std::string> names = {"x", "y", "z"};
  const auto add = [&names](std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  while (names.size() < count) {
    const std::size_t k = names.size();
    const bool has_intensity = has(names, "intensity");
    if (!has(names, "normal_x") && areNormals(table, k))
      add({"normal_x", "normal_y", "normal_z"});
    else if (intensity_first && !has_intensity && areColors(table, k + 1))
      add({"intensity"});
    else if (!has(names, "red") && areColors(table, k))
      add({"red", "green", "blue"});
    else if (!has_intensity)
      add({"intensity"});
    else
      names.push_back("column_" + std::to_string(k + 1));
  }
  return names;
}

}  // namespace

std::string
plainColumnName(const std::string& written)
{
  std::string name;
  for (const char c : written.substr(0, written.find_first_of("[("))) {
    const auto byte = static_cast<unsigned char>(c);
    name += byte <= ' ' ? '_' : static_cast<char>(std::tolower(byte));
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name.empty() ? "column" : name;
}

Result<std::vector<std::string>>
columnNames(const TextTable& table, bool intensity_first)
{
  if (table.named) return knownNames(table);
  if (table.columns.size() < 3)
    return badInput("its lines have fewer than 3 numbers: give x, y and z of a point");
  return guessedNames(table, intensity_first);
}

}  // namespace pcl_slim
