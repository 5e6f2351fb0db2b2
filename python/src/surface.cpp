// SPDX-License-Identifier: BSD-3-Clause
// Surface: what it is, its file, its leaves, even samples of it.
#include "surface.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/fit/fit_parameters.h"
#include "pcl_slim/query/surface_samples.h"
#include "pcl_slim/surface/surface_components.h"
#include "pcl_slim/surface/surface_io.h"
#include "work.h"

namespace pcl_slim::python {

std::shared_ptr<const SLIMSurface> Surface::drawn(double min_component, int threads) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (drawn_ && drawn_min_component_ == min_component) return drawn_;
  auto part = std::make_shared<SLIMSurface>(*surface_);
  const DroppedComponents dropped = dropComponents(min_component, *part, threads);
  drawn_ = dropped.components > 0 ? part : surface_;
  drawn_min_component_ = min_component;
  return drawn_;
}

void describeFit(const PointStore& store, const FitParams& params, const FitStatistics& fit,
                 Surface& surface) {
  const double diagonal = store.diagonal() * store.scale();
  const PointStoreStatistics& points = store.statistics();
  py::dict& s = surface.statistics;
  s["points"] = points.input_points;
  s["non_finite"] = points.non_finite;
  s["far_away"] = points.far_away;
  s["without_normal"] = points.without_normal;
  s["duplicates"] = points.duplicates;
  s["outliers"] = fit.outliers;
  s["uncovered"] = fit.uncovered;
  s["unsupported"] = fit.unsupported;
  s["leaves"] = fit.leaves;
  s["levels"] = surface.get().numLevels();
  s["diagonal"] = diagonal;
  s["noise"] = std::sqrt(fit.lambda) * diagonal;
  s["noise_error"] = fit.noise.error;
  s["noise_correlation"] = fit.noise.correlation;
  s["residual"] = fit.rms_error * diagonal;
  s["penalty"] = fit.penalty;
  s["noise_factor"] = fit.noise_factor;
  s["sides_from"] = nameOf(fit.sides.source);
  s["sides_in_doubt"] = fit.sides.in_doubt;
  s["open_leaves"] = fit.open_leaves;
  surface.notes =
      sideNotes(fit.sides.source, fit.sides.normals, "viewpoint=(x, y, z) gives another side");
  for (const auto& unused : {idleParameters(params, fit), overruledParameters(params)}) {
    for (const IdleFitParameter& idle : unused)
      surface.notes.push_back(idle.name + " has no effect: " + idle.reason);
  }
  if (params.sharp_features && !store.hasNormals())
    surface.notes.emplace_back("sharp has no effect: it needs normals");
  for (std::string& note : surface.notes) note = withoutDashes(note);
}

namespace {

/** A leaf as a row of Surface.leaves. */
struct Leaf {
  std::array<double, 3> center;
  double radius;
  std::array<float, 3> normal;
  float error;
  float confidence;
  std::uint8_t degree, level, open, support_limited;
  std::array<float, kMaxCoefficients> coefficients;
};

constexpr const char* kSurfaceDoc = R"doc(A SLIM surface: overlapping balls with a polynomial each.

Made by pcl_slim.fit or pcl_slim.load. It never changes; threads may share it. Coordinates are
those of the points that it was fitted to, in double precision, and lengths are in their unit.
len(surface) is the number of leaves. It can be pickled.)doc";

constexpr const char* kLeavesDoc = R"doc(The leaves, a structured array of shape (len(surface),).

Fields: center (3 float64) and radius (float64), normal (3 float32, unit), error (float32, RMS
residual) and confidence (float32, effective number of points), degree, level (uint8), open and
support_limited (uint8, 0 or 1), coefficients (15 float32, unused ones 0): h(u, v) of
f = w - h, in units of the radius, in the order 1, u, v, uu, uv, vv, uuu ...)doc";

constexpr const char* kSaveDoc = R"doc(save(path, *, quantize=None, color_error=None)

Writes a .slim file, which the programs read, too. quantize rounds it to about a sixth of its bytes:
the surface moves by this share of its residual, and .1 suits most. color_error: greatest error of
the colours in textures, of 255 (0, with quantize 2).)doc";

constexpr const char* kSampleDoc =
    R"doc(sample(*, spacing=None, number=None, seed=1, min_component=50, threads=0,
       progress=None) -> Samples

Spreads points evenly over the surface, inside its borders: no two are nearer than spacing [unit of
the points], and none could be added. number gives how many, in place of a spacing. Components of
fewer than min_component points are left out.)doc";

py::array_t<Leaf> leavesOf(const Surface& surface) {
  const SLIMSurface& s = surface.get();
  const std::vector<std::uint32_t> leaves = s.leaves();
  py::array_t<Leaf> rows(static_cast<py::ssize_t>(leaves.size()));
  Leaf* leaf = rows.mutable_data();
  const auto stride = static_cast<std::size_t>(s.stride());
  for (const std::uint32_t i : leaves) {
    Leaf row{};
    const std::array<float, 3> center{s.cx[i], s.cy[i], s.cz[i]};
    for (std::size_t a = 0; a < 3; ++a)
      row.center[a] = s.info.origin[a] + s.info.scale * static_cast<double>(center[a]);
    row.radius = s.info.scale * static_cast<double>(s.radius[i]);
    row.normal = {s.nx[i], s.ny[i], s.nz[i]};
    row.error = static_cast<float>(s.info.scale * static_cast<double>(s.error[i]));
    row.confidence = s.effective_count[i];
    row.degree = s.degree[i];
    row.level = s.level[i];
    row.open = s.isOpen(i) ? 1 : 0;
    row.support_limited = (s.flags[i] & kSurfelSupportLimited) != 0 ? 1 : 0;
    std::copy_n(s.coefficientsOf(i), stride, row.coefficients.begin());
    *leaf++ = row;
  }
  return rows;
}

double noiseOf(const SLIMSurface& s) {
  return std::sqrt(std::max(0.0, s.info.lambda)) * s.info.diagonal * s.info.scale;
}

std::string counted(std::uint64_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string describe(const Surface& surface) {
  const SLIMSurface& s = surface.get();
  char noise[32];
  std::snprintf(noise, sizeof(noise), "%.3g", noiseOf(s));
  std::string text = "<pcl_slim.Surface: ";
  text += s.numLeaves() == 1 ? "1 leaf" : std::to_string(s.numLeaves()) + " leaves";
  text += " of degree " + std::to_string(s.info.degree) + ", " + counted(s.numLevels(), "level");
  text += ", fitted to " + counted(s.info.num_points, "point") + ", noise " + noise;
  if (s.info.oriented) text += ", oriented";
  if (s.hasTrimMaps()) text += ", with borders";
  if (s.hasColors()) text += s.hasTextures() ? ", textured" : ", coloured";
  return text + ">";
}

void save(const Surface& surface, const py::object& path, const py::kwargs& given) {
  Keywords keywords("save", given);
  SlimRounding rounding;
  rounding.share = keywords.takeNumber("quantize", 0.001, 1, 0);
  rounding.color_error =
      static_cast<int>(keywords.takeInteger("color_error", 0, 32, rounding.share > 0 ? 2 : 0));
  keywords.finish();
  const std::string file = readPath(path);
  if (file.size() < 5 || file.compare(file.size() - 5, 5, ".slim") != 0)
    raiseValue("'" + file +
               "' does not end in .slim, the one format that save() writes: name it so");
  run(py::none(), nullptr,
      [s = surface.shared(), file, rounding](Work&) { return saveSlim(file, *s, rounding); });
}

SurfacePointer surfaceFrom(Result<SLIMSurface> result) {
  if (!result) raise(result.error());
  return std::make_shared<Surface>(std::move(*result));
}

SurfacePointer load(const py::object& path) {
  const std::string file = readPath(path);
  auto loaded = std::make_shared<SLIMSurface>();
  run(py::none(), nullptr, [file, loaded](Work&) {
    Result<SLIMSurface> result = loadSlim(file);
    if (!result) return result.error();
    *loaded = std::move(*result);
    return Error();
  });
  return std::make_shared<Surface>(std::move(*loaded));
}

py::tuple pickled(const Surface& surface) {
  std::vector<unsigned char> bytes;
  {
    const py::gil_scoped_release release;
    bytes = encodeSlim(surface.get());
  }
  return py::make_tuple(py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
                        surface.notes, surface.statistics);
}

SurfacePointer unpickled(const py::tuple& state) {
  if (state.size() != 3) raiseValue("this is no pickled surface: pickle it again");
  const std::string_view bytes = state[0].cast<std::string_view>();
  SurfacePointer surface =
      surfaceFrom(decodeSlim(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  surface->notes = state[1].cast<std::vector<std::string>>();
  surface->statistics = state[2].cast<py::dict>();
  return surface;
}

py::handle samples_type;

py::object sample(const Surface& surface, const py::kwargs& given) {
  Keywords keywords("sample", given);
  struct State {
    SurfaceSamples samples;
  };
  SurfaceSampleParams params;
  params.spacing = keywords.takeNumber("spacing", 1e-300, 1e300, 0);
  params.count = static_cast<std::uint64_t>(keywords.takeInteger("number", 0, 100000000, 0));
  params.seed = static_cast<std::uint64_t>(
      keywords.takeInteger("seed", 0, std::int64_t{1000000000000000000}, 1));
  const double least = keywords.takeNumber("min_component", 0, 1e12, kLeastComponentPoints);
  params.threads = keywords.takeThreads();
  const py::object progress = keywords.take("progress");
  keywords.finish();
  if (params.spacing == 0 && params.count == 0)
    raiseValue("sample() has no density: give spacing or number");
  if (params.spacing > 0 && params.count > 0)
    raiseValue("spacing and number exclude each other: give one");
  auto state = std::make_shared<State>();
  const auto* source = &surface;
  // The surface outlives the work: its shared part is kept, and drawn() is evaluated before.
  std::shared_ptr<const SLIMSurface> drawn;
  {
    const py::gil_scoped_release release;
    drawn = source->drawn(least, params.threads);
  }
  run(progress, state, [drawn, params, state = state.get()](Work& work) {
    return sampleSurface(*drawn, params, state->samples, work.progress());
  });
  SurfaceSamples& s = state->samples;
  const auto n = static_cast<py::ssize_t>(s.size());
  const std::shared_ptr<State> owner = state;
  const auto* curvature = s.curvature.empty() ? nullptr : s.curvature.front().data();
  py::array_t<float> mean(n), gaussian(n);
  for (py::ssize_t i = 0; i < n; ++i) {
    mean.mutable_at(i) = curvature[2 * i];
    gaussian.mutable_at(i) = curvature[2 * i + 1];
  }
  const py::object colors = s.color.empty()
                                ? py::object(py::none())
                                : py::object(viewOf(owner, s.color.front().data(), {n, 3}));
  const auto column = [&](const auto& values) {
    return viewOf(owner, values.empty() ? nullptr : values.front().data(), {n, 3});
  };
  return samples_type(column(s.position), column(s.normal), mean, gaussian, colors, s.spacing);
}

void bindProperties(py::class_<Surface, SurfacePointer>& type) {
  type.def_property_readonly("leaves", &leavesOf, kLeavesDoc)
      .def_property_readonly(
          "num_surfels", [](const Surface& s) { return s.get().size(); },
          "Number of surfels: leaves and internal ones (int).")
      .def_property_readonly(
          "degree", [](const Surface& s) { return s.get().info.degree; },
          "Highest degree of the polynomials, 1 to 4 (int).")
      .def_property_readonly(
          "noise", [](const Surface& s) { return noiseOf(s.get()); },
          "RMS error of the points about the surface, in their unit (float).")
      .def_property_readonly(
          "diagonal", [](const Surface& s) { return s.get().info.diagonal * s.get().info.scale; },
          "Diagonal of the points' bounding box, in their unit (float).")
      .def_property_readonly(
          "num_points", [](const Surface& s) { return s.get().info.num_points; },
          "Number of points that the surface was fitted to (int).")
      .def_property_readonly(
          "oriented", [](const Surface& s) { return s.get().info.oriented; },
          "Whether normals, sensors or sides of thin parts decided the side (bool).")
      .def_property_readonly(
          "has_colors", [](const Surface& s) { return s.get().hasColors(); },
          "Whether the surface has colours (bool).")
      .def_property_readonly(
          "notes", [](const Surface& s) { return s.notes; },
          "What a user may want otherwise of the fit, a sentence each (list of str).")
      .def_property_readonly(
          "statistics", [](const Surface& s) { return py::dict(s.statistics.attr("copy")()); },
          "What the fit did and left out (dict); empty of a surface that was loaded.");
}

}  // namespace

void bindSurface(py::module_& m, py::class_<Surface, SurfacePointer>& type) {
  PYBIND11_NUMPY_DTYPE(Leaf, center, radius, normal, error, confidence, degree, level, open,
                       support_limited, coefficients);
  samples_type = namedTuple(m, "Samples", "positions normals mean gaussian colors spacing",
                            "Even samples of a surface: positions (n, 3) float64, unit normals (n, "
                            "3) float32, mean [1/length] "
                            "and Gaussian curvature [1/length^2] (n,) float32, colors (n, 3) uint8 "
                            "or None, and the least "
                            "distance of two samples (float).");
  type.doc() = kSurfaceDoc;
  bindProperties(type);
  type.def("__len__", [](const Surface& s) { return s.get().numLeaves(); })
      .def("__repr__", &describe)
      .def("save", &save, py::arg("path"), kSaveDoc)
      .def("sample", &sample, kSampleDoc)
      .def(py::pickle(&pickled, &unpickled));
  m.def("load", &load, py::arg("path"),
        "load(path) -> Surface\n\nReads a .slim file of Surface.save() or of pcl_slim_fit.");
}

}  // namespace pcl_slim::python
