// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/program.h"
#include "pcl_slim/query/cloud_projection.h"
#include "scan/fit_job.h"
#include "scan/scan_files.h"
#include "scan/tile_fit.h"

namespace pcl_slim {

/** \brief What the programs do alike that bring a scan onto its surface and write it again. */
struct ProjectionJob {
  ScanFiles files;
  std::string surface;  ///< a file to read instead of fitting, or none
  FitJob fit;
  TileRequest tiles;
  ProjectionParams projection;
  bool more_fields = false;  ///< the switch of the program's own: which fields are written
  bool curvatures = false;   ///< write the surface's curvatures, too
  bool errors = false;       ///< write standard errors, too
  /// a point's neighbours are not at hand: no surface variation, no normals of points without
  /// support
  bool in_pieces = false;
};

/** \brief Adds the arguments and options that these programs share; the job must outlive the
 * table's parse(). */
void declareProjection(OptionTable& options, ProjectionJob& job);

/** \brief Completes the job and checks what can be checked before the input is read. */
Error finishProjection(const OptionTable& options, ProjectionJob& job);

/** \brief Reads a surface, or of one in blocks what the points near it need; prints and reports
 * it. \param[in] near null: all of it. */
Error readSurface(const std::string& path, const CloudFile* near, Console& console, Report& report,
                  SLIMSurface& surface);

/** \brief Brings the scan onto the surface; prints and reports it. \param[in] store the scan's, or
 * null. */
Result<CloudProjection> projectScan(const ProjectionJob& job, const CloudFile& scan,
                                    const SLIMSurface& surface, const PointStore* store,
                                    Console& console, Report& report);

/** \brief Prints how far the surface is from the points, and how many it does not support. */
void printProjection(const CloudProjectionStatistics& statistics, Console& console);

/** \brief What became of the points, into the report. */
void reportProjection(const CloudProjectionStatistics& statistics, Report& report);

/** \brief Warns of what a scan has that is not written. */
void warnOfLeftOut(const CloudFile& scan, Console& console);

/** \brief Saves the points and the report. */
Error savePoints(const ProjectionJob& job, const PointFile& points, Console& console,
                 Report& report);

}  // namespace pcl_slim
