// SPDX-License-Identifier: BSD-3-Clause
// What is true of points that programs in other languages have moved: the exact shapes of
// tests/support/lab, or the surface of a mesh. Files are bare arrays, as NumPy's tofile() writes
// them.
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "common/run_program.h"
#include "comparison/mesh_surface.h"
#include "pcl_slim/core/file_access.h"
#include "support/lab/scenes.h"

namespace {

using namespace pcl_slim;
using comparison::MeshSurface;
using Place = std::array<double, 3>;

struct Settings {
  std::string shape, points, truth, triangles;
  int make = 0, seed = 1;
  double noise = 0;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("exact_surface", "1",
                      "Makes scans of exact surfaces, and says what is true.");
  options.positional("SURFACE", &s.shape,
                     "sphere, torus, bumpy, relief, or float64 vertices of -triangles");
  options.positional("POINTS", &s.points, "float64 x y z; written with -make, else read");
  options.integer("make", &s.make, 0, 100000000, "make as many points of a shape");
  options.number("noise", &s.noise, 0, 1, "their noise, as a share of the box diagonal");
  options.integer("seed", &s.seed, 0, 1000000, "their seed");
  options.text("truth", &s.truth, "FILE",
               "write six float64 for each point: distance, unit normal and mean curvature of the "
               "surface there, and 1 near a border, else 0; of a mesh the distance alone");
  options.text("triangles", &s.triangles, "FILE", "uint32 corners of the mesh's triangles");
  return options;
}

/** The rows of a bare array. */
template <typename Row>
Result<std::vector<Row>> readRows(const std::string& path) {
  static_assert(std::is_trivially_copyable_v<Row>);
  Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  if (bytes->empty() || bytes->size() % sizeof(Row) != 0)
    return badInput("'" + path + "' has no whole number of rows: write it by NumPy's tofile()");
  std::vector<Row> rows(bytes->size() / sizeof(Row));
  std::memcpy(rows.data(), bytes->data(), bytes->size());
  return rows;
}

Result<std::vector<measure::Truth>> truthOfMesh(const Settings& s,
                                                const std::vector<Place>& points) {
  auto vertices = readRows<Place>(s.shape);
  if (!vertices) return vertices.error();
  auto triangles = readRows<MeshSurface::Triangle>(s.triangles);
  if (!triangles) return triangles.error();
  for (const MeshSurface::Triangle& triangle : *triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= vertices->size())
        return badInput("'" + s.triangles +
                        "' names vertices that do not exist: give its own mesh");
    }
  }
  const MeshSurface surface(std::move(*vertices), std::move(*triangles));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<measure::Truth> truths;
  for (const Place& point : points) {
    const comparison::MeshFoot foot = surface.nearest(point);
    truths.push_back({foot.distance, {kNone, kNone, kNone}, kNone, foot.border});
  }
  return truths;
}

Exit run(const Settings& s) {
  measure::Shape shape = measure::Shape::kSphere;
  if (s.triangles.empty() && !measure::parseShape(s.shape, shape))
    return Exit::usage(badInput("unknown shape '" + s.shape +
                                "'; give sphere, torus, bumpy or relief, or -triangles"));
  if (s.make > 0) {
    if (!s.triangles.empty()) return Exit::usage(badInput("-make makes no points of meshes"));
    const measure::Scene scene = measure::makeScene(shape, static_cast<std::size_t>(s.make),
                                                    s.noise, 0, static_cast<std::uint64_t>(s.seed));
    if (Error error = writeFile(s.points, scene.points.data(), scene.points.size() * 8))
      return error;
  }
  if (s.truth.empty()) return {};
  auto points = readRows<Place>(s.points);
  if (!points) return Exit::usage(points.error());
  std::vector<measure::Truth> truths;
  if (!s.triangles.empty()) {
    auto found = truthOfMesh(s, *points);
    if (!found) return Exit::usage(found.error());
    truths = std::move(*found);
  } else {
    for (const Place& point : *points) truths.push_back(measure::truthAt(shape, point));
  }
  std::vector<std::array<double, 6>> rows;
  for (const measure::Truth& t : truths) {
    rows.push_back(
        {t.distance, t.normal[0], t.normal[1], t.normal[2], t.mean_curvature, t.rim ? 1.0 : 0.0});
  }
  return writeFile(s.truth, rows.data(), rows.size() * sizeof(rows[0]));
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer points", [&] { return run(s); });
}
