// SPDX-License-Identifier: BSD-3-Clause
#include "common/programs.h"

#include "pcl_slim/version.h"

namespace pcl_slim {

const std::vector<ProgramEntry>& programs() {
  static const std::vector<ProgramEntry> all = {
      {"fit", "pcl_slim_fit", "Fits a SLIM surface, a set of local polynomials, to a scan.", ""},
      {"smooth", "pcl_slim_smooth", "Moves a scan's points onto the SLIM surface fitted to it.",
       ""},
      {"mesh", "pcl_slim_mesh", "Makes a triangle mesh of a scan's SLIM surface.", ""},
      {"curvature", "pcl_slim_curvature",
       "Adds curvatures and normals of its SLIM surface to a scan.", ""},
      {"lines", "pcl_slim_lines", "Traces the ridges and ravines of a scan as polylines.", ""},
      {"sample", "pcl_slim_sample", "Spreads points evenly over the SLIM surface of a scan.", ""},
      {"compare", "pcl_slim_compare",
       "Measures what has changed between two scans, surfaces or meshes.", ""},
      {"splats", "pcl_color_splat_sampling",
       "Thins a coloured scan to discs that cover its surface.", ""},
      {"render", "pcl_slim_render", "Draws a surface, splats or a mesh: a picture or a web page.",
       ""},
      {"view", "pcl_slim_view", "Shows a surface, splats or a scan in a window.",
       "VTK's rendering and PCL's visualization"},
      {"benchmark", "pcl_slim_benchmark", "Measures time against error, beside PCL's classes.", ""},
      {"fit_mpi", "pcl_slim_fit_mpi", "Fits a SLIM surface to a scan on the ranks of an MPI job.",
       "MPI"},
      {"demo_scan", "pcl_slim_demo_scan", "Writes a scan of an amphora, as a laser scanner's.", ""},
  };
  return all;
}

OptionTable programOptions(const std::string& name) {
  for (const ProgramEntry& program : programs()) {
    if (name == program.name) return OptionTable(name, PCL_SLIM_VERSION, program.summary);
  }
  return OptionTable(name, PCL_SLIM_VERSION, "");
}

}  // namespace pcl_slim
