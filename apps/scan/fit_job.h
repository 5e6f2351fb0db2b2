// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit_parameters.h"
#include "scan/cloud_file.h"
#include "scan/input_options.h"

namespace pcl_slim {

/** \brief The defaults of a fit whose surface nobody sees. */
inline FitParams withoutTrim() {
  FitParams params;
  params.trim = false;
  return params;
}

/** \brief The help text of programs about their input. */
constexpr const char* kScanHelp =
    "the scan: .pcd .ply .las .laz .xyz .txt .csv .pts .ptx .obj .off .stl .vtp; normals and faces "
    "are "
    "used";

/** \brief From a scan's file to its surface: the options, steps and report entries of every
 * program that fits. */
struct FitJob {
  FitParams params = withoutTrim();
  InputOptions input;  ///< how the scan's files are read
  /** \brief Parameters given by a word, as read, by the option's name. */
  std::map<std::string, std::string> words;
  std::string trajectory, time_field;  ///< file of the sensor's places; field of the points' times
  double time_offset = 0;
  std::string frames;                  ///< further files of the scan, separated by commas
  std::string frame_field;             ///< field of the numbers of a merged scan's frames
  std::string noise_from, save_noise;  ///< files of a sensor's noise
  std::optional<bool> same_sensor;     ///< several inputs are frames of one sensor
  bool use_normals = true;
  bool color = false;  ///< the surface gets the colours of the scan's points, where these have any
  int normal_neighbours = 0;
};

/** \brief Adds the options of a fit. The job must outlive the table's parse(). */
void declareFitOptions(OptionTable& options, FitJob& job);

/** \brief Adds -surface, a surface in place of a fit, and the options of a fit; the latter have
 * no effect with -surface. */
void declareSurfaceOrFit(OptionTable& options, std::string& surface, FitJob& job);

/** \brief Adds -viewpoint, with this help unless it is null, and those of a trajectory. */
void declareSensorOptions(OptionTable& options, FitJob& job, const char* viewpoint_help = nullptr);

/** \brief Adds those of trim maps, for programs whose surface is kept or drawn; others make none.
 */
void declareTrimOptions(OptionTable& options, FitJob& job);

/** \brief Adds that of colours, for programs whose surface is kept, drawn or sampled; others fit
 * none. */
void declareColorOption(OptionTable& options, FitJob& job);

/** \brief Reads the words and the sensor's noise given and checks the parameters. */
Error finishFitOptions(FitJob& job);

/** \brief The files that a job reads besides the scan itself, after others; empty names: none. */
std::vector<std::string> filesRead(const FitJob& job, std::vector<std::string> others = {});

/** \brief Loads a scan, with normals as the job needs them; prints and reports it. \param[in,out]
 * read its points, if they are read already, which are then taken. */
Result<CloudFile> loadScan(const std::string& path, const FitJob& job, Console& console,
                           Report& report, PointFile* read = nullptr);

/** \brief Fits a surface to a scan; prints and reports what was done and what was skipped.
 * \param[out] kept the store of the scan, for further work with it (may be null); also set where
 * the error is that the points are no surface. */
Error fitScan(const FitJob& job, const CloudFile& cloud, Console& console, Report& report,
              SLIMSurface& surface, PointStore* kept = nullptr);

/** \brief The part of a report about the points that a surface was fitted to. */
struct FittedPoints {
  std::uint64_t stored = 0;
  double diagonal = 0;  ///< world length
  std::uint64_t store_bytes = 0;
  PointStoreStatistics statistics;
};

/** \brief The points of one store. */
FittedPoints fittedPoints(const PointStore& store);

/** \brief What a fit came to, into the report. */
void reportFit(const FittedPoints& points, const SLIMSurface& surface, const FitStatistics& fit,
               Report& report);

/** \brief Lines about the textures of a surface; none where it has none. */
std::vector<std::string> colorNotes(const SLIMSurface& surface);

/** \brief A surface read in place of a fit, into the report: its lambda under a fit's key. */
void reportSurface(const std::string& path, const SLIMSurface& surface, Report& report);

/** \brief "1 level", "3 levels". */
std::string counted(std::uint64_t count, const std::string& what);

/** \brief "noise 1.9 RMS, white"-like line: sigma in the scan's units and what kind of noise it is.
 */
std::string noiseText(double diagonal, const FitStatistics& fit);

/** \brief The noise of a sensor that a fit of a scan uses: none where the scan is of another size.
 * \param[out] note a line about that */
FitParams paramsFor(const FitJob& job, const CloudFile& cloud, std::string& note);

/** \brief Prints and reports what became of the sensor's noise given, and saves that of this scan.
 * \param[in] note of paramsFor() */
Error finishSensorNoise(const FitJob& job, const CloudFile& cloud, const NoiseStatistics& noise,
                        const std::string& note, Console& console, Report& report);

/** \brief "solved: penalty 618, residual 0.002 of the diagonal; -noise_factor 206 repeats it": what
 * a fit to a target came to. \param[in] diagonal in the scan's unit, for "residual 0.03 RMS" in it;
 * 0: a share is printed */
std::string solvedText(const FitStatistics& fit, double diagonal = 0);

/** \brief How many points got a side before the cover, and how sure those are; empty if none did.
 */
std::string sidesText(const FitStatistics& fit);

/** \brief "points skipped: 32 non-finite, 4 duplicate", or nothing. */
std::string skippedText(const PointStoreStatistics& points);

/** \brief Prints what a user may want otherwise of the sides that were chosen; see sideNotes(). */
void printSideNotes(SideSource source, const NormalAgreement& normals, Console& console);

/** \brief Lines about points that no leaf covers; none if all are covered. */
std::vector<std::string> coverNotes(const FitStatistics& fit);

}  // namespace pcl_slim
