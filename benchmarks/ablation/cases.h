// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/core/error.h"

/** \brief What an ablation looks at. */
namespace pcl_slim::ablation {

/** \brief What a fit gives in one case; errors are RMS over its seeds. What a case cannot tell is 0. */
struct Figures {
  double position = 0;   ///< error, scene units
  double normal = 0;     ///< error, degrees
  double curvature = 0;  ///< error of mean curvature over its own RMS
  double leaves = 0;
  double uncovered = 0;  ///< points
  double farthest = 0;   ///< farthest move of a point, share of the diagonal
  double seconds = 0;    ///< CPU time of the fits
};

/** \brief One cloud, or the same scene by several seeds, ready to be fitted. */
class Case {
 public:
  virtual ~Case() = default;
  explicit Case(std::string name) : name_(std::move(name)) {}
  const std::string& name() const { return name_; }
  virtual Result<Figures> measure(const detail::FitConstants& constants) const = 0;

 private:
  std::string name_;
};

using Cases = std::vector<std::unique_ptr<Case>>;

/** \brief How large and how many the cases are. */
struct CaseRequest {
  std::size_t points = 30000;  ///< of an exact surface
  int seeds = 3;
  int threads = 1;
  std::string data;  ///< folder of scans; empty: none
};

/** \brief Exact surfaces under white noise, with and without normals. */
Result<Cases>
exactCases(const CaseRequest& request);

/** \brief Waves above a square: fine ones, two sheets, uneven density, outliers. */
Result<Cases>
heightCases(const CaseRequest& request);

/** \brief Noisy scans beside their originals, and real scans: .pcd and .ply files of the folder. */
Result<Cases>
scanCases(const CaseRequest& request);

/** \brief Scans as depth cameras and a turning lidar make them; sizes are the sensors'. */
Result<Cases>
sensorCases(const CaseRequest& request);

}  // namespace pcl_slim::ablation
