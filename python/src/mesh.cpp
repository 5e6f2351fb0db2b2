// SPDX-License-Identifier: BSD-3-Clause
// Surface.mesh() and the triangles that it returns.
#include "mesh.h"

#include <string>
#include <utility>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/query/surface_probe.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr const char* kMeshDoc =
    R"doc(mesh(*, tolerance=None, max_triangles=None, trim=True, hole=6.0, watertight=False,
     min_component=50, relax=2, sharp=None, threads=0, progress=None) -> Mesh

Triangulates the surface, as pcl_slim_mesh does. tolerance: largest distance between mesh and
surface [unit of the points]; None: a quarter of the noise, at least 1e-4 of the box diagonal.
max_triangles: edges are collapsed until there are no more. trim: end the mesh where the data end.
hole: diameter of the smallest hole kept [spacings of the points], 0: all. watertight: close every
border. min_component: components of fewer points are left out. relax: rounds that make triangles more
even. sharp: a second Surface of the same points, fitted with sharp=True, whose edges the mesh gets.)doc";

constexpr const char* kMeshClassDoc =
    R"doc(Triangles over shared vertices, without non-manifold edges. Its columns are views, not copies.

vertices (v, 3) float64 in the coordinates of the points, triangles (t, 3) int32, counter-clockwise seen
from outside, normals (v, 3) float32, k1 and k2 (v,) float32 [1/length], colors (v, 3) uint8 or None.)doc";

std::string describe(const Mesh& mesh) {
  const MeshCensus& c = mesh.statistics.census;
  return "<pcl_slim.Mesh: " + std::to_string(c.vertices) + " vertices, " +
         std::to_string(c.triangles) + " triangles, " + std::to_string(c.components) +
         (c.components == 1 ? " component, " : " components, ") +
         (c.border_edges == 0
              ? std::string("closed")
              : std::to_string(mesh.statistics.border_loops) +
                    (mesh.statistics.border_loops == 1 ? " border loop" : " border loops")) +
         (mesh.triangles.colors.empty() ? ">" : ", coloured>");
}

MeshPointer mesh(const SurfacePointer& surface, const py::kwargs& given) {
  struct State {
    std::shared_ptr<const SLIMSurface> surface, sharp;
    MeshParams params;
    MeshPointer mesh = std::make_shared<Mesh>();
  };
  Keywords keywords("mesh", given);
  auto state = std::make_shared<State>();
  MeshParams& p = state->params;
  p.tolerance = keywords.takeNumber("tolerance", 0, 1e12, 0);
  p.max_triangles = static_cast<std::uint64_t>(
      keywords.takeInteger("max_triangles", 0, std::int64_t{1000000000000000000}, 0));
  p.trim = keywords.takeSwitch("trim", true);
  p.hole_size = keywords.takeNumber("hole", 0, 1e6, p.hole_size);
  p.watertight = keywords.takeSwitch("watertight", false);
  p.min_component_points = keywords.takeNumber("min_component", 0, 1e12, p.min_component_points);
  p.relax = static_cast<int>(keywords.takeInteger("relax", 0, 100, p.relax));
  p.threads = keywords.takeThreads();
  const py::object sharp = keywords.take("sharp");
  const py::object progress = keywords.take("progress");
  keywords.finish();
  if (!sharp.is_none()) {
    if (!py::isinstance<Surface>(sharp))
      raiseValue("sharp is no Surface: pass one of pcl_slim.fit(points, normals, sharp=True)");
    state->sharp = sharp.cast<SurfacePointer>()->shared();
    p.sharp = state->sharp.get();
  }
  if (Error error = p.validate()) raise(error);
  state->surface = surface->shared();
  run(progress, state, [s = state.get()](Work& work) {
    TriangleMesh& triangles = s->mesh->triangles;
    Error error =
        extractMesh(*s->surface, s->params, triangles, &s->mesh->statistics, work.progress());
    if (error) return error;
    triangles.colors =
        surfaceColors(*s->surface, triangles.vertices, triangles.normals, s->params.threads);
    return Error();
  });
  return state->mesh;
}

template <typename Row>
py::array rowsOf(const MeshPointer& mesh, const std::vector<Row>& values) {
  return viewOf(mesh, values.empty() ? nullptr : values.front().data(),
                {static_cast<py::ssize_t>(values.size()), 3});
}

/** Indices as int32, the type that other packages take: there are fewer than 2^31 vertices. */
py::array trianglesOf(const MeshPointer& mesh) {
  const auto& triangles = mesh->triangles.triangles;
  const auto* first = triangles.empty() ? nullptr : triangles.front().data();
  return viewOf(mesh, reinterpret_cast<const std::int32_t*>(first),
                {static_cast<py::ssize_t>(triangles.size()), 3});
}

py::object colorsOf(const MeshPointer& mesh) {
  if (mesh->triangles.colors.empty()) return py::none();
  return rowsOf(mesh, mesh->triangles.colors);
}

py::dict statisticsOf(const Mesh& mesh) {
  const MeshStatistics& m = mesh.statistics;
  py::dict s;
  s["vertices"] = m.census.vertices;
  s["triangles"] = m.census.triangles;
  s["components"] = m.census.components;
  s["border_edges"] = m.census.border_edges;
  s["nonmanifold"] = m.census.nonmanifold_edges + m.census.nonmanifold_vertices;
  s["euler"] = m.census.euler;
  s["tolerance"] = m.tolerance;
  s["area"] = m.area;
  s["border_loops"] = m.border_loops;
  s["sheet_ends"] = m.sheet_ends;
  s["widest_hole"] = m.widest_hole;
  s["closed_holes"] = m.closed_holes;
  s["closed_area"] = m.closed_area;
  s["dropped_components"] = m.dropped_components + m.left_out.components;
  return s;
}

}  // namespace

void bindMesh(py::class_<Surface, SurfacePointer>& type, py::class_<Mesh, MeshPointer>& mesh_type) {
  mesh_type.doc() = kMeshClassDoc;
  mesh_type.def("__repr__", &describe)
      .def("__len__", [](const Mesh& mesh) { return mesh.triangles.triangles.size(); })
      .def_property_readonly(
          "vertices", [](const MeshPointer& s) { return rowsOf(s, s->triangles.vertices); },
          "Places of the vertices, (v, 3) float64.")
      .def_property_readonly("triangles", &trianglesOf, "Vertices of each triangle, (t, 3) int32.")
      .def_property_readonly(
          "normals", [](const MeshPointer& s) { return rowsOf(s, s->triangles.normals); },
          "Unit normals of the surface at the vertices, (v, 3) float32.")
      .def_property_readonly(
          "k1",
          [](const MeshPointer& s) {
            return viewOf(s, s->triangles.k1.data(), {py::ssize_t(s->triangles.k1.size())});
          },
          "Greatest curvature at the vertices [1/length], (v,) float32; 0 where holes were closed.")
      .def_property_readonly(
          "k2",
          [](const MeshPointer& s) {
            return viewOf(s, s->triangles.k2.data(), {py::ssize_t(s->triangles.k2.size())});
          },
          "Least curvature at the vertices [1/length], (v,) float32.")
      .def_property_readonly("colors", &colorsOf,
                             "Red, green, blue of the surface, (v, 3) uint8, or None.")
      .def_property_readonly("statistics", &statisticsOf,
                             "What the mesh is and what was left out or closed (dict).");
  type.def("mesh", &mesh, kMeshDoc);
}

}  // namespace pcl_slim::python
