// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/g_buffer_mapper.h"

#include <vtkActor.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkOpenGLHelper.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkOpenGLVertexArrayObject.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkShader.h>
#include <vtkShaderProgram.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>

#include "color/color_scale.h"
#include "frame/frame.h"
#include "opengl/card_rasterizer.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim {

/** \brief A mapper's settings and what it keeps of the last frame. */
struct GBufferMapper::State {
  DisplayMode mode = DisplayMode::kShaded;
  double range = 0.0, budget = 50.0;
  ObjectLight light = ObjectLight::kScene;
  int rays = 1;  ///< a pixel along each axis, of frames at rest
  double hollows = ShadingParams().ambient_occlusion;
  std::map<DisplayMode, std::array<double, 2>> seen_ranges;  ///< of fitRanges()
  VisibleSides sides = VisibleSides::kAuto;
  int threads = 0;
  FrameStatistics statistics;
  Error error;

  std::array<double, 6> bounds{1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  std::uint64_t object = 0;  ///< counts changes of the object

  detail::VtkView view;
  std::vector<HalfSpace> planes;
  std::array<int, 4> viewport{};
  detail::CachedFrame frame;
  FrameRequest request;        ///< what it was made with
  bool uploaded = false;       ///< textures contain the frame
  bool lines_current = false;  ///< and its lines
  detail::FrameTextures textures;

  vtkNew<vtkLookupTable> table;
  bool table_current = false;
  vtkMTimeType table_time = 0;  ///< of the table whose texture there is
};

using namespace detail;

GBufferMapper::GBufferMapper() : state_(std::make_unique<State>()) {
  SetLookupTable(state_->table);
  ScalarVisibilityOff();
}

GBufferMapper::~GBufferMapper() = default;

bool GBufferMapper::setMode(DisplayMode mode) {
  if (!supports(mode)) return false;
  if (mode == state_->mode) return true;
  if (mode == DisplayMode::kSketch || state_->mode == DisplayMode::kSketch) dropLines();
  state_->mode = mode;
  state_->table_current = false;
  updateTable();
  Modified();
  return true;
}

DisplayMode GBufferMapper::getMode() const {
  return state_->mode;
}

void GBufferMapper::setRange(double range) {
  range = std::isfinite(range) ? std::max(0.0, range) : 0.0;
  if (range == state_->range) return;
  state_->range = range;
  state_->table_current = false;
  updateTable();
  Modified();
}

double GBufferMapper::getRange() const {
  if (takesRange(state_->mode) && state_->range > 0.0) return state_->range;
  return unsetRange()[1];
}

/** \brief The automatic range of the mode that is set. */
std::array<double, 2> GBufferMapper::unsetRange() const {
  const auto seen = state_->seen_ranges.find(state_->mode);
  return seen != state_->seen_ranges.end() ? seen->second : automaticRange(state_->mode);
}

void GBufferMapper::setLight(ObjectLight light) {
  if (light == state_->light) return;
  state_->light = light;
  Modified();
}

ObjectLight GBufferMapper::getLight() const {
  return state_->light;
}

void GBufferMapper::setAmbientOcclusion(double strength) {
  strength = std::isfinite(strength) ? std::clamp(strength, 0.0, 1.0) : 0.0;
  if (strength == state_->hollows) return;
  state_->hollows = strength;
  Modified();
}

double GBufferMapper::getAmbientOcclusion() const {
  return state_->hollows;
}

void GBufferMapper::setSupersampling(int rays) {
  constexpr int kMost = 4;
  state_->rays = std::clamp(rays, 1, kMost);
}

int GBufferMapper::getSupersampling() const {
  return state_->rays;
}

void GBufferMapper::setFrameBudget(double milliseconds) {
  state_->budget = std::isfinite(milliseconds) ? std::max(0.0, milliseconds) : 0.0;
}

double GBufferMapper::getFrameBudget() const {
  return state_->budget;
}

void GBufferMapper::setSides(VisibleSides sides) {
  if (sides == state_->sides) return;
  state_->sides = sides;
  Modified();
}

VisibleSides GBufferMapper::getSides() const {
  return state_->sides;
}

void GBufferMapper::setNumberOfThreads(int threads) {
  state_->threads = std::max(0, threads);
}

int GBufferMapper::getNumberOfThreads() const {
  return state_->threads;
}

const FrameStatistics& GBufferMapper::getStatistics() const {
  return state_->statistics;
}

const Error& GBufferMapper::getError() const {
  return state_->error;
}

void GBufferMapper::objectChanged(vtkPolyData* points, const std::array<double, 6>& bounds) {
  state_->bounds = bounds;
  state_->seen_ranges.clear();
  ++state_->object;
  state_->frame.clear();
  state_->table_current = false;
  SetInputData(points);
  if (!supports(state_->mode)) state_->mode = DisplayMode::kShaded;
  updateTable();
  Modified();
}

/** \brief Fills the table of colours anew where mode, range or object have changed. */
void GBufferMapper::updateTable() {
  State& s = *state_;
  if (s.table_current || !showsNumbers(s.mode)) return;
  std::array<double, 2> limits = unsetRange();
  if (takesRange(s.mode) && s.range > 0.0) {
    limits = {showsCurvature(s.mode) ? -s.range : 0.0, s.range};
  }
  fillColorTable(s.mode, limits, *s.table);
  s.table_current = true;
  ++s.statistics.tables;
}

void GBufferMapper::ComputeBounds() {
  std::copy(state_->bounds.begin(), state_->bounds.end(), Bounds);
}

void GBufferMapper::UpdateBufferObjects(vtkRenderer* /*renderer*/, vtkActor* /*actor*/) {
  // There are no vertices: rays meet the object itself.
}

void GBufferMapper::complete(FrameRequest& /*request*/) const {}

bool GBufferMapper::wantsLines() const {
  return false;
}

Error GBufferMapper::drawLinesOver(const Camera& /*camera*/, const FrameRequest& /*request*/,
                                   const GBuffer* /*buffer*/, std::vector<std::uint8_t>& /*rgba*/) {
  return {};
}

void GBufferMapper::dropLines() {
  state_->lines_current = false;
  Modified();
}

bool GBufferMapper::usesCard(vtkOpenGLRenderWindow* /*window*/, const FrameRequest& /*request*/) {
  return false;
}

Error GBufferMapper::drawOnCard(vtkOpenGLRenderWindow* /*window*/, const ViewCamera& /*view*/,
                                const FrameRequest& /*request*/, FrameTextures& /*textures*/,
                                std::uint64_t& /*covered*/) {
  return {ErrorCode::kBadArgument, "the graphics card does not draw this; draw it on the CPU"};
}

void GBufferMapper::frameMade(const FrameRequest& /*request*/, const ImageSize& /*size*/,
                              double /*seconds*/) {}

void GBufferMapper::dropFrame() {
  state_->frame.clear();
  Modified();
}

bool GBufferMapper::castRay(vtkRenderer* renderer, vtkActor* actor, int x, int y, GBuffer& pixel) {
  pixel.resize(0, 0);
  int width = 0, height = 0, left = 0, bottom = 0;
  renderer->GetTiledSizeAndOrigin(&width, &height, &left, &bottom);
  x -= left;
  y -= bottom;
  if (x < 0 || y < 0 || x >= width || y >= height) return false;
  ViewCamera view;
  FrameRequest request;
  if (!requestOf(renderer, actor, width, height, view, request)) return false;
  const double column = (x + 0.5) * view.texels_x - 0.5;
  const Camera camera = cameraOfPixel(view.camera, column, height - 1 - y);
  if (rasterize(camera, request, pixel)) return false;
  return pixel.numPixels() == 1 && pixel.covered(0);
}

bool GBufferMapper::fitRanges(vtkRenderer* renderer, vtkActor* actor) {
  int width = 0, height = 0;
  renderer->GetTiledSize(&width, &height);
  ViewCamera view;
  FrameRequest request;
  GBuffer buffer;
  if (!requestOf(renderer, actor, width, height, view, request)) return false;
  if (rasterize(view.camera, request, buffer) || buffer.numCovered() == 0) return false;
  for (const std::string& name : displayModeNames()) {
    const DisplayMode mode = *displayModeOf(name);
    // Levels outside of this view have colours of their own, too.
    if (!supports(mode) || !showsNumbers(mode) || mode == DisplayMode::kLevel) continue;
    ShadingParams shading;
    shading.mode = *shadingModeOf(name);
    const ShadingRange range = rangeOf(buffer, shading, lengthScale());
    state_->seen_ranges[mode] = {range.low, range.high};
  }
  state_->table_current = false;
  updateTable();
  Modified();
  return true;
}

/** \brief Fills in what a camera sees of the object through a viewport at rest, every surfel at full
 * detail. \return false where nothing can be drawn */
bool GBufferMapper::requestOf(vtkRenderer* renderer, vtkActor* actor, int width, int height,
                              ViewCamera& view, FrameRequest& request) {
  const VtkView seen = viewOf(renderer, actor, state_->bounds, width, height);
  if (translateView(seen.gl, seen.near_distance, 1, view)) return false;
  request = {view.near_plane, state_->sides, state_->threads, clipPlanesOf(this, actor)};
  complete(request);
  request.lod = 0.0;
  return true;
}

void GBufferMapper::PrintSelf(ostream& os, vtkIndent indent) {
  Superclass::PrintSelf(os, indent);
  os << indent << "Mode: " << nameOf(state_->mode) << "\n";
  os << indent << "Range: " << state_->range << "\n";
  os << indent << "FrameBudget: " << state_->budget << "\n";
  os << indent << "OnCard: " << state_->statistics.on_card << "\n";
  os << indent << "Rasterized: " << state_->statistics.rasterized << " of "
     << state_->statistics.frames << "\n";
}

// How it draws: rays, lines, the textures of both, and the shader that resolves them.

/** \brief Intersects a frame's rays on the graphics card or, failing that, on the CPU. */
Error GBufferMapper::makeFrame(vtkOpenGLRenderWindow* window, FrameRequest request,
                               double spacing) {
  State& s = *state_;
  const FrameKey key(s.view, request, s.object);
  if (spacing > 1.0) request.columns &= kColorColumn;
  s.request = request;
  s.statistics.on_card = false;
  if (usesCard(window, request)) {
    const Error error = s.frame.makeOnCard(
        s.view, key, spacing, request,
        [&](const ViewCamera& view, const FrameRequest& what, std::uint64_t& covered) {
          return drawOnCard(window, view, what, s.textures, covered);
        });
    s.statistics.on_card = s.uploaded = !error;
    if (!error) return {};
  }
  s.uploaded = false;
  return s.frame.make(s.view, key, spacing, request, lengthScale(),
                      [this](const Camera& camera, const FrameRequest& what, GBuffer& buffer) {
                        return rasterize(camera, what, buffer);
                      });
}

/** \brief Intersects rays unless the last frame is still valid. \return false for an empty frame.
 */
bool GBufferMapper::prepareFrame(vtkRenderer* renderer, vtkActor* actor) {
  State& s = *state_;
  auto* window = static_cast<vtkOpenGLRenderWindow*>(renderer->GetRenderWindow());
  window->GetState()->vtkglGetIntegerv(GL_VIEWPORT, s.viewport.data());
  s.view = viewOf(renderer, actor, s.bounds, s.viewport[2], s.viewport[3]);
  s.planes = clipPlanesOf(this, actor);
  FrameRequest request{0.0, s.sides, s.threads, s.planes};
  complete(request);
  const bool hurry = s.budget > 0.0 && isInteracting(renderer);
  request.close_gaps = !hurry;
  const FrameKey key(s.view, request, s.object);
  // Lines are found and drawn with a ray for every pixel, and VTK's lights light one.
  const bool several = s.light == ObjectLight::kStudio && !wantsLines();
  const double spacing = hurry ? s.frame.coarsenessFor(s.budget) : several ? 1.0 / s.rays : 1.0;
  const bool too_fine = !several && s.frame.spacing() < 1.0;
  if (too_fine || !s.frame.holds(key, spacing)) {
    s.lines_current = false;
    s.error = makeFrame(window, request, spacing);
    if (s.error) {
      vtkErrorMacro(<< s.error.message);
      return false;
    }
    ++s.statistics.rasterized;
    s.statistics.coarseness = std::max(1, static_cast<int>(std::lround(spacing)));
    s.statistics.supersampling = static_cast<int>(std::lround(std::max(1.0, 1.0 / spacing)));
    s.statistics.covered_pixels = s.frame.coveredPixels();
    s.statistics.rasterize_seconds = s.frame.seconds();
  }
  return s.frame.coveredPixels() > 0;
}

/** \brief Brings over to the graphics card what has changed since it was there. */
void GBufferMapper::uploadFrame(vtkOpenGLRenderWindow* window) {
  State& s = *state_;
  if (!s.uploaded) {
    s.textures.setFrame(window, s.frame.packed(), s.frame.width(), s.frame.height());
    s.uploaded = true;
  }
  if (!showsNumbers(s.mode)) return;
  s.textures.needAttributes(window, s.frame.packed());
  vtkScalarsToColors* table = GetLookupTable();
  if (s.table_time == table->GetMTime()) return;
  s.textures.setTable(window, table, ColorScale(s.mode, table));
  s.table_time = table->GetMTime();
}

/** \brief Draws lines over the frame where it has a ray for every pixel, while the mouse moves only
 * if frame and lines together take no longer than the budget. */
void GBufferMapper::prepareLines(vtkRenderer* renderer) {
  State& s = *state_;
  if (s.lines_current && wantsLines()) return;
  s.textures.dropLines();
  const double milliseconds = 1000.0 * (s.frame.seconds() + s.statistics.line_seconds);
  const bool slow = s.budget > 0.0 && (s.statistics.lines == 0 || milliseconds > s.budget);
  if (!wantsLines() || s.frame.spacing() > 1.0 || (slow && isInteracting(renderer))) return;
  const Stopwatch watch;
  std::vector<std::uint8_t> rgba;
  s.request.near_plane = s.frame.view().near_plane;
  const Camera& camera = s.frame.view().camera;
  s.error =
      drawLinesOver(camera, s.request, s.statistics.on_card ? nullptr : &s.frame.buffer(), rgba);
  s.statistics.line_seconds = watch.seconds();
  ++s.statistics.lines;
  s.lines_current = true;
  if (s.error || rgba.empty()) return;
  s.textures.setLines(static_cast<vtkOpenGLRenderWindow*>(renderer->GetRenderWindow()), rgba);
}

void GBufferMapper::RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor) {
  State& s = *state_;
  ++s.statistics.frames;
  const std::uint64_t made = s.statistics.rasterized;
  if (!prepareFrame(renderer, actor)) return;
  const Stopwatch watch;
  uploadFrame(static_cast<vtkOpenGLRenderWindow*>(renderer->GetRenderWindow()));
  if (s.statistics.rasterized > made) {
    frameMade(s.request, s.frame.view().camera.size, s.frame.seconds() + watch.seconds());
  }
  prepareLines(renderer);
  s.textures.activate();
  UpdateShaders(Primitives[PrimitiveTris], renderer, actor);
  // A new shader has dropped the vertex array, and without one nothing is drawn.
  Primitives[PrimitiveTris].VAO->Bind();
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  s.textures.deactivate();
}

void GBufferMapper::ReleaseGraphicsResources(vtkWindow* window) {
  state_->textures.release(window);
  if (state_->statistics.on_card) state_->frame.clear();
  state_->uploaded = state_->lines_current = false;
  state_->table_time = 0;
  Superclass::ReleaseGraphicsResources(window);
}

void GBufferMapper::GetShaderTemplate(std::map<vtkShader::Type, vtkShader*> shaders,
                                      vtkRenderer* renderer, vtkActor* actor) {
  Superclass::GetShaderTemplate(shaders, renderer, actor);
  shaders[vtkShader::Vertex]->SetSource(resolveVertexShader());
  shaders[vtkShader::Geometry]->SetSource("");
}

void GBufferMapper::ReplaceShaderValues(std::map<vtkShader::Type, vtkShader*> shaders,
                                        vtkRenderer* renderer, vtkActor* actor) {
  std::string source = shaders[vtkShader::Fragment]->GetSource();
  insertResolve(source);
  shaders[vtkShader::Fragment]->SetSource(source);
  Superclass::ReplaceShaderValues(shaders, renderer, actor);
}

void GBufferMapper::SetCameraShaderParameters(vtkOpenGLHelper& primitive, vtkRenderer* renderer,
                                              vtkActor* actor) {
  State& s = *state_;
  vtkShaderProgram* program = primitive.Program;
  std::array<float, 3> color{};
  std::copy_n(actor->GetProperty()->GetDiffuseColor(), 3, color.begin());
  // A processor takes half as long again for the shade in hollows.
  const bool hurry = CardRasterizer::isSoftware() && isInteracting(renderer);
  const bool shaded = s.frame.spacing() <= 1.0 && !hurry;
  program->SetUniformi("slimStudio", s.light == ObjectLight::kStudio);
  program->SetUniformi("slimIsLit", actor->GetProperty()->GetLighting());
  program->SetUniform3f("slimActorColor", color.data());
  program->SetUniformf("slimHollows", shaded ? static_cast<float>(s.hollows) : 0.0f);
  s.textures.tell(program);
  const std::array<float, 3> range = ColorScale(s.mode, GetLookupTable()).shader;
  program->SetUniformi("slimMode", static_cast<int>(s.mode));
  program->SetUniform3f("slimRange", range.data());
  program->SetUniform4f("slimRectangle", s.frame.rectangle().data());
  std::array<float, 4> viewport{};
  std::copy(s.viewport.begin(), s.viewport.end(), viewport.begin());
  program->SetUniform4f("slimViewport", viewport.data());
  tellView(s.frame.view(), s.view.gl, s.planes, program);
}

}  // namespace pcl_slim
