// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/filters/io/point_file_pieces.h"
#include "projection/block_surface.h"
#include "projection/projection_job.h"
#include "scan/tile_request.h"

namespace pcl_slim {

/** \brief A scan that is fitted by tiles and brought onto its surface some rows at a time. */
class PieceJob {
 public:
  PieceJob(const ProjectionProgram& program, const ProjectionJob& job,
           const MakeOutput& make_output, const bool& chosen)
      : program_(program), job_(job), make_output_(make_output), chosen_(chosen)
  {
  }

  TileRequest& tiles() { return tiles_; }
  BlockSurface& blocks() { return blocks_; }

  /** \brief Opens the scan. \return whether it is worked on in pieces; an error where the user asks for
   * pieces, or memory is too small for anything else, and the scan or the job does not allow them. */
  Result<bool> open(Console& console);

  /** \brief Fits, unless a surface was read, projects and writes; ScanResult::save puts the file in its
   * place. */
  Error run(SLIMSurface& surface, Console& console, Report& report, ScanResult& result);

 private:
  std::size_t rows() const;
  Result<bool> openRows(Console& console);
  Error projectRows(const SLIMSurface& surface, Console& console, Report& report);
  Result<PointFile> brought(PointFile piece, const SLIMSurface& surface);
  Result<PointFile> brought(const CloudFile& cloud, const SLIMSurface& surface);
  Result<CloudProjection> project(const CloudFile& cloud, const SLIMSurface& surface) const;
  void count(const CloudProjectionStatistics& piece);

  const ProjectionProgram& program_;
  const ProjectionJob& job_;
  const MakeOutput& make_output_;
  const bool& chosen_;
  TileRequest tiles_;
  std::unique_ptr<PointSource> source_;  ///< null: a surface was read
  BlockSurface blocks_;                  ///< a surface that was read, if it is in blocks
  PointFileReader reader_;
  PointFileWriter writer_;
  CloudProjectionStatistics sum_;  ///< rms_displacement: a sum of squares
};

}  // namespace pcl_slim
