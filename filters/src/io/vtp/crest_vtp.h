// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/features/crest_lines.h"

namespace pcl_slim {

/** The vertices of a line in order; a closed one's first again at the end. */
inline std::vector<std::uint32_t>
pathOf(const CrestLines& lines, std::size_t line)
{
  std::vector<std::uint32_t> path;
  for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
    path.push_back(v);
  }
  if (lines.closed[line] != 0) path.push_back(lines.line_begin[line]);
  return path;
}

/** Writes lines as VTK polylines; an error in builds without VTP. */
Error
saveCrestVtp(const std::string& path, const CrestLines& lines);

}  // namespace pcl_slim
