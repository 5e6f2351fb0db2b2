// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/program.h"
#include "comparison/treat.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::comparison {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/** \brief Errors over all points. A point the method gave no result for counts at the place it
 * had; normals and curvature are counted where the method gives them, away from open borders. */
struct Errors {
  double position = kNone, worst = kNone;  ///< RMS and largest distance [Scene::unit]
  double normal = kNone;                   ///< RMS angle regardless of sign, degrees
  double curvature = kNone;                ///< RMS error of mean curvature / RMS mean curvature
};

/** \brief A setting, what it cost and how near to the truth it came. */
struct Run {
  Setting setting;
  double cpu = 0, wall = 0;  ///< seconds around the call; median over repeats
  double peak_bytes = -1;    ///< rise of resident memory; negative: unknown
  std::uint64_t kept = 0;    ///< points without a result
  Errors errors;
};

/** \brief How far a method's result is from the truth, over the points that the scene judges. */
Errors measure(const Scene& scene, const Treated& treated);

/** \brief How far the scene's points are from the truth as they come. */
Errors inputErrors(const Scene& scene);

/** \brief Treats a scene in one way, measured.
 * \param[in] repeats at least 1; times are medians. A run that takes more than two seconds is not
 * repeated. */
Result<Run> runSetting(const Scene& scene, const Setting& setting, int repeats = 1);

/** \brief Everything measured on one scene. */
struct SceneRuns {
  std::string name;
  double noise = 0;
  std::size_t points = 0;
  std::size_t judged = 0;   ///< points that are compared with the truth
  Errors input;             ///< of the points as they came
  bool mean_edges = false;  ///< lengths are in mean edges of the truth, not in scene units
  std::vector<Run> runs;

  /** \brief "torus, .5 % noise"; the name alone without noise. */
  std::string title() const;
};

/** \brief The method whose runs are compared. */
enum class Family { kSlimDefault, kSlim, kMls, kMlsOrder2, kNormals };

/** \brief Run of least error in a family, or null where none has that error.
 * \param[in] given for SLIM: with (1), without (0) normals, or either (-1). */
const Run* bestRun(const SceneRuns& scene, Family family, int given, double Errors::*error);

/** \brief Run of least CPU time in a family whose RMS position error is at most bound, or null. */
const Run* cheapestRun(const SceneRuns& scene, Family family, int given, double bound);

/** \brief One row a run, with a header. */
std::string csvText(const std::vector<SceneRuns>& scenes);

/** \brief Processor, threads, load average and the command that gave the tables, in Markdown. */
std::string machineText(const std::string& command);

/** \brief Best-of tables and CPU ratios, in Markdown.
 * \param[in] command line that gave them. */
std::string markdownText(const std::vector<SceneRuns>& scenes, const std::string& command);

/** \brief Whether PREFIX.csv and PREFIX.md can be written; returns the reason if not. */
Error checkTables(const std::string& prefix);

/** \brief Writes PREFIX.csv and PREFIX.md and prints their names. */
Error writeTables(const std::string& prefix, const std::string& csv, const std::string& markdown,
                  Console& console);

/** \brief Draws CPU time per point against RMS position error, both logarithmic, a panel a scene,
 * into a PNG file.
 *
 * \return an error where the chart cannot be drawn: no X server (VTK draws through one even off
 * the screen), a build without VTK's charts, nothing to draw, or a file that cannot be written.
 */
Error drawChart(const std::vector<SceneRuns>& scenes, const std::string& path);

}  // namespace pcl_slim::comparison
