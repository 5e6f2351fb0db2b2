// SPDX-License-Identifier: BSD-3-Clause
// Deviations as colours of the object that they were measured on: a picture and a page.
#include "compare/drawing.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/render/mesh_renderer.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim {

void DrawingRequest::declare(OptionTable& table) {
  table.text("picture", &picture, "FILE.png|.ppm",
             "picture of A in the colours of its deviations, grey where they are not significant",
             FileUse::kWritten);
  table.text("page", &page, "FILE.html", "the same as a web page that can be turned",
             FileUse::kWritten);
  table.number("range", &range, 0.0, 1e300,
               "deviation of the darkest colours; 0: the 95 % quantile of what is significant");
  table.text("unit", &unit, "NAME", "unit of length that drawings name, such as mm, µm or ft");
  view.declareSize(table);
  view.declareCamera(table);
  table.toggle("white", &white, "white background");
  table.integer("aa", &supersampling, 1, 8, "N x N rays a pixel");
}

Error DrawingRequest::parse() {
  if (Error error = view.parse()) return error;
  if (!picture.empty()) {
    if (Error error = checkImageExtension(picture)) return error;
  }
  const std::string extension = lowerExtension(page);
  if (!page.empty() && extension != ".html" && extension != ".htm")
    return {ErrorCode::kBadArgument, "cannot write a page named '" + page + "'; name a .html file"};
  return DeviationScale{1.0, 0.0, unit}.validate();
}

namespace {

std::vector<double> significantOf(const Deviations& deviations) {
  std::vector<double> found;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    if (deviations.classOf(i) == DeviationClass::kSignificant)
      found.push_back(deviations.distance[i]);
  }
  return found;
}

std::array<std::uint8_t, 3> colorOf(const DeviationScale& scale, const Deviations& deviations,
                                    std::size_t i) {
  switch (deviations.classOf(i)) {
    case DeviationClass::kSame: return bytesOf(insignificantColor());
    case DeviationClass::kNoCounterpart: return bytesOf(noCounterpartColor());
    default: return bytesOf(deviationColor(scale, deviations.distance[i]));
  }
}

/** A level of detection to show: 0 where nothing was measured. */
double shownLevel(double level) {
  return std::isfinite(level) ? level : 0.0;
}

}  // namespace

DeviationDrawing::DeviationDrawing(const DrawingRequest& request, const Comparison& comparison,
                                   double level, int threads)
    : request_(request),
      comparison_(comparison),
      threads_(threads),
      scale_(deviationScaleOf(significantOf(comparison.deviations()), shownLevel(level),
                              request.unit)) {
  if (request.range > 0.0) scale_.range = request.range;
  const Deviations& deviations = comparison.deviations();
  for (std::size_t i = 0; i < deviations.size(); ++i)
    colors_.push_back(colorOf(scale_, deviations, i));
}

Error DeviationDrawing::prepare(Console& console, Report& report) {
  const ComparedInput& object = comparison_.measuredObject();
  if (object.isMesh()) {
    mesh_ = comparison_.isAtCarrier() ? comparison_.carrier().mesh : object.mesh;
    mesh_.colors = colors_;
    return {};
  }
  console.begin("Painting");
  surface_ = object.surface;
  const PlaceColumns& places = comparison_.places();
  CloudView view;
  view.xyz = places.positions.data();
  view.xyz_stride = sizeof(places.positions[0]);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = places.size();
  view.normal = places.normals.data();
  view.normal_stride = sizeof(places.normals[0]);
  std::vector<std::array<std::uint8_t, 3>> bgr = colors_;
  for (auto& color : bgr) std::swap(color[0], color[2]);
  const auto painted = paintColors(view, {bgr.data(), sizeof(bgr[0])}, threads_, surface_);
  if (!painted) return console.failed(painted.error());
  report.time("paint", console.seconds());
  console.done(std::to_string(painted->painted) + " leaves");
  return {};
}

ChosenView DeviationDrawing::viewFor(double right_margin) const {
  ViewRequest view = request_.view;
  view.right_margin = right_margin;
  const bool is_mesh = comparison_.measuredObject().isMesh();
  return view.viewOf(is_mesh ? spheresOf(mesh_.vertices, mesh_.triangles) : spheresOf(surface_));
}

Error DeviationDrawing::drawPicture(Console& console, Report& report) const {
  if (request_.picture.empty()) return {};
  const ChosenView view = viewFor(deviationLegendShare(request_.view.size));
  if (!view.words.empty()) console.note("  " + view.words);
  console.begin("Rendering " + request_.view.size_text);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.gradient_background = !request_.white;
  shading.supersampling = request_.supersampling;
  shading.threads = threads_;
  const VisibleSides sides = view.opens ? VisibleSides::kFront : VisibleSides::kAuto;
  Result<Image> image = Image();
  if (comparison_.measuredObject().isMesh()) {
    MeshRenderParams params;
    params.sides = sides;
    params.threads = threads_;
    image = renderPicture(mesh_, view.camera, params, shading);
  } else {
    RenderParams params;
    params.sides = sides;
    params.close_gaps = true;
    params.threads = threads_;
    image = renderPicture(surface_, view.camera, params, shading);
  }
  if (!image) return console.failed(image.error());
  addDeviationLegend(scale_, *image);
  if (Error error = saveImage(request_.picture, *image)) return console.failed(error);
  report.time("render", console.seconds());
  report.set("color_range", scale_.range);
  console.done(request_.view.size_text + " pixels");
  return {};
}

namespace {

/** A mesh's vertices as discs that cover its triangles. */
SplatSet discsOf(const TriangleMesh& mesh, const std::vector<double>& area) {
  constexpr double kOverlap = 1.7;  // radii of discs of each vertex's area that leave no gap
  SplatSet splats;
  splats.resize(mesh.vertices.size(), false);
  if (!mesh.vertices.empty()) splats.origin = mesh.vertices[0];
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& n = mesh.normals[i];
    if (!(area[i] > 0.0) || (n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f)) continue;
    const Vector3 place = subtract(mesh.vertices[i], splats.origin);
    const auto& c = mesh.colors[i];
    splats.x[count] = static_cast<float>(place[0]);
    splats.y[count] = static_cast<float>(place[1]);
    splats.z[count] = static_cast<float>(place[2]);
    splats.nx[count] = n[0];
    splats.ny[count] = n[1];
    splats.nz[count] = n[2];
    splats.radius[count] = static_cast<float>(kOverlap * std::sqrt(area[i] / std::acos(-1.0)));
    splats.rgb[count] = std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | c[2];
    splats.confidence[count] = 1.0f;
    splats.kept[count] = static_cast<std::uint32_t>(i);
    ++count;
  }
  splats.resize(count, false);
  return splats;
}

}  // namespace

Error DeviationDrawing::writePage(const std::string& title, Console& console,
                                  Report& report) const {
  if (request_.page.empty()) return {};
  const ChosenView view = viewFor(0.0);
  console.begin("Writing " + request_.page);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.gradient_background = !request_.white;
  shading.unit = request_.unit;
  shading.threads = threads_;
  PageParams params;
  params.title = title;
  params.up = view.up;
  params.deviations = scale_;
  Result<std::string> page = std::string();
  if (comparison_.measuredObject().isMesh()) {
    TriangleMesh mesh = comparison_.carrier().mesh;
    if (!comparison_.isAtCarrier()) mesh.vertices.resize(comparison_.places().size());
    mesh.colors = colors_;
    DiscRenderParams rendering;
    rendering.threads = threads_;
    page = encodePage(discsOf(mesh, comparison_.shares().area), view.camera, rendering, shading,
                      params);
  } else {
    RenderParams rendering;
    rendering.sides = view.opens ? VisibleSides::kFront : VisibleSides::kAuto;
    rendering.threads = threads_;
    page = encodePage(surface_, view.camera, rendering, shading, params);
  }
  if (!page) return console.failed(page.error());
  if (Error error = writeFile(request_.page, page->data(), page->size()))
    return console.failed(error);
  report.time("page", console.seconds());
  report.set("page_bytes", page->size());
  console.done(std::to_string(page->size()) + " bytes");
  return {};
}

}  // namespace pcl_slim
