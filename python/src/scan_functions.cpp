// SPDX-License-Identifier: BSD-3-Clause
// What is done with a scan's points and their surface: smooth, curvature, normals and covariances,
// each after a fit or with a surface that is given; and Surface.project().

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <utility>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/scan/scan.h"
#include "scan_state.h"
#include "surface.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kChunk = 4096;

py::handle curvature_type, normals_type, projection_type;

constexpr const char* kSmoothDoc =
    R"doc(smooth(points, normals=None, *, surface=None, threads=0, progress=None, **options) -> ndarray

Moves points onto their surface, as pcl_slim_smooth does. Returns an array of the shape and type of
points, in their order and coordinates. Points that no surface supports, and rows with NaN, stay as
they are. Fits first, with the options of pcl_slim.fit, unless a surface is given; that of another
cloud, which supports less than a tenth of the points, is an error. Points that are nowhere a surface
are returned as they are, with a RuntimeWarning.)doc";

constexpr const char* kCurvatureDoc =
    R"doc(curvature(points, normals=None, *, surface=None, directions=False, threads=0, progress=None,
          **options) -> Curvature

Curvatures of the points' surface, as pcl_slim_curvature gives them, float32: k1 >= k2, mean (n,)
[1/length of the points' unit], gaussian (n,) [1/length^2], unit normals (n, 3), and with directions
the unit tangents of k1 and k2 (n, 3), else None. Positive where the surface bends away from its
normal. NaN where no surface supports a point. Options as of smooth.)doc";

constexpr const char* kNormalsDoc =
    R"doc(normals(points, normals=None, *, surface=None, threads=0, progress=None, **options) -> Normals

Oriented unit normals (n, 3) float32 of the points' surface, and their confidence (n,) float32: the
effective number of points behind each, 0 where no surface supports the point. There the normal is
that of the plane through 30 neighbours. NaN for rows with NaN. Options as of smooth.)doc";

constexpr const char* kCovariancesDoc =
    R"doc(covariances(points, normals=None, *, surface=None, epsilon=1e-3, threads=0, progress=None,
            **options) -> ndarray

Covariances (n, 3, 3) float64 of points for generalised ICP, as small_gicp and PCL use them: 1 along
the surface and epsilon across it, by the surface's normals. The unit matrix where the normal is not
known. small_gicp.PointCloud takes list(covariances). Options as of smooth.)doc";

constexpr const char* kProjectDoc =
    R"doc(project(points, normals=None, *, viewpoint=None, reach=0.0, threads=0, progress=None) -> Projection

Where the surface is next to points, which need not be those that it was fitted to:
positions  (n, 3), the type of points: on the surface; a point's own place where nothing is near
normals    (n, 3) float32: the surface's, unit, on its own side
k1, k2     (n,) float32: principal curvatures [1/length], k1 >= k2
distance   (n,) float64: between a point and its position
side       (n,) int8: 1 before the surface, on the side of its normals, -1 behind it, 0 unknown
sigma, sigma_normal, sigma_curvature
           (n,) float32: standard errors of the position along the normal, of the normal [rad] and of
           the mean curvature; 95 % are within 1.96, 1.73 and 1.96 of these
All but positions are NaN, or 0, where no surface is near. normals choose the side of a thin part.
Points count as measurements: those much farther away than the residuals have no surface near. With
reach > 0 they are places, and balls count that are up to this share of their radius away.)doc";

/** Calls body(i) for all points, in parallel. */
template <typename Body>
void forPoints(const ScanState& s, const Body& body) {
  parallelFor(s.projection.size(), resolveThreads(s.params.threads), kChunk,
              [&](std::size_t i, int) { body(i); });
}

void put(const std::array<float, 3>& values, float* to) {
  std::copy(values.begin(), values.end(), to);
}

/** The projected point; all NaN where the input is not finite. */
ProjectedPoint pointAt(const CloudProjection& projection, std::size_t i) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  return projection.isFinite(i) ? projection.point(i)
                                : CloudProjection::unknownPoint({kNan, kNan, kNan});
}

/** Positions in the type of the points: those that are moved, others as they are. */
class Positions {
 public:
  explicit Positions(const Rows& rows)
      : rows_(rows),
        array_(rows.isFloat()
                   ? py::array(newArray<float>({static_cast<py::ssize_t>(rows.size), 3}))
                   : py::array(newArray<double>({static_cast<py::ssize_t>(rows.size), 3}))),
        data_(static_cast<unsigned char*>(array_.mutable_data())) {}

  void keep(std::size_t i) const {
    const std::size_t bytes = rows_.isFloat() ? 3 * sizeof(float) : 3 * sizeof(double);
    std::memcpy(data_ + i * bytes,
                static_cast<const unsigned char*>(rows_.data()) + i * rows_.stride, bytes);
  }
  void set(std::size_t i, const std::array<double, 3>& position) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (rows_.isFloat())
        reinterpret_cast<float*>(data_)[3 * i + a] = static_cast<float>(position[a]);
      else
        reinterpret_cast<double*>(data_)[3 * i + a] = position[a];
    }
  }
  const py::array& array() const { return array_; }

 private:
  const Rows& rows_;
  py::array array_;
  unsigned char* data_;
};

py::object smooth(const py::object& points, const py::object& normals, const SurfacePointer& own,
                  const py::kwargs& given) {
  Keywords keywords("smooth", given);
  const auto state = readState(points, normals, own, keywords);
  const py::object progress = keywords.take("progress");
  keywords.finish();
  const auto positions = std::make_shared<Positions>(state->scan.points);
  const auto both =
      std::make_shared<std::pair<decltype(state), decltype(positions)>>(state, positions);
  run(progress, both, [s = state.get(), out = positions.get()](Work& work) {
    if (Error error = fitAndProject(*s, true, work)) return error;
    forPoints(*s, [&](std::size_t i) {
      if (s->projection.isSupported(i))
        out->set(i, s->projection.point(i).position);
      else
        out->keep(i);
    });
    return Error();
  });
  if (state->no_surface) {
    const char* text = "the points are nowhere a surface: they are returned as they are";
    if (PyErr_WarnEx(PyExc_RuntimeWarning, text, 1) != 0) throw py::error_already_set();
  }
  return positions->array();
}

/** Outputs of curvature(), which the work fills. */
struct CurvatureColumns {
  std::shared_ptr<ScanState> scan;
  py::array_t<float> k1, k2, mean, gaussian, normals, direction1, direction2;
  float *k1_at, *k2_at, *mean_at, *gaussian_at, *normal_at, *first_at = nullptr,
                                                            *second_at = nullptr;

  CurvatureColumns(std::shared_ptr<ScanState> state, bool directions) : scan(std::move(state)) {
    const auto n = static_cast<py::ssize_t>(scan->scan.size());
    for (auto* column : {&k1, &k2, &mean, &gaussian}) *column = newArray<float>({n});
    normals = newArray<float>({n, 3});
    k1_at = k1.mutable_data();
    k2_at = k2.mutable_data();
    mean_at = mean.mutable_data();
    gaussian_at = gaussian.mutable_data();
    normal_at = normals.mutable_data();
    if (!directions) return;
    direction1 = newArray<float>({n, 3});
    direction2 = newArray<float>({n, 3});
    first_at = direction1.mutable_data();
    second_at = direction2.mutable_data();
  }

  void set(std::size_t i, const ProjectedPoint& point) const {
    k1_at[i] = point.principal.k1;
    k2_at[i] = point.principal.k2;
    mean_at[i] = point.mean_curvature;
    gaussian_at[i] = point.gaussian_curvature;
    put(point.normal, normal_at + 3 * i);
    if (first_at == nullptr) return;
    put(point.principal.direction1, first_at + 3 * i);
    put(point.principal.direction2, second_at + 3 * i);
  }
};

py::object curvature(const py::object& points, const py::object& normals, const SurfacePointer& own,
                     const py::kwargs& given) {
  Keywords keywords("curvature", given);
  const bool directions = keywords.takeSwitch("directions", false);
  const auto state = readState(points, normals, own, keywords);
  const py::object progress = keywords.take("progress");
  keywords.finish();
  state->wanted.directions = state->wanted.planes = true;
  state->wanted.variation = false;
  const auto columns = std::make_shared<CurvatureColumns>(state, directions);
  run(progress, columns, [s = state.get(), out = columns.get()](Work& work) {
    if (Error error = fitAndProject(*s, false, work)) return error;
    forPoints(*s, [&](std::size_t i) { out->set(i, pointAt(s->projection, i)); });
    return Error();
  });
  const auto optional = [&](const py::array& array) {
    return directions ? py::object(array) : py::object(py::none());
  };
  return curvature_type(columns->k1, columns->k2, columns->mean, columns->gaussian,
                        columns->normals, optional(columns->direction1),
                        optional(columns->direction2));
}

/** The effective number of points behind the surface at each projected point; 0 where it supports
 * none. In the order along a Morton curve, in which balls of one request serve the next. */
Error measureConfidence(const ScanState& s, float* confidence) {
  constexpr std::size_t kRun = 64;  // the result depends on runs, not on threads
  Result<PointStore> built =
      s.store() ? Result<PointStore>(PointStore()) : PointStore::build(s.view(), s.params.threads);
  if (!built) return built.error();
  const PointStore& store = s.store() ? *s.store() : *built;
  const SLIMSurface& surface = s.surface();
  const ProbeIndex index(surface);
  const int threads = resolveThreads(s.params.threads);
  std::deque<SurfaceProbe> probes;
  for (int t = 0; t < threads; ++t) probes.emplace_back(index);
  std::fill_n(confidence, s.projection.size(), 0.0f);
  const auto& order = store.orderOfStore();
  const std::size_t count = store.size();
  parallelFor((count + kRun - 1) / kRun, threads, 16, [&](std::size_t run, int thread) {
    SurfaceProbe& probe = probes[static_cast<std::size_t>(thread)];
    probe.restart(0);
    for (std::size_t k = run * kRun; k < std::min((run + 1) * kRun, count); ++k) {
      const std::size_t i = order[k];
      if (!s.projection.isSupported(i)) continue;
      const std::array<float, 3> n = s.projection.surfaceNormal(i);
      const Vector3 place = scaled(subtract(s.projection.point(i).position, surface.info.origin),
                                   1 / surface.info.scale);
      confidence[i] = static_cast<float>(probe.scaleAt(place, {n[0], n[1], n[2]}).effective_count);
    }
  });
  // Points that were merged have that of the one that stands for them; strays have none.
  const std::vector<std::uint32_t> stored = store.storeOfInput();
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i] != PointStore::kSkipped && order[stored[i]] != i)
      confidence[i] = confidence[order[stored[i]]];
  }
  return {};
}

py::object normalsOf(const py::object& points, const py::object& normals, const SurfacePointer& own,
                     const py::kwargs& given) {
  struct State {
    std::shared_ptr<ScanState> scan;
    py::array_t<float> normals, confidence;
  };
  Keywords keywords("normals", given);
  auto state = std::make_shared<State>();
  state->scan = readState(points, normals, own, keywords);
  const py::object progress = keywords.take("progress");
  keywords.finish();
  state->scan->wanted.planes = true;
  state->scan->wanted.variation = false;
  const auto n = static_cast<py::ssize_t>(state->scan->scan.size());
  state->normals = newArray<float>({n, 3});
  state->confidence = newArray<float>({n});
  float* const normal = state->normals.mutable_data();
  float* const confidence = state->confidence.mutable_data();
  run(progress, state, [s = state->scan.get(), normal, confidence](Work& work) {
    if (Error error = fitAndProject(*s, false, work)) return error;
    forPoints(*s, [&](std::size_t i) { put(pointAt(s->projection, i).normal, normal + 3 * i); });
    return measureConfidence(*s, confidence);
  });
  return normals_type(state->normals, state->confidence);
}

py::object covariances(const py::object& points, const py::object& normals,
                       const py::kwargs& given) {
  struct State {
    std::shared_ptr<ScanState> scan;
    py::array_t<double> covariances;
  };
  Keywords keywords("covariances", given);
  const double epsilon = keywords.takeNumber("epsilon", 1e-12, 1, 1e-3);
  auto state = std::make_shared<State>();
  state->scan = readState(points, normals, nullptr, keywords);
  const py::object progress = keywords.take("progress");
  keywords.finish();
  state->scan->wanted.planes = true;
  state->scan->wanted.variation = false;
  const auto n = static_cast<py::ssize_t>(state->scan->scan.size());
  state->covariances = newArray<double>({n, 3, 3});
  double* const first = state->covariances.mutable_data();
  run(progress, state, [s = state->scan.get(), first, epsilon](Work& work) {
    if (Error error = fitAndProject(*s, false, work)) return error;
    forPoints(*s, [&](std::size_t i) {
      std::array<float, 3> normal = pointAt(s->projection, i).normal;
      if (!isFinite(normal)) normal = {};
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) {
          const double product = static_cast<double>(normal[a]) * static_cast<double>(normal[b]);
          first[9 * i + 3 * a + b] = (a == b ? 1.0 : 0.0) - (1 - epsilon) * product;
        }
      }
    });
    return Error();
  });
  return state->covariances;
}

/** Outputs of project(). */
struct ProjectionColumns {
  std::shared_ptr<ScanState> scan;
  Positions positions;
  py::array_t<float> normals, k1, k2, sigma, sigma_normal, sigma_curvature;
  py::array_t<double> distance;
  py::array_t<std::int8_t> side;
  float *normal_at, *k1_at, *k2_at, *sigma_at, *sigma_normal_at, *sigma_curvature_at;
  double* distance_at;
  std::int8_t* side_at;

  explicit ProjectionColumns(std::shared_ptr<ScanState> state)
      : scan(std::move(state)), positions(scan->scan.points) {
    const auto n = static_cast<py::ssize_t>(scan->scan.size());
    normals = newArray<float>({n, 3});
    k1 = newArray<float>({n});
    k2 = newArray<float>({n});
    sigma = newArray<float>({n});
    sigma_normal = newArray<float>({n});
    sigma_curvature = newArray<float>({n});
    distance = newArray<double>({n});
    side = newArray<std::int8_t>({n});
    normal_at = normals.mutable_data();
    k1_at = k1.mutable_data();
    k2_at = k2.mutable_data();
    sigma_at = sigma.mutable_data();
    sigma_normal_at = sigma_normal.mutable_data();
    sigma_curvature_at = sigma_curvature.mutable_data();
    distance_at = distance.mutable_data();
    side_at = side.mutable_data();
  }

  void setUnknown(std::size_t i) const {
    positions.keep(i);
    put({kUnknown, kUnknown, kUnknown}, normal_at + 3 * i);
    k1_at[i] = k2_at[i] = kUnknown;
    sigma_at[i] = sigma_normal_at[i] = sigma_curvature_at[i] = kUnknown;
    distance_at[i] = std::numeric_limits<double>::quiet_NaN();
    side_at[i] = 0;
  }

  /** On the surface's own side, whatever the normals that were given. */
  void set(std::size_t i, const CloudProjection& projection) const {
    const ProjectedPoint point = projection.point(i);
    const std::array<float, 3> own = projection.surfaceNormal(i);
    const Vector3 normal{own[0], own[1], own[2]};
    const bool turned =
        own[0] * point.normal[0] + own[1] * point.normal[1] + own[2] * point.normal[2] < 0;
    const Vector3 from = subtract(scan->view().position(i), point.position);
    const double before = dot(from, normal);
    positions.set(i, point.position);
    put(own, normal_at + 3 * i);
    k1_at[i] = turned ? -point.principal.k2 : point.principal.k1;
    k2_at[i] = turned ? -point.principal.k1 : point.principal.k2;
    distance_at[i] = length(from);
    sigma_at[i] = point.errors.position;
    sigma_normal_at[i] = point.errors.normal;
    sigma_curvature_at[i] = point.errors.curvature;
    side_at[i] = static_cast<std::int8_t>(before > 0 ? 1 : before < 0 ? -1 : 0);
  }
};

bool hasFinite(const CloudView& view) {
  for (std::size_t i = 0; i < view.size; ++i) {
    if (isFinite(view.position(i))) return true;
  }
  return false;
}

py::object project(const SurfacePointer& surface, const py::object& points,
                   const py::object& normals, const py::kwargs& given) {
  Keywords keywords("project", given);
  auto state = std::make_shared<ScanState>();
  state->given = surface->shared();
  CloudProjectionParams params;
  params.viewpoint = readPlace(keywords.take("viewpoint"), "viewpoint");
  params.projection.reach = keywords.takeNumber("reach", 0, 1, 0);
  params.projection.directions = params.projection.errors = true;
  state->params.threads = params.projection.threads = keywords.takeThreads();
  const py::object progress = keywords.take("progress");
  keywords.finish();
  state->scan = readScan({points, normals});
  const auto columns = std::make_shared<ProjectionColumns>(state);
  run(progress, columns, [s = state.get(), out = columns.get(), params](Work& work) {
    s->projection = CloudProjection::ofNothing(s->scan.size());
    if (hasFinite(s->view())) {
      auto made = CloudProjection::make(s->view(), *s->given, params, work.progress());
      if (!made) return made.error();
      s->projection = std::move(*made);
    }
    forPoints(*s, [&](std::size_t i) {
      if (s->projection.isSupported(i))
        out->set(i, s->projection);
      else
        out->setUnknown(i);
    });
    return Error();
  });
  return projection_type(columns->positions.array(), columns->normals, columns->k1, columns->k2,
                         columns->distance, columns->side, columns->sigma, columns->sigma_normal,
                         columns->sigma_curvature);
}

}  // namespace

void bindScanFunctions(py::module_& m, py::class_<Surface, SurfacePointer>& type) {
  curvature_type = namedTuple(m, "Curvature", "k1 k2 mean gaussian normals direction1 direction2",
                              kCurvatureDoc);
  normals_type = namedTuple(m, "Normals", "normals confidence", kNormalsDoc);
  projection_type = namedTuple(
      m, "Projection", "positions normals k1 k2 distance side sigma sigma_normal sigma_curvature",
      kProjectDoc);
  define(m, type, "smooth", &smooth, kSmoothDoc);
  define(m, type, "curvature", &curvature, kCurvatureDoc);
  define(m, type, "normals", &normalsOf, kNormalsDoc);
  m.def("covariances", &covariances, py::arg("points"), py::arg("normals") = py::none(),
        kCovariancesDoc);
  type.def("project", &project, py::arg("points"), py::arg("normals") = py::none(), kProjectDoc);
}

}  // namespace pcl_slim::python
