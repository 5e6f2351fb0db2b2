// SPDX-License-Identifier: BSD-3-Clause
// The mappers of surfaces and of splats.
#include "pcl_slim/visualization/slim_mapper.h"

#include <vtkObjectFactory.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "frame/frame.h"
#include "opengl/card_rasterizer.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/visualization/display_mode.h"
#include "pcl_slim/visualization/splat_mapper.h"

namespace pcl_slim {

namespace detail {

/** \brief The rasteriser behind a SLIMMapper: the one place that names it. The surface must outlive
 * this object. */
class SurfaceFrames {
 public:
  explicit SurfaceFrames(const SLIMSurface& surface) : renderer_(surface) {}

  Error render(const Camera& camera, const FrameRequest& request, GBuffer& buffer);
  /** \brief Closes the gaps of a frame that the graphics card drew. \return pixels filled */
  Result<std::size_t> closeGaps(const Camera& camera, const FrameRequest& request,
                                const CardRasterizer& card, FrameTextures& textures);

 private:
  SurfaceRenderer renderer_;
  GBuffer gaps_;  ///< covered in the gaps alone; kept, as a frame's memory costs more than its gaps
  std::vector<float> met_;
};

namespace {

RenderParams paramsOf(const FrameRequest& request) {
  RenderParams params;
  params.sides = request.sides;
  params.near_plane = request.near_plane;
  params.threads = request.threads;
  params.columns =
      kPositionColumn | kCurvatureColumn | kLeafColumns | kResidualColumn | request.columns;
  params.lod = request.lod;
  params.trim = request.trim;
  params.cuts = request.clip_planes;
  params.close_gaps = request.close_gaps;
  return params;
}

}  // namespace

Error SurfaceFrames::render(const Camera& camera, const FrameRequest& request, GBuffer& buffer) {
  return renderer_.render(camera, paramsOf(request), buffer);
}

Result<std::size_t> SurfaceFrames::closeGaps(const Camera& camera, const FrameRequest& request,
                                             const CardRasterizer& card, FrameTextures& textures) {
  const RenderParams params = paramsOf(request);
  card.readMet(met_);
  gaps_.reserve(camera.size.width, camera.size.height, params.columns);
  for (std::size_t i = 0; i < met_.size(); ++i) {
    gaps_.surfel[i] = met_[i] < CardRasterizer::kNothing ? 0 : GBuffer::kNothing;
  }
  if (Error error = renderer_.closeGaps(camera, params, gaps_)) return error;
  const std::size_t filled = gaps_.numCovered();
  if (filled > 0) textures.fill(gaps_, renderer_.surface().info.scale);
  return filled;
}

}  // namespace detail

using namespace detail;
namespace {

/** \brief Points with the bounds of balls around them, built one by one. */
class BallPoints {
 public:
  BallPoints() { points_->SetDataTypeToDouble(); }

  void add(const std::array<double, 3>& center, double radius) {
    points_->InsertNextPoint(center.data());
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = center[k] - radius, high = center[k] + radius;
      bounds_[2 * k] = first_ ? low : std::min(bounds_[2 * k], low);
      bounds_[2 * k + 1] = first_ ? high : std::max(bounds_[2 * k + 1], high);
    }
    first_ = false;
  }

  vtkSmartPointer<vtkPolyData> finish(std::array<double, 6>& bounds) const {
    bounds = bounds_;
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_);
    return data;
  }

 private:
  vtkSmartPointer<vtkPoints> points_ = vtkSmartPointer<vtkPoints>::New();
  std::array<double, 6> bounds_{1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  bool first_ = true;
};

/** \brief Centres of a surface's leaves as points without cells, double, world coordinates: what
 * VTK's point pickers look at. \param[out] bounds of the balls as far as the surface reaches;
 * VTK's empty ones for no leaf or a null surface. O(surfels). */
vtkSmartPointer<vtkPolyData> leafPoints(const SLIMSurface* surface, std::array<double, 6>& bounds) {
  BallPoints points;
  for (std::size_t i = 0; surface && i < surface->size(); ++i) {
    if (!surface->isLeaf(i)) continue;
    const SurfaceInfo& info = surface->info;
    points.add({info.origin[0] + info.scale * double{surface->cx[i]},
                info.origin[1] + info.scale * double{surface->cy[i]},
                info.origin[2] + info.scale * double{surface->cz[i]}},
               info.scale * info.cover_radius * double{surface->radius[i]});
  }
  return points.finish(bounds);
}

/** \brief The same of splats. O(splats). */
vtkSmartPointer<vtkPolyData> splatPoints(const SplatSet* splats, std::array<double, 6>& bounds) {
  BallPoints points;
  for (std::size_t i = 0; splats && i < splats->size(); ++i) {
    points.add({splats->origin[0] + double{splats->x[i]}, splats->origin[1] + double{splats->y[i]},
                splats->origin[2] + double{splats->z[i]}},
               double{splats->radius[i]});
  }
  return points.finish(bounds);
}

using Weighted = std::pair<double, double>;  ///< value, area

/** \brief The value below which a share of the area is. */
double quantile(const std::vector<Weighted>& sorted, double share) {
  double total = 0.0, sum = 0.0;
  for (const Weighted& entry : sorted) total += entry.second;
  for (const Weighted& entry : sorted) {
    sum += entry.second;
    if (sum >= share * total) return entry.first;
  }
  return 0.0;
}

/** \brief A leaf's curvature at its centre, of the kind a mode shows, 1 / radius or its square. */
double curvatureAtCenter(const SLIMSurface& surface, std::size_t i, DisplayMode mode) {
  const HeightJet jet = evaluateJet(surface.degree[i], surface.coefficientsOf(i), 0.0, 0.0);
  const double e = 1.0 + jet.hu * jet.hu, g = 1.0 + jet.hv * jet.hv, f = jet.hu * jet.hv;
  const double root = std::sqrt(e + g - 1.0);
  const double mean = -(g * jet.huu - 2.0 * f * jet.huv + e * jet.hvv) / (2.0 * root * root * root);
  const double gauss = (jet.huu * jet.hvv - jet.huv * jet.huv) / ((e + g - 1.0) * (e + g - 1.0));
  const double spread = std::sqrt(std::max(0.0, mean * mean - gauss));
  switch (mode) {
    case DisplayMode::kGauss: return gauss;
    case DisplayMode::kMax: return mean + spread;
    case DisplayMode::kMin: return mean - spread;
    default: return mean;
  }
}

double valueOf(const SLIMSurface& surface, std::size_t i, DisplayMode mode) {
  const double radius = surface.radius[i] * surface.info.scale;
  if (mode == DisplayMode::kSize) return radius;
  if (mode == DisplayMode::kLevel) return surface.level[i];
  if (mode == DisplayMode::kError) return surface.error[i] * surface.info.scale;
  const double unit = mode == DisplayMode::kGauss ? radius * radius : radius;
  return std::abs(curvatureAtCenter(surface, i, mode)) / unit;
}

/** \brief The tolerance for rounding: a millionth of one over the surface's extent, or its square.
 */
double leastShown(double scale, DisplayMode mode) {
  constexpr double kShare = 1e-6;
  if (mode == DisplayMode::kError) return 0.0;
  return mode == DisplayMode::kGauss ? kShare * kShare / (scale * scale) : kShare / scale;
}

/** \brief Values of the first and last colour of a mode that shows numbers, world units.
 *
 * Taken from the leaves, not from a picture, so that colours stay as the object turns. Curvatures,
 * at the leaves' centres: -r ... r, which contains 95 % of the area; radii: their 2nd to 98th
 * percentile by area; levels: lowest and highest. O(leaves log leaves).
 */
std::array<double, 2> surfaceRange(const SLIMSurface& surface, DisplayMode mode) {
  std::vector<Weighted> values;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    // Leaves overlap alike, so a leaf represents an area like its ball's cross-section.
    const double area = double{surface.radius[i]} * surface.radius[i];
    values.emplace_back(valueOf(surface, i, mode), area);
  }
  if (values.empty()) return {0.5, 1.0};
  std::sort(values.begin(), values.end());
  if (mode == DisplayMode::kLevel) return {values.front().first, values.back().first};
  if (mode == DisplayMode::kSize) return {quantile(values, 0.02), quantile(values, 0.98)};
  const double range = quantile(values, 0.95);
  // A flat surface has no curvature but by rounding, and that spans no colours: any range far above
  // it shows the surface grey.
  const double least = leastShown(surface.info.scale, mode);
  const double shown = range > least && std::isfinite(range) ? range : 1.0 / surface.info.scale;
  return {mode == DisplayMode::kError ? 0.0 : -shown, shown};
}

}  // namespace

vtkStandardNewMacro(SLIMMapper)

SLIMMapper::SLIMMapper() : choice_(std::make_unique<BackendChoice>()) {}
SLIMMapper::~SLIMMapper() = default;

bool SLIMMapper::setSurface(std::shared_ptr<const SLIMSurface> surface) {
  const bool usable = !surface || !surface->validate();
  surface_ = usable ? std::move(surface) : nullptr;
  frames_ = surface_ ? std::make_unique<SurfaceFrames>(*surface_) : nullptr;
  // Another surface may have the place in memory that this one had.
  if (card_) card_->setSurface(nullptr);
  card_fails_ = false;
  *choice_ = {};
  ranges_.clear();
  std::array<double, 6> bounds{};
  const vtkSmartPointer<vtkPolyData> points = leafPoints(surface_.get(), bounds);
  objectChanged(points, bounds);
  return usable;
}

bool SLIMMapper::supports(DisplayMode mode) const {
  return mode != DisplayMode::kColor || (surface_ && surface_->hasColors());
}

Error SLIMMapper::rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer) {
  if (frames_) return frames_->render(camera, request, buffer);
  buffer.resize(camera.size.width, camera.size.height);
  return {};
}

void SLIMMapper::setBackend(RayBackend backend) {
  if (backend == backend_) return;
  backend_ = backend;
  card_fails_ = false;
  dropFrame();
}

void SLIMMapper::setLevelOfDetail(double pixels) {
  constexpr double kMost = 1024.0;  // as RenderParams takes
  pixels = std::isfinite(pixels) ? std::clamp(pixels, 0.0, kMost) : 0.0;
  if (pixels == lod_) return;
  lod_ = pixels;
  Modified();
}

void SLIMMapper::setTrimming(bool trim) {
  if (trim == trim_) return;
  trim_ = trim;
  Modified();
}

void SLIMMapper::complete(FrameRequest& request) const {
  request.lod = lod_;
  request.trim = trim_;
  request.columns = pictureLineColumns(linesShown());
  if (getMode() == DisplayMode::kColor) request.columns |= kColorColumn;
}

Error SLIMMapper::setLines(const PictureLineParams& lines, const LineStyle& style) {
  if (Error error = lines.validate()) return error;
  std::vector<std::uint8_t> none;
  if (Error error = drawLines({}, style, {1, 1}, none)) return error;
  lines_ = lines;
  line_style_ = style;
  dropLines();
  return {};
}

/** \brief The kinds that are drawn in the mode that is set. */
PictureLineParams SLIMMapper::linesShown() const {
  PictureLineParams shown = lines_;
  const bool any = lines_.crest || lines_.suggestive || lines_.contour;
  if (!any && getMode() == DisplayMode::kSketch) {
    shown.crest = shown.suggestive = shown.contour = true;
  }
  return shown;
}

bool SLIMMapper::wantsLines() const {
  const PictureLineParams shown = linesShown();
  return surface_ && (shown.crest || shown.suggestive || shown.contour);
}

Error SLIMMapper::drawLinesOver(const Camera& camera, const FrameRequest& request,
                                const GBuffer* buffer, std::vector<std::uint8_t>& rgba) {
  PictureLineParams shown = linesShown();
  shown.threads = request.threads;
  const unsigned needed = pictureLineColumns(shown);
  GBuffer own;
  if (!buffer || (request.columns & needed) != needed) {
    FrameRequest with_columns = request;
    with_columns.columns = needed;
    if (Error error = rasterize(camera, with_columns, own)) return error;
    buffer = &own;
  }
  auto lines = findPictureLines(*buffer, camera, *surface_, shown);
  return lines ? drawLines(*lines, line_style_, camera.size, rgba) : lines.error();
}

bool SLIMMapper::usesCard(vtkOpenGLRenderWindow* /*window*/, const FrameRequest& request) {
  if (!surface_ || card_fails_ || !request.clip_planes.empty()) return false;
  if (backend_ == RayBackend::kAuto) {
    return !CardRasterizer::isSoftware() && choice_->prefersCard();
  }
  return backend_ == RayBackend::kOpenGL;
}

Error SLIMMapper::drawOnCard(vtkOpenGLRenderWindow* window, const ViewCamera& view,
                             const FrameRequest& request, FrameTextures& textures,
                             std::uint64_t& covered) {
  if (!card_) card_ = std::make_unique<CardRasterizer>();
  card_->setSurface(surface_.get());
  const Error error = card_->draw(window, view, request, textures, covered);
  card_fails_ = static_cast<bool>(error);
  if (error || covered == 0 || !request.close_gaps) return error;
  if (request.lod == 0.0 && request.trim) {
    const Result<std::size_t> filled = frames_->closeGaps(view.camera, request, *card_, textures);
    if (!filled) return filled.error();
    covered += *filled;
  }
  return {};
}

void SLIMMapper::frameMade(const FrameRequest& request, const ImageSize& size, double seconds) {
  choice_->add(getStatistics().on_card, request, seconds,
               static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
}

void SLIMMapper::ReleaseGraphicsResources(vtkWindow* window) {
  if (card_) card_->release(window);
  Superclass::ReleaseGraphicsResources(window);
}

double SLIMMapper::lengthScale() const {
  return surface_ ? surface_->info.scale : 1.0;
}

std::array<double, 2> SLIMMapper::automaticRange(DisplayMode mode) const {
  const auto known = ranges_.find(mode);
  if (known != ranges_.end()) return known->second;
  return ranges_[mode] = surface_ ? surfaceRange(*surface_, mode) : std::array<double, 2>{0.5, 1.0};
}

bool SLIMMapper::pick(vtkRenderer* renderer, vtkActor* actor, int x, int y, SurfacePick& result) {
  result = {};
  GBuffer pixel;
  if (!surface_ || !castRay(renderer, actor, x, y, pixel)) return false;
  const SLIMSurface& surface = *surface_;
  const double scale = surface.info.scale;
  const std::size_t i = result.surfel = pixel.surfel[0];
  for (std::size_t k = 0; k < 3; ++k) {
    result.position[k] = surface.info.origin[k] + scale * double{pixel.position[0][k]};
    result.normal[k] = pixel.normal[0][k];
  }
  result.mean = pixel.mean_curvature[0] / scale;
  result.gauss = pixel.gaussian_curvature[0] / (scale * scale);
  result.k_max = pixel.principal[0][0] / scale;
  result.k_min = pixel.principal[0][1] / scale;
  result.level = surface.level[i];
  result.degree = surface.degree[i];
  result.radius = surface.radius[i] * scale;
  result.error = surface.error[i] * scale;
  result.effective_count = surface.effective_count[i];
  return true;
}

vtkStandardNewMacro(SplatMapper)

bool SplatMapper::setSplats(std::shared_ptr<const SplatSet> splats) {
  const bool usable = !splats || !validateDiscs(*splats);
  splats_ = usable ? std::move(splats) : nullptr;
  std::array<double, 6> bounds{};
  const vtkSmartPointer<vtkPolyData> points = splatPoints(splats_.get(), bounds);
  objectChanged(points, bounds);
  return usable;
}

bool SplatMapper::supports(DisplayMode mode) const {
  return mode == DisplayMode::kShaded || mode == DisplayMode::kNormal ||
         mode == DisplayMode::kSize || mode == DisplayMode::kReflection ||
         mode == DisplayMode::kColor;
}

Error SplatMapper::rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer) {
  buffer.resize(camera.size.width, camera.size.height);
  if (!splats_ || splats_->empty()) return {};
  DiscRenderParams params;
  params.sides = request.sides;
  params.near_plane = request.near_plane;
  params.threads = request.threads;
  if (request.clip_planes.empty()) return renderDiscs(*splats_, camera, params, buffer);
  return renderDiscs(splatsWithin(*splats_, request.clip_planes), camera, params, buffer);
}

std::array<double, 2> SplatMapper::automaticRange(DisplayMode /*mode*/) const {
  if (!splats_ || splats_->empty()) return {0.5, 1.0};
  std::vector<float> radii = splats_->radius;
  std::sort(radii.begin(), radii.end());
  const auto at = [&](double share) {
    return double{radii[static_cast<std::size_t>(share * static_cast<double>(radii.size() - 1))]};
  };
  const double high = at(0.98);
  return {std::max(at(0.02), 1e-6 * high), high > 0.0 ? high : 1.0};
}

}  // namespace pcl_slim
