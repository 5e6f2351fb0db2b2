// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/stream/record_source.h"

namespace pcl_slim {

/** \brief Reads a point file some rows at a time, each with all of its fields.
 *
 * For binary .pcd, binary .ply whose only element with data is its vertices, .f32 and .f64.
 */
class PCL_SLIM_EXPORT PointFileReader {
 public:
  /** \return an error where the file cannot be read or, ErrorCode::kBadArgument, not in pieces. */
  Error open(const std::string& path);

  std::uint64_t size() const { return layout_.count; }
  /** \brief Of the whole file, in rows of an organised cloud. */
  std::uint64_t width() const { return width_; }
  std::uint64_t height() const { return height_; }
  const RecordLayout& layout() const { return layout_; }

  /** \brief Reads at most a number of further points, none at the end. */
  Error next(std::size_t most, PointFile& piece);

 private:
  std::string headerFor(std::uint64_t points) const;

  RecordLayout layout_;
  std::string header_;  ///< the file's, as text
  bool pcd_ = false;
  std::uint64_t width_ = 0, height_ = 1, done_ = 0;
};

/** \brief Writes a point file some rows at a time, as savePointFile() writes all of them: .pcd or
 * .ply. */
class PCL_SLIM_EXPORT PointFileWriter {
 public:
  /** \param[in] width,height of the whole file */
  Error open(const std::string& path, std::uint64_t width, std::uint64_t height);
  /** \brief Appends points; all pieces have the same fields. */
  Error add(const PointFile& piece);
  /** \brief Puts the file in its place. */
  Error finish();

 private:
  FileWriter file_;
  bool pcd_ = false;
  std::uint64_t width_ = 0, height_ = 1;
  bool begun_ = false;
};

}  // namespace pcl_slim
