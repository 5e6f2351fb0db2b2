// SPDX-License-Identifier: BSD-3-Clause
#include "scan/small_components.h"

#include <cmath>

#include "scan/fit_job.h"

namespace pcl_slim {

void declareComponentOption(OptionTable& options, double& min_points) {
  options.number("min_component", &min_points, 0, 1e12,
                 "leave out components of fewer points; 0: keep all");
}

std::string leftOutText(std::uint64_t components, double points) {
  return "left out: " + counted(components, "small component") + " of about " +
         counted(static_cast<std::uint64_t>(std::llround(points)), "point") +
         "; -min_component 0 keeps them";
}

void leaveOutComponents(double min_points, int threads, const std::vector<WorldBox>& unloaded,
                        Console& console, Report* report, SLIMSurface& surface) {
  const DroppedComponents dropped = dropComponents(min_points, surface, threads, unloaded);
  if (report != nullptr) {
    report->set("left_out", {{"components", dropped.components},
                             {"leaves", dropped.leaves},
                             {"points", dropped.points}});
  }
  if (dropped.components > 0) console.note("  " + leftOutText(dropped.components, dropped.points));
}

}  // namespace pcl_slim
