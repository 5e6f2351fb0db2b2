// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/crest_files.h"

#include <algorithm>
#include <cstring>

#include "io/point_formats.h"
#include "io/vtp/crest_vtp.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

Error
saveCrestPly(const std::string& path, const CrestLines& lines)
{
  Result<std::vector<unsigned char>> made = formatPly(toPointFile(lines));
  if (!made) return made.error();
  std::vector<unsigned char>& bytes = *made;
  std::size_t edges = 0;
  const std::size_t body = bytes.size();
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    const auto path_of_line = pathOf(lines, line);
    for (std::size_t i = 0; i + 1 < path_of_line.size(); ++i, ++edges) {
      const std::int32_t ends[2] = {static_cast<std::int32_t>(path_of_line[i]),
                                    static_cast<std::int32_t>(path_of_line[i + 1])};
      bytes.resize(bytes.size() + sizeof(ends));
      std::memcpy(bytes.data() + body + edges * sizeof(ends), ends, sizeof(ends));
    }
  }
  static const std::string kEnd = "end_header\n";
  const auto end = std::search(bytes.begin(), bytes.end(), kEnd.begin(), kEnd.end());
  const std::string element =
      "element edge " + std::to_string(edges) + "\nproperty int vertex1\nproperty int vertex2\n";
  bytes.insert(end, element.begin(), element.end());
  return writeFile(path, bytes.data(), bytes.size());
}

}  // namespace

Error
checkCrestExtension(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  for (const char* known : {".vtp", ".ply", ".pcd", ".svg"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "'" + path + "' must be named .vtp, .ply, .pcd or .svg"};
}

Error
saveCrestLines(const std::string& path, const CrestLines& lines, const CrestView& view)
{
  if (Error error = checkCrestExtension(path)) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp") return saveCrestVtp(path, lines);
  if (extension == ".ply") return saveCrestPly(path, lines);
  if (extension == ".pcd") return savePointFile(path, toPointFile(lines));
  if (!(length(cross(view.toward_viewer, view.up)) > 0)) {
    return {ErrorCode::kBadArgument,
            "the view goes along its own up direction, or one of them is 0; change one"};
  }
  const std::string text = crestSvg(lines, view);
  return writeFile(path, text.data(), text.size());
}

}  // namespace pcl_slim
