// SPDX-License-Identifier: BSD-3-Clause
#include "compare/measurement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "pcl_slim/compare/triangle_index.h"
#include "pcl_slim/query/cloud_projection.h"

namespace pcl_slim {
namespace {

double inDegrees(double radians) {
  return radians * 180.0 / std::acos(-1.0);
}

Vector3 inDegrees(const Vector3& radians) {
  return {inDegrees(radians[0]), inDegrees(radians[1]), inDegrees(radians[2])};
}

/** "0.0012 +- 0.0003": a vector's length and the root of the sum of its errors' squares. */
std::string lengthText(const Vector3& value, const Vector3& error) {
  const double total = length(error);
  std::string text = numberText(length(value), 3);
  return std::isfinite(total) ? text + " +- " + numberText(total, 2) : text;
}

/** A vector for a report, in which what is not finite is null. */
ReportValue listOf(const Vector3& v) {
  return std::vector<double>(v.begin(), v.end());
}

void reportRegistration(const Registration& r, bool applied, Report& report) {
  const std::array<double, 16> m = r.motion.matrix();
  report.set("registration", {{"translation", listOf(r.translation)},
                              {"translation_error", listOf(r.translation_error)},
                              {"rotation_degrees", listOf(inDegrees(r.rotation))},
                              {"rotation_degrees_error", listOf(inDegrees(r.rotation_error))},
                              {"determined", r.rank},
                              {"places", r.places},
                              {"inliers", r.inliers},
                              {"rms_before", r.rms_before},
                              {"rms_after", r.rms_after},
                              {"iterations", r.iterations},
                              {"converged", r.converged},
                              {"applied", applied},
                              {"matrix", std::vector<double>(m.begin(), m.end())}});
}

void printRegistration(const Registration& r, bool applied, Console& console) {
  console.note("  registration: offset " + lengthText(r.translation, r.translation_error) +
               ", turned by " + lengthText(inDegrees(r.rotation), inDegrees(r.rotation_error)) +
               " degrees" + (applied ? "; applied to A" : "; -align 1 applies it to A"));
  if (r.rank == 6) return;
  console.note("  registration: " + std::to_string(6 - r.rank) +
               " of 6 motions slide the object along itself: unknown, and not applied");
}

}  // namespace

Error Comparison::run(Console& console, Report& report) {
  if (Error error = prepare(console, report)) return error;
  if (Error error = align(console, report)) return error;
  return measure(console, report);
}

Error Comparison::prepare(Console& console, Report& report) {
  console.begin("Covering " + measuredObject().name());
  CarrierParams covering = job_.carrier;
  if (measuredObject().isMesh() && !otherObject().isMesh())
    covering.longest_edge = longestEdgeFor(otherObject().surface);
  Result<CarrierMesh> carrier = measuredObject().carrier(covering, console.progress());
  if (!carrier) return console.failed(carrier.error());
  carrier_ = std::move(*carrier);
  Result<DeviationReference> to_b = b_.reference(job_.carrier.threads);
  if (!to_b) return console.failed(to_b.error());
  to_b_ = std::move(*to_b);
  if (job_.at == MeasuredAt::kReference) {
    Result<DeviationReference> to_a = a_.reference(job_.carrier.threads);
    if (!to_a) return console.failed(to_a.error());
    to_a_ = std::move(*to_a);
  }
  report.time("carrier", console.seconds());
  console.done(counted(carrier_->places.size(), "place") + ", edges up to " +
               numberText(carrier_->longest_edge, 3));
  if (job_.at != MeasuredAt::kSurface) {
    if (Error error = makePoints(console)) return error;
  }
  places_ = job_.at == MeasuredAt::kPoints ? point_places_ : carrier_->places;
  return makeShares();
}

Error Comparison::makePoints(Console& console) {
  if (a_.kind == ComparedInput::Kind::kCloud) {
    const CloudView view = a_.view();
    CloudProjectionParams params;
    params.projection.threads = job_.carrier.threads;
    params.projection.errors = true;
    const Result<CloudProjection> projection =
        CloudProjection::make(view, a_.surface, params, &console.progress(), &a_.store);
    if (!projection) return projection.error();
    point_places_ = placesOf(view, *projection, a_.surface, job_.points, job_.carrier.threads);
    return {};
  }
  CarrierParams own = job_.carrier;
  if (a_.isMesh()) own.longest_edge = std::numeric_limits<double>::max();  // no edge is divided
  Result<CarrierMesh> carrier = a_.carrier(own, console.progress());
  if (!carrier) return carrier.error();
  point_places_ = std::move(carrier->places);
  return {};
}

/** Points of a scan are not evenly dense, but each has the same share of the area; its component is
 * that of the nearest triangle. */
Error Comparison::makeShares() {
  shares_ = carrier_->carrier;
  if (isAtCarrier()) return {};
  shares_ = evenCarrier(places_.size(), carrier_->area);
  const Result<TriangleIndex> index = TriangleIndex::make(carrier_->mesh, job_.carrier.threads);
  if (!index) return index.error();
  const auto feet = index->nearest(places_.positions, Bounds::kInfinity, {}, job_.carrier.threads);
  shares_.num_components = carrier_->carrier.num_components;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const auto& corners = carrier_->mesh.triangles[feet[i].found() ? feet[i].triangle : 0];
    shares_.component[i] = carrier_->carrier.component[corners[0]];
  }
  return {};
}

Error Comparison::align(Console& console, Report& report) {
  console.begin("Checking the registration");
  AlignmentParams params;
  params.apply = job_.align;
  params.registration.feet = job_.deviation.feet;
  const bool measured = a_.kind == ComparedInput::Kind::kCloud &&
                        job_.points == ScanPlaces::kMeasured && job_.at == MeasuredAt::kPoints;
  const double a = a_.independent(measured ? ScanPlaces::kMeasured : ScanPlaces::kMoved);
  const double b = measured ? 0.0 : b_.independent(ScanPlaces::kMoved);
  params.registration.effective_count = a > 0.0 && b > 0.0 ? std::min(a, b) : std::max(a, b);
  const PlaceColumns& of_a = job_.at == MeasuredAt::kReference ? point_places_ : places_;
  Result<Alignment> alignment = alignmentOf(*to_b_, of_a, params, &console.progress());
  if (!alignment) return console.failed(alignment.error());
  alignment_ = std::move(*alignment);
  report.time("registration", console.seconds());
  report.set("turned", alignment_.turned);
  console.done(counted(static_cast<std::uint64_t>(alignment_.registration.iterations), "step"));
  if (alignment_.turned)
    console.note("  A's normals face the other way than B's do: turned; deviations are along B's");
  if (alignment_.unknown) {
    console.note("  registration: " + alignment_.unknown.message);
    return {};
  }
  printRegistration(alignment_.registration, job_.align, console);
  reportRegistration(alignment_.registration, job_.align, report);
  return {};
}

Error Comparison::measure(Console& console, Report& report) {
  console.begin("Measuring");
  const bool back = job_.at == MeasuredAt::kReference;
  const PlaceColumns placed = back ? alignment_.backward(places_, job_.carrier.threads)
                                   : alignment_.forward(places_, job_.carrier.threads);
  DeviationParams params = job_.deviation;
  params.keep_feet = false;
  Error error = measureDeviations(back ? *to_a_ : *to_b_, placed.view(), params, deviations_,
                                  &console.progress());
  if (error) return console.failed(error);
  // Seen from B, along B's normals.
  if (back && !alignment_.turned) {
    for (float& distance : deviations_.distance) distance = -distance;
  }
  report.time("measure", console.seconds());
  const std::size_t found = states()[static_cast<std::size_t>(FootState::kFound)];
  console.done(counted(places_.size(), "place") + ", " + std::to_string(found) +
               " with a counterpart");
  return {};
}

Result<Deviations> Comparison::atPoints(Console& console) {
  if (job_.at == MeasuredAt::kPoints) return deviations_;
  if (point_places_.positions.empty()) {
    if (Error error = makePoints(console)) return error;
  }
  const PlaceColumns placed = alignment_.forward(point_places_, job_.carrier.threads);
  DeviationParams params = job_.deviation;
  params.keep_feet = false;
  Deviations deviations;
  if (Error error =
          measureDeviations(*to_b_, placed.view(), params, deviations, &console.progress()))
    return error;
  return deviations;
}

std::vector<std::uint64_t> Comparison::states() const {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(FootState::kNotFinite) + 1);
  for (const FootState state : deviations_.state) ++counts[static_cast<std::size_t>(state)];
  return counts;
}

}  // namespace pcl_slim
