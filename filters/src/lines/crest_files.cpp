// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/crest_files.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cstring>

#include "io/ply_file.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

/** The vertices of a line in order; a closed one's first again at the end. */
std::vector<std::uint32_t>
pathOf(const CrestLines& lines, std::size_t line)
{
  std::vector<std::uint32_t> path;
  for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
    path.push_back(v);
  }
  if (lines.closed[line] != 0) path.push_back(lines.line_begin[line]);
  return path;
}

template <typename Array, typename Value>
void
addArray(vtkDataSetAttributes* data, const char* name, std::size_t count, int components,
         const Value& value)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < components; ++k) {
      array->SetComponent(static_cast<vtkIdType>(i), k,
                          static_cast<double>(value(i, static_cast<std::size_t>(k))));
    }
  }
  data->AddArray(array);
}

void
addPointData(const CrestLines& lines, vtkDataSetAttributes* data)
{
  const auto vectors = [&](const char* name, const std::vector<std::array<float, 3>>& values) {
    addArray<vtkFloatArray>(data, name, values.size(), 3,
                            [&](std::size_t i, std::size_t k) { return values[i][k]; });
  };
  const auto scalars = [&](const char* name, const std::vector<float>& values) {
    addArray<vtkFloatArray>(data, name, values.size(), 1,
                            [&](std::size_t i, std::size_t) { return values[i]; });
  };
  vectors("Normals", lines.normal);
  vectors("tangent", lines.tangent);
  scalars("k1", lines.k1);
  scalars("k2", lines.k2);
  scalars("prominence", lines.prominence);
  scalars("significance", lines.significance);
  scalars("radius", lines.radius);
}

void
addCellData(const CrestLines& lines, vtkDataSetAttributes* data)
{
  const auto scalars = [&](const char* name, const auto& values) {
    addArray<vtkDoubleArray>(data, name, values.size(), 1, [&](std::size_t i, std::size_t) {
      return static_cast<double>(values[i]);
    });
  };
  scalars("type", lines.type);
  scalars("closed", lines.closed);
  scalars("length", lines.length);
  scalars("strength", lines.strength);
  scalars("significance", lines.mean_significance);
}

Error
saveCrestVtp(const std::string& path, const CrestLines& lines)
{
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const auto& p : lines.position) points->InsertNextPoint(p[0], p[1], p[2]);
  data->SetPoints(points);
  vtkNew<vtkCellArray> cells;
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    const auto path_of_line = pathOf(lines, line);
    cells->InsertNextCell(static_cast<int>(path_of_line.size()));
    for (const std::uint32_t v : path_of_line) cells->InsertCellPoint(static_cast<vtkIdType>(v));
  }
  data->SetLines(cells);
  addPointData(lines, data->GetPointData());
  addCellData(lines, data->GetCellData());
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0) {
    return {ErrorCode::kIo,
            "cannot write '" + path + "': VTK refused the data; write a .ply file instead"};
  }
  const std::string text = writer->GetOutputString();
  return writeFile(path, text.data(), text.size());
}

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
