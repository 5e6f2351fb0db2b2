// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_table.h"

// Points of messages: of pcl::PCLPointCloud2, ROS's sensor_msgs::msg::PointCloud2 or any type with
// their members. Needs no header of either.

namespace pcl_slim {

/** \brief Moves rows together that have bytes between them. A message that contradicts itself stays
 * as it is. */
inline void packRows(std::size_t row, std::size_t row_step, std::size_t height,
                     std::vector<std::uint8_t>& data) {
  const bool padded = row_step > row && height > 0 && data.size() / row_step >= height - 1 &&
                      data.size() >= row_step * (height - 1) + row;
  if (!padded) return;
  for (std::size_t i = 1; i < height; ++i)
    std::memmove(data.data() + i * row, data.data() + i * row_step, row);
  data.resize(row * height);
}

/** \brief A message's points, whose bytes are taken without a copy from one that is moved here; bytes
 * between rows are left out. Nothing is checked: see tableOf(). */
template <typename Message>
PointTable takePoints(Message&& message) {
  PointTable table;
  for (const auto& field : message.fields)
    table.fields.push_back({field.name, field.offset, field.datatype, field.count});
  table.height = message.height;
  table.width = message.width;
  table.point_step = message.point_step;
  table.data = std::forward<Message>(message).data;
  packRows(std::size_t{table.point_step} * table.width, message.row_step, table.height, table.data);
  return table;
}

/** \brief A message's points. \return an error for big-endian ones, and for a message that
 * contradicts itself (checkPointTable, and rows that are shorter than their points). */
template <typename Message>
Result<PointTable> tableOf(Message&& message) {
  if (message.is_bigendian)
    return badInput("the points are big-endian: send them in little-endian byte order");
  const std::uint64_t row = std::uint64_t{message.point_step} * message.width;
  if (message.height > 1 && message.row_step < row)
    return badInput("rows of " + std::to_string(message.width) + " points of " +
                    std::to_string(message.point_step) + " bytes have a row_step of " +
                    std::to_string(message.row_step) + ": correct it");
  PointTable table = takePoints(std::forward<Message>(message));
  if (Error error = checkPointTable(table)) return error;
  return table;
}

/** \brief Puts points into a message, whose header stays. */
template <typename Message>
void putPoints(PointTable table, bool is_dense, Message& message) {
  message.fields.clear();
  for (const PointField& field : table.fields) {
    auto& made = message.fields.emplace_back();
    made.name = field.name;
    made.offset = field.offset;
    made.datatype = field.datatype;
    made.count = field.count;
  }
  message.height = table.height;
  message.width = table.width;
  message.is_bigendian = false;
  message.point_step = table.point_step;
  message.row_step = table.point_step * table.width;
  message.data = std::move(table.data);
  message.is_dense = is_dense;
}

}  // namespace pcl_slim
