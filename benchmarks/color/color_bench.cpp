// SPDX-License-Identifier: BSD-3-Clause
// color_bench: colours of surfaces with and without textures, beside those of the points: sharpness,
// size and cost on scans; distance from the truth on painted plates, beside points, voxels and splats.
#include <cstdio>
#include <string>

#include "color/color_rows.h"
#include "common/options.h"

int main(int argc, char** argv) {
  using namespace pcl_slim;
  std::string what, pictures;
  OptionTable options("color_bench", "1", "Colours of surfaces beside those of their points.");
  options.positional("SCAN|painted", &what, "a coloured scan, or the plates of known colours");
  options.text("pictures", &pictures, "PREFIX", "write pictures of a scan's points and surfaces");
  if (const auto status = options.parse(argc, argv)) return *status;
  const Error error =
      what == "painted" ? measure::printPainted() : measure::printScan(what, pictures);
  if (!error) return kExitDone;
  std::fprintf(stderr, "color_bench: %s\n", error.message.c_str());
  return kExitFailed;
}
