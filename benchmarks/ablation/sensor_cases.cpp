// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "ablation/cases.h"
#include "fit_with_constants.h"
#include "measure/clocks.h"
#include "sensor/sensor_errors.h"
#include "sensor/sensor_rows.h"

namespace pcl_slim::ablation {

namespace {

using measure::SensorScan;

/** Names of rows of sensor_bench: each kind of noise, on creases and on waves of every length. */
constexpr const char* kRows[] = {"room, 3 px + 1/8 px",
                                 "room, 1/8 px",
                                 "room, 9 px + 1/8 px",
                                 "frontal hall, 3 px + 1/8 px",
                                 "balls, white",
                                 "balls, 2 px",
                                 "balls, 5 mm steps",
                                 "balls, mixed pixels, 3 px + 1/8 px",
                                 "wave40, 9 px",
                                 "wave15, white",
                                 "wave15, 3 px + 1/8 px",
                                 "wave15, 5 px",
                                 "wave6, 1/8 px",
                                 "wave6, 3 px + 1/8 px",
                                 "wave6, rows 5 x 1 px",
                                 "street, lidar",
                                 "street, lidar 128 x 1024, 1 cm",
                                 "street, lidar 32 x 1800, 3 cm",
                                 "street, lidar 32 x 1080, 1 cm",
                                 "figure, layers off by .3 mm"};

/** A row of sensor_bench. */
class SensorCase : public Case {
 public:
  SensorCase(const measure::SensorRow& row, const CaseRequest& request) : Case(row.name)
  {
    params_.threads = request.threads;
    for (int seed = 1; seed <= request.seeds; ++seed)
      scans_.push_back(row.scan(static_cast<std::uint64_t>(seed)));
  }

  Result<Figures> measure(const detail::FitConstants& constants) const override
  {
    const measure::Fitter fitter = [&](const PointStore& store, const FitParams& params,
                                       SLIMSurface& surface, FitStatistics* statistics) {
      return detail::fitWithConstants(constants, store, params, surface, statistics);
    };
    Figures sum;
    const double start = measure::cpuSeconds();
    for (const SensorScan& scan : scans_) {
      FitStatistics fit;
      const auto errors = measure::errorsOfFit(scan, params_, fit, fitter);
      if (!errors) return errors.error();
      sum.position += errors->position * errors->position;
      sum.normal += errors->normal * errors->normal;
      sum.leaves += static_cast<double>(fit.leaves);
      sum.uncovered += static_cast<double>(fit.uncovered);
    }
    const auto n = static_cast<double>(scans_.size());
    sum.seconds = measure::cpuSeconds() - start;
    sum.position = std::sqrt(sum.position / n);
    sum.normal = std::sqrt(sum.normal / n);
    return sum;
  }

 private:
  std::vector<SensorScan> scans_;
  FitParams params_;
};

}  // namespace

Result<Cases>
sensorCases(const CaseRequest& request)
{
  Cases cases;
  for (const char* name : kRows) {
    for (const measure::SensorRow& row : measure::sensorRows(name)) {
      if (row.name == name) cases.push_back(std::make_unique<SensorCase>(row, request));
    }
  }
  return cases;
}

}  // namespace pcl_slim::ablation
