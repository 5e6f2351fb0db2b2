// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/filters/io/point_file_pieces.h"
#include "projection/block_surface.h"
#include "projection/projection_job.h"

namespace pcl_slim {

/** \brief Makes the file to write from the file read and its projection. */
using MakeFields = PointFile (*)(const PointFile& file, const CloudProjection& projection,
                                 const ProjectionJob& job);

/** \brief A scan that is fitted by tiles and brought onto its surface some rows at a time, from file
 * to file. */
class PieceStream {
 public:
  /** \param[in] job must outlive this object; that its scan was opened is noted in its tiles. */
  explicit PieceStream(ProjectionJob& job) : job_(job) {}

  /** \brief Opens the scan if it is to be worked on in pieces. \return an error where the user
   * requests pieces, or memory is too small for anything else, and the scan or the job does not
   * allow them. */
  Error open(Console& console);
  bool isOpen() const { return open_; }

  /** \brief Fits, or reads the surface, projects and writes. */
  Exit run(MakeFields fields, Console& console, Report& report);

 private:
  std::size_t rows() const;
  Error openRows(Console& console);
  Error readWholeOrHead(Console& console, Report& report, SLIMSurface& surface);
  Error projectRows(MakeFields fields, const SLIMSurface& surface, Console& console,
                    Report& report);
  Result<PointFile> brought(MakeFields fields, PointFile piece, const SLIMSurface& surface);
  Result<PointFile> brought(MakeFields fields, const CloudFile& cloud, const SLIMSurface& surface);
  Result<CloudProjection> project(const CloudFile& cloud, const SLIMSurface& surface) const;
  void count(const CloudProjectionStatistics& piece);

  ProjectionJob& job_;
  bool open_ = false;
  std::unique_ptr<PointSource> source_;  ///< null: a surface is read
  BlockSurface blocks_;                  ///< a surface that is read, if it is in blocks
  PointFileReader reader_;
  PointFileWriter writer_;
  CloudProjectionStatistics sum_;  ///< rms_displacement: a sum of squares
};

}  // namespace pcl_slim
