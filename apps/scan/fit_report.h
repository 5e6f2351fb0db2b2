// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/program.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim {

/** \brief The part of a report about the points that a surface was fitted to. */
struct FittedPoints {
  std::uint64_t stored = 0;
  double diagonal = 0;  ///< world length
  std::uint64_t store_bytes = 0;
  PointStoreStatistics statistics;
};

/** \brief The points of one store. */
FittedPoints
fittedPoints(const PointStore& store);

/** \brief What a fit came to, into the report. */
void
reportFit(const FittedPoints& points, const SLIMSurface& surface, const FitStatistics& fit,
          Report& report);

/** \brief A surface read in place of a fit, into the report: its lambda under a fit's key. */
void
reportSurface(const std::string& path, const SLIMSurface& surface, Report& report);

/** \brief "1 level", "3 levels". */
std::string
counted(std::uint64_t count, const std::string& what);

/** \brief "noise 1.9 RMS, white"-like line: sigma in the scan's units and what kind of noise it is. */
std::string
noiseText(double diagonal, const FitStatistics& fit);

/** \brief "solved: penalty 618, residual 0.002 of the diagonal; -noise_factor 206 repeats it": what a fit to a target came to. */
std::string
solvedText(const FitStatistics& fit);

/** \brief How many points got a side before the cover, and how sure those are; empty if none did. */
std::string
sidesText(const FitStatistics& fit);

/** \brief "points skipped: 32 non-finite, 4 duplicate", or nothing. */
std::string
skippedText(const PointStoreStatistics& points);

/** \brief Lines about points that no leaf covers; none if all are covered. */
std::vector<std::string>
coverNotes(const FitStatistics& fit);

}  // namespace pcl_slim
