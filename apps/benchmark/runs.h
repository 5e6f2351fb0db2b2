// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "benchmark/scene.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::comparison {

enum class Method { kSlim, kMls, kNormals };

/** \brief One way to treat a scene; unused members keep their values. */
struct Setting {
  Method method = Method::kSlim;
  int degree = 0;        ///< SLIM: 1..4, 0 its default; MLS: order of the polynomial
  double penalty = 0;    ///< SLIM: kappa, 0 its default
  double t_mdl = 0;      ///< SLIM: the paper's T in place of kappa
  bool sharp = false;    ///< SLIM: keep sharp edges
  bool normals = false;  ///< SLIM: the scene's normals are given
  int neighbours = 0;    ///< MLS: mean number in its radius; normals: k
  int threads = 2;

  /** \brief Nothing is set but what comes with the cloud. */
  bool automatic() const { return degree == 0 && penalty <= 0 && t_mdl <= 0 && !sharp; }
  /** \brief "degree 4 kappa 3", "order 2 k 60"; without the method's name. */
  std::string text() const;
};

/** \brief Name of a method as in tables: slim, mls, normals. */
std::string
methodName(Method method);

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

/** \brief Treats a scene in one way.
 *
 * The clock runs from the cloud in memory to the cloud of points with normals in memory: PCL's
 * search tree is built inside it, and so is SLIM's store. Curvatures are taken afterwards, from
 * MLS's cached results and by a second projection with SLIM, outside the clock for both.
 * \param[in] repeats at least 1; times are medians. A run that takes more than two seconds is not
 * repeated.
 */
Result<Run>
runSetting(const Scene& scene, const Setting& setting, int repeats = 1);

}  // namespace pcl_slim::comparison
