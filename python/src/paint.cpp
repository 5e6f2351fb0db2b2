// SPDX-License-Identifier: BSD-3-Clause
// Surface.paint(): the colours of another cloud.
#include <string>
#include <utility>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/fit/fit_colors.h"
#include "surface.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr const char* kPaintDoc =
    R"doc(paint(points, colors, normals=None, *, threads=0) -> Surface

A copy of the surface with the colours of another registered cloud, as a photogrammetric one. The
programs' -colors does the same.

points   (n, 3) float32 or float64, in the surface's coordinates and unit, or of a part of it. Points
         farther than half a radius from the surface are left out
colors   (n, 3) red, green, blue of these points: uint8, or numbers from 0 to 1, 255 or 65535
normals  (n, 3), any length: they choose the side of a thin part of an oriented surface
threads  0: all cores; never changes the result

Leaves that no point is near keep their colour, and are grey if the surface had none. statistics of the
copy gets colors_near, the number of points near the surface, painted_leaves, and
colors_normals_opposed: whether most normals opposed the surface's, so that they were not used.
Raises ValueError where no point is near the surface.)doc";

/** What a user may want otherwise of a painted surface. */
void describePaint(const PaintStatistics& painted, bool had_colors, Surface& surface) {
  surface.statistics["colors_near"] = painted.points;
  surface.statistics["painted_leaves"] = painted.painted;
  surface.statistics["colors_normals_opposed"] = painted.normals_opposed;
  if (painted.painted < painted.leaves) {
    surface.notes.push_back(std::to_string(painted.leaves - painted.painted) + " of " +
                            std::to_string(painted.leaves) +
                            " leaves have no point of the painting cloud near them: they " +
                            (had_colors ? "keep their colours" : "are grey"));
  }
  if (painted.normals_opposed) {
    surface.notes.emplace_back(
        "most normals of the painting cloud oppose the surface's: they were not used");
  }
}

SurfacePointer paint(const SurfacePointer& surface, const py::object& points,
                     const py::object& colors, const py::object& normals, const py::kwargs& given) {
  struct State {
    std::shared_ptr<const SLIMSurface> source;
    Scan cloud;
    SLIMSurface surface;
    PaintStatistics painted;
  };
  Keywords keywords("paint", given);
  const int threads = keywords.takeThreads();
  keywords.finish();
  if (colors.is_none())
    raiseValue("colors is None: pass (n, 3), red, green and blue of each point");
  auto state = std::make_shared<State>();
  state->source = surface->shared();
  state->cloud = readScan({points, normals, colors});
  run(py::none(), state, [s = state.get(), threads](Work&) {
    s->surface = *s->source;
    auto painted = paintColors(s->cloud.view(), s->cloud.colors(), threads, s->surface);
    if (!painted) return painted.error();
    s->painted = *painted;
    return Error();
  });
  auto copy = std::make_shared<Surface>(std::move(state->surface));
  copy->notes = surface->notes;
  copy->statistics = surface->statistics.attr("copy")();
  describePaint(state->painted, surface->get().hasColors(), *copy);
  return copy;
}

}  // namespace

void bindPaint(py::class_<Surface, SurfacePointer>& type) {
  type.def("paint", &paint, py::arg("points"), py::arg("colors"), py::arg("normals") = py::none(),
           kPaintDoc);
}

}  // namespace pcl_slim::python
