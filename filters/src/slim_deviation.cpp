// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_deviation.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "input_types.h"
#include "pcl_slim/compare/alignment.h"
#include "pcl_slim/compare/carrier_mesh.h"
#include "pcl_slim/scan/scan.h"
#include "polygon_mesh.h"

namespace pcl_slim {

void SLIMDeviationBase::clearResults() {
  SLIMFitBase::clearResults();
  fitted_surface_.reset();
  fitted_reference_.reset();
  registration_ = {};
  transformation_ = Eigen::Matrix4d::Identity();
  summary_ = {};
}

bool SLIMDeviationBase::compare(const CloudView& points, const CloudView* reference,
                                PlaceColumns& places, Deviations& deviations) {
  const CancellableRun cancellable(control_.progress);
  const Settings settings{params_, places_kind_,   deviation_,      summary_params_,
                          align_,  given_surface_, given_reference_};
  const bool done = guarded("the comparison", "compare fewer points",
                            [&] { return run(settings, points, reference, places, deviations); });
  if (done) return true;
  const Error error = error_;
  clearResults();
  return fail(error.code, error.message);
}

namespace {

/** A mesh of PCL's as triangles, its faces cut from their first corners. */
Result<TriangleMesh> trianglesOf(const pcl::PolygonMesh& polygons) {
  const RealTriple xyz(polygons.cloud, kPosition);
  if (Error error = checkVertices(polygons.cloud, xyz, "the reference mesh")) return error;
  TriangleMesh mesh;
  for (std::size_t i = 0; i < numPoints(polygons.cloud); ++i)
    mesh.vertices.push_back(xyz.read(polygons.cloud, i));
  for (const pcl::Vertices& polygon : polygons.polygons) {
    const auto& corners = polygon.vertices;
    for (std::size_t k = 2; k < corners.size(); ++k) {
      mesh.triangles.push_back({static_cast<std::uint32_t>(corners[0]),
                                static_cast<std::uint32_t>(corners[k - 1]),
                                static_cast<std::uint32_t>(corners[k])});
    }
  }
  return mesh;
}

/** Area of a surface as far as it is measured [world units squared]. */
Result<double> areaOf(const SLIMSurface& surface, int threads, Progress& progress) {
  CarrierParams params;
  params.longest_edge = std::numeric_limits<double>::max();  // no edge is divided
  params.threads = threads;
  const Result<CarrierMesh> carrier = carrierMeshOf(surface, params, &progress);
  if (!carrier) return carrier.error();
  return carrier->area;
}

}  // namespace

Error SLIMDeviationBase::place(const Settings& settings, const CloudView& points,
                               SurfaceConstPtr& surface, PlaceColumns& places) {
  surface = settings.surface;
  FittedScan scan;
  const bool fits = !surface;
  if (!fits) {
    if (Error error = surface->validate()) return error;
  } else {
    if (Error error = fitAndKeep({points, {}}, settings.fit, scan)) return error;
    surface = fitted_surface_ = std::make_shared<const SLIMSurface>(std::move(scan.surface));
  }
  const auto origin = fits ? SurfaceOrigin::kFitted : SurfaceOrigin::kGiven;
  ProjectionParams projecting;
  projecting.errors = true;
  const Result<CloudProjection> projection =
      projectScan(points, *surface, origin, settings.fit, projecting, &control_.progress,
                  fits ? &scan.store : nullptr);
  if (!projection) return projection.error();
  places = placesOf(points, *projection, *surface, settings.places, settings.fit.threads);
  return {};
}

Result<DeviationReference> SLIMDeviationBase::makeReference(const Settings& settings,
                                                            const CloudView* cloud,
                                                            SurfaceConstPtr& owner) {
  const int threads = settings.fit.threads;
  if (settings.reference.mesh) {
    const Result<TriangleMesh> mesh = trianglesOf(*settings.reference.mesh);
    if (!mesh) return mesh.error();
    return DeviationReference::make(*mesh, {}, threads);
  }
  owner = settings.reference.surface;
  if (cloud != nullptr) {
    FittedScan scan;
    if (Error error = fitScan({*cloud, {}}, settings.fit, scan, &control_.progress))
      return Error{error.code, "the reference: " + error.message};
    owner = fitted_reference_ = std::make_shared<const SLIMSurface>(std::move(scan.surface));
  }
  if (Error error = owner->validate()) return error;
  return DeviationReference::make(*owner, threads);
}

Error SLIMDeviationBase::sumUp(const Settings& settings, const SLIMSurface& surface,
                               const Deviations& deviations) {
  const Result<double> area = areaOf(surface, settings.fit.threads, control_.progress);
  if (!area) return area.error();
  auto summary =
      summarizeDeviations(deviations, evenCarrier(deviations.size(), *area), settings.summary);
  if (!summary) return summary.error();
  summary_ = std::move(*summary);
  return {};
}

Error SLIMDeviationBase::run(const Settings& settings, const CloudView& points,
                             const CloudView* reference, PlaceColumns& places,
                             Deviations& deviations) {
  if (Error error = settings.fit.validate()) return error;
  if (Error error = settings.deviation.validate()) return error;
  if (Error error = settings.summary.validate()) return error;
  if (reference == nullptr && !settings.reference.surface && !settings.reference.mesh)
    return {ErrorCode::kBadInput, "no reference is set; call setReference()"};
  const int threads = settings.fit.threads;
  SurfaceConstPtr surface, owner;
  PlaceColumns own;
  if (Error error = place(settings, points, surface, own)) return error;
  const Result<DeviationReference> to = makeReference(settings, reference, owner);
  if (!to) return to.error();

  DeviationParams measuring = settings.deviation;
  measuring.feet.threads = threads;
  measuring.keep_feet = false;
  AlignmentParams aligning;
  aligning.apply = settings.align;
  aligning.registration.feet = measuring.feet;
  double& independent = aligning.registration.effective_count;
  independent = independentPlaces(*surface, settings.places);
  if (settings.places == ScanPlaces::kMoved && owner)
    independent = std::min(independent, independentPlaces(*owner, ScanPlaces::kMoved));
  const Result<Alignment> alignment = alignmentOf(*to, own, aligning, &control_.progress);
  if (!alignment) return alignment.error();
  registration_ = alignment->registration;
  if (alignment->unknown) warn("the registration is unknown: " + alignment->unknown.message);
  const std::array<double, 16> matrix = alignment->motion.matrix();
  for (int i = 0; i < 16; ++i) transformation_(i / 4, i % 4) = matrix[static_cast<std::size_t>(i)];

  places = alignment->forward(own, threads);
  if (Error error =
          measureDeviations(*to, places.view(), measuring, deviations, &control_.progress))
    return error;
  return sumUp(settings, *surface, deviations);
}

}  // namespace pcl_slim

PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_SLIMDeviation)
