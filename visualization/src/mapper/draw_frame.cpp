// SPDX-License-Identifier: BSD-3-Clause
// How a GBufferMapper draws: rays, lines, the textures of both, and the shader that resolves them.
#include <vtkActor.h>
#include <vtkOpenGLHelper.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkOpenGLVertexArrayObject.h>
#include <vtkRenderer.h>
#include <vtkShader.h>
#include <vtkShaderProgram.h>
#include <vtk_glew.h>

#include <algorithm>

#include "color/color_scale.h"
#include "mapper/mapper_state.h"
#include "pcl_slim/core/stopwatch.h"
#include "shader/resolve_shader.h"

namespace pcl_slim {

using namespace detail;

/** \brief Intersects a frame's rays on the graphics card or, failing that, on the CPU. */
Error
GBufferMapper::makeFrame(vtkOpenGLRenderWindow* window, FrameRequest request, int coarseness)
{
  State& s = *state_;
  const FrameKey key(s.view, request, s.object);
  if (coarseness > 1) request.columns &= kColorColumn;
  s.request = request;
  s.statistics.on_card = false;
  if (usesCard(window, request)) {
    const Error error = s.frame.makeOnCard(
        s.view, key, coarseness, request,
        [&](const ViewCamera& view, const FrameRequest& what, std::uint64_t& covered) {
          return drawOnCard(window, view, what, s.textures, covered);
        });
    s.statistics.on_card = s.uploaded = !error;
    if (!error) return {};
  }
  s.uploaded = false;
  return s.frame.make(s.view, key, coarseness, request, lengthScale(),
                      [this](const Camera& camera, const FrameRequest& what, GBuffer& buffer) {
                        return rasterize(camera, what, buffer);
                      });
}

/** \brief Intersects rays unless the last frame is still valid. \return false for an empty frame. */
bool
GBufferMapper::prepareFrame(vtkRenderer* renderer, vtkActor* actor)
{
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
  const int coarseness = hurry ? s.frame.coarsenessFor(s.budget) : 1;
  if (!s.frame.holds(key, coarseness)) {
    s.lines_current = false;
    s.error = makeFrame(window, request, coarseness);
    if (s.error) {
      vtkErrorMacro(<< s.error.message);
      return false;
    }
    ++s.statistics.rasterized;
    s.statistics.coarseness = coarseness;
    s.statistics.covered_pixels = s.frame.coveredPixels();
    s.statistics.rasterize_seconds = s.frame.seconds();
  }
  return s.frame.coveredPixels() > 0;
}

/** \brief Brings over to the graphics card what has changed since it was there. */
void
GBufferMapper::uploadFrame(vtkOpenGLRenderWindow* window)
{
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

/** \brief Draws lines over the frame where it has a ray for every pixel, while the mouse moves only if
 * frame and lines together take no longer than the budget. */
void
GBufferMapper::prepareLines(vtkRenderer* renderer)
{
  State& s = *state_;
  if (s.lines_current && wantsLines()) return;
  s.textures.dropLines();
  const double milliseconds = 1000.0 * (s.frame.seconds() + s.statistics.line_seconds);
  const bool slow = s.budget > 0.0 && (s.statistics.lines == 0 || milliseconds > s.budget);
  if (!wantsLines() || s.frame.coarseness() > 1 || (slow && isInteracting(renderer))) return;
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

void
GBufferMapper::RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor)
{
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

void
GBufferMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  state_->textures.release(window);
  if (state_->statistics.on_card) state_->frame.clear();
  state_->uploaded = state_->lines_current = false;
  state_->table_time = 0;
  Superclass::ReleaseGraphicsResources(window);
}

void
GBufferMapper::GetShaderTemplate(std::map<vtkShader::Type, vtkShader*> shaders,
                                 vtkRenderer* renderer, vtkActor* actor)
{
  Superclass::GetShaderTemplate(shaders, renderer, actor);
  shaders[vtkShader::Vertex]->SetSource(resolveVertexShader());
  shaders[vtkShader::Geometry]->SetSource("");
}

void
GBufferMapper::ReplaceShaderValues(std::map<vtkShader::Type, vtkShader*> shaders,
                                   vtkRenderer* renderer, vtkActor* actor)
{
  std::string source = shaders[vtkShader::Fragment]->GetSource();
  insertResolve(source);
  shaders[vtkShader::Fragment]->SetSource(source);
  Superclass::ReplaceShaderValues(shaders, renderer, actor);
}

void
GBufferMapper::SetCameraShaderParameters(vtkOpenGLHelper& primitive, vtkRenderer* /*renderer*/,
                                         vtkActor* /*actor*/)
{
  State& s = *state_;
  vtkShaderProgram* program = primitive.Program;
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
