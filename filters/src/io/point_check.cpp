// SPDX-License-Identifier: BSD-3-Clause
// Whether tables and files of points that a caller made are consistent.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim {

namespace {

constexpr std::uint64_t kMostPoints = std::numeric_limits<std::uint32_t>::max() - 1;

/** Whether a format can write a name as one word of its header. */
bool isWord(const std::string& name) {
  const auto isPlain = [](char c) { return static_cast<unsigned char>(c) > ' ' && c != '\x7f'; };
  return !name.empty() && std::all_of(name.begin(), name.end(), isPlain);
}

Error checkField(const PointField& field, std::uint32_t step) {
  if (!isWord(field.name))
    return badInput("a field's name is empty or has spaces: give it a name of one word");
  const std::string name = "the field '" + field.name + "' ";
  const std::uint64_t size = scalarSize(field.datatype);
  if (size == 0)
    return badInput(name + "has the type " + std::to_string(field.datatype) +
                    ", which is none: give it a ScalarType");
  const std::uint64_t end = field.offset + size * std::max(field.count, std::uint32_t{1});
  if (end <= step) return {};
  return badInput(name + "ends at byte " + std::to_string(end) + " of a point that has " +
                  std::to_string(step) + ": correct its offset and count, or point_step");
}

Error checkFaces(const PointFile& file) {
  const auto& begin = file.face_begin;
  const auto& corners = file.face_vertices;
  const bool ascending = begin.empty() ? corners.empty()
                                       : begin.front() == 0 && begin.back() == corners.size() &&
                                             std::is_sorted(begin.begin(), begin.end());
  if (!ascending) {
    return badInput("face_begin does not ascend from 0 to the number of face_vertices, " +
                    std::to_string(corners.size()) + ": correct it, or leave the faces out");
  }
  const std::size_t n = numPoints(file.cloud);
  const auto isMissing = [n](std::uint32_t vertex) { return vertex >= n; };
  const auto wrong = std::find_if(corners.begin(), corners.end(), isMissing);
  if (wrong == corners.end()) return {};
  return badInput("a face has vertex " + std::to_string(*wrong) + " of " + std::to_string(n) +
                  ": correct it, or leave the faces out");
}

}  // namespace

Error checkPointTable(const PointTable& table) {
  const std::uint64_t points = std::uint64_t{table.width} * table.height;
  if (points > kMostPoints) {
    return badInput("the points have " + std::to_string(table.width) + " columns and " +
                    std::to_string(table.height) +
                    " rows, more than 2^32 - 2 in all: correct width and height");
  }
  for (const PointField& field : table.fields) {
    if (Error error = checkField(field, table.point_step)) return error;
  }
  if (points > 0 && table.fields.empty())
    return badInput("the points have no fields: add x, y and z");
  const std::uint64_t wanted = points * table.point_step;
  if (table.data.size() == wanted) return {};
  return badInput("the points have " + std::to_string(table.data.size()) + " bytes of data where " +
                  std::to_string(points) + " points of " + std::to_string(table.point_step) +
                  " bytes have " + std::to_string(wanted) +
                  ": correct width, height, point_step or data");
}

Error PointFile::validate() const {
  if (Error error = checkPointTable(cloud)) return error;
  for (const std::string& comment : comments) {
    if (comment.find_first_of("\r\n") != std::string::npos)
      return badInput("a comment has a line end: make two comments of it");
  }
  return checkFaces(*this);
}

}  // namespace pcl_slim
