// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fit: turns a scan into a SLIM surface.
#include "pcl_slim/version.h"
#include "scan/fit_program.h"

int main(int argc, char** argv) {
  return pcl_slim::runFitProgram("pcl_slim_fit", PCL_SLIM_VERSION, argc, argv);
}
