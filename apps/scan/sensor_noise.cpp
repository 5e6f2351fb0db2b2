// SPDX-License-Identifier: BSD-3-Clause
// The noise of a sensor between a scan's fit and that of the next one.
#include <cstdio>
#include <string>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/fit/sensor_noise.h"
#include "scan/fit_job.h"

namespace pcl_slim {

FitParams paramsFor(const FitJob& job, const CloudFile& cloud, std::string& note) {
  FitParams params = job.params;
  const PointTable& points = cloud.file.cloud;
  const std::optional<SensorNoise>& noise = params.sensor_noise;
  if (!noise || noise->hasSize(points.width, points.height)) return params;
  note = noise->rows > 0 ? "of frames of " + std::to_string(noise->columns) + " x " +
                               std::to_string(noise->rows) + " points"
                         : "of a scan without rows";
  params.sensor_noise.reset();
  return params;
}

Error finishSensorNoise(const FitJob& job, const CloudFile& cloud, const NoiseStatistics& noise,
                        const std::string& note, Console& console, Report& report) {
  if (job.params.sensor_noise) {
    const char* words[] = {"other_size", "agrees", "differs", "not_seen"};
    report.add({{"sensor_noise", words[static_cast<std::size_t>(noise.sensor_check)]},
                {"sensor_noise_ratio", noise.sensor_ratio}});
    char text[160];
    std::snprintf(text, sizeof text, "residuals are %.2f of it", noise.sensor_ratio);
    const std::string measured = "; measured anew";
    const bool agrees = noise.sensor_check == SensorCheck::kAgrees;
    console.note("  the sensor's noise given " +
                 (!note.empty() ? "is " + note + measured
                  : agrees      ? "was used: " + std::string(text)
                  : noise.sensor_check == SensorCheck::kDiffers
                      ? "differs: " + (text + measured)
                      : "cannot be checked on this scan" + measured));
  }
  if (job.save_noise.empty()) return {};
  if (!noise.sensor_noise) {
    if (isStream(job.save_noise)) return {};  // of several inputs: the next one measures its own
    console.warn("-save_noise: the noise of this scan is not that of one sensor; none is saved");
    return {};
  }
  SensorNoise saved = *noise.sensor_noise;
  const PointTable& points = cloud.file.cloud;
  const bool organised = points.height > 1;
  saved.columns = organised ? points.width : 0;
  saved.rows = organised ? points.height : 0;
  return saveSensorNoise(job.save_noise, saved);
}

}  // namespace pcl_slim
