// SPDX-License-Identifier: BSD-3-Clause
#include "comparison/tables.h"

namespace pcl_slim::comparison {

Error drawChart(const std::vector<SceneRuns>&, const std::string& path) {
  return {ErrorCode::kIo, "'" + path +
                              "' is not drawn: this program was built without VTK's charts; "
                              "install them (libvtk9-dev) and build again"};
}

}  // namespace pcl_slim::comparison
