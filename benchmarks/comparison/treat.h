// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "comparison/scene.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim::comparison {

enum class Method { kSlim, kMls, kNormals };

/** \brief One way to treat a scene; unused members keep their values. */
struct Setting {
  Method method = Method::kSlim;
  int degree = 0;        ///< SLIM: 1..4, 0 its default; MLS: order of the polynomial
  double penalty = 0;    ///< SLIM: kappa, 0 its default
  double t_mdl = 0;      ///< SLIM: the paper's T in place of kappa
  bool sharp = false;    ///< SLIM: keep sharp edges
  bool robust = false;   ///< SLIM: reweighted against outliers
  bool compact = false;  ///< SLIM: leaves cover all of their radius (alpha = 1)
  bool normals = false;  ///< SLIM: the scene's normals are given
  bool data = false;     ///< SLIM: normals are fitted as data, too
  int neighbours = 0;    ///< MLS: mean number in its radius; normals: k
  bool judged = false;   ///< MLS: only the points that are judged are treated; no times then
  int threads = 2;

  /** \brief Nothing is set but what comes with the cloud. */
  bool automatic() const {
    return degree == 0 && penalty <= 0 && t_mdl <= 0 && !sharp && !robust && !compact && !data;
  }
  /** \brief "degree 4 kappa 3", "order 2 k 60"; without the method's name. */
  std::string text() const;
  /** \brief "slim degree 2 kappa 8, normals given". */
  std::string fullText() const;
};

/** \brief Name of a method as in tables: slim, mls, normals. */
std::string methodName(Method method);

/** \brief A SLIM setting as the fit takes it. */
FitParams fitParams(const Setting& setting);

/** \brief What a method gives back, in the order of the input, and what it cost. */
struct Treated {
  pcl::PointCloud<pcl::PointNormal> points;
  std::vector<float> mean_curvature;  ///< positive where bent away from the normal; may be empty
  std::vector<std::uint8_t> done;     ///< 0: no result, the point as it came
  bool moves_points = true;
  double cpu = 0, wall = 0;  ///< seconds around the call
};

/** \brief Treats a scene in one way.
 *
 * The clock runs from the cloud in memory to the cloud of points with normals in memory: PCL's
 * search tree is built inside it, and so is SLIM's store. Curvatures are taken afterwards, from
 * MLS's cached results and by a second projection with SLIM, outside the clock for both.
 * \return an error for a setting that the scene or the method does not allow.
 */
Result<Treated> treat(const Scene& scene, const Setting& setting);

}  // namespace pcl_slim::comparison
