// SPDX-License-Identifier: BSD-3-Clause
#include "splats/colored_scan.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace pcl_slim::measure {

Result<ColoredScan> loadColoredScan(const std::string& path) {
  Result<CloudFile> file = loadCloudFile(path);
  if (!file) return file.error();
  ColoredScan scan;
  scan.file = std::move(*file);
  scan.colors = colorsOf(scan.file);
  if (!scan.colors.bgr || scan.size() == 0) {
    return Error{ErrorCode::kBadInput,
                 "'" + path + "' has no points or no colours; name a coloured scan"};
  }
  if (scan.file.normal_source == NormalSource::kNothing) {
    if (Error error = estimateNormals(16, {}, 0, scan.file)) return error;
  }
  return scan;
}

SplatSet splatsOf(const ColoredScan& scan, const SplatParams& params) {
  SplatSet splats;
  const CloudView view = scan.file.view(scan.give_normals);
  if (const Error error = sampleSplats(view, scan.colors, params, splats)) {
    std::fprintf(stderr, "%s\n", error.message.c_str());
    std::exit(1);
  }
  return splats;
}

}  // namespace pcl_slim::measure
