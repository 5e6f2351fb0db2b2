// SPDX-License-Identifier: BSD-3-Clause
#include "opengl/card_rasterizer.h"

#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLShaderCache.h>
#include <vtkOpenGLState.h>
#include <vtkShaderProgram.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "frame/frame.h"
#include "glsl/glsl.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/detail/frame_constants.h"

namespace pcl_slim::detail {
namespace {

float single(double x) {
  return static_cast<float>(x);
}

void clear(int target, float value) {
  const float values[4] = {value, value, value, value};
  glClearBufferfv(GL_COLOR, target, values);
}

}  // namespace

/** \brief The shaders' values of a frame: the rules of FrameRules in float. */
struct CardRasterizer::FrameValues {
  float eye[3], eye_rest[3], axes[9], screen[4], shift[2];
  float near_depth, shrink, reach, cover_radius, min_coverage, scale, detail;
  int front_only, oriented, kernel, degree, trimmed, texels, color_at;

  FrameValues(const SLIMSurface& surface, const ViewCamera& view, const FrameRequest& request) {
    const SurfaceInfo& info = surface.info;
    setCamera(info, view.camera);
    near_depth = single(std::max(0.0, request.near_plane) / info.scale);
    shrink = single(std::clamp(info.cover_radius, 0.05, 0.95));
    reach = std::max(shrink, weightReach(info.blend_kernel));
    cover_radius = single(std::clamp(info.cover_radius, 0.05, 1.0));
    min_coverage = single(info.cover_threshold);
    scale = single(info.scale);
    front_only = request.sides == VisibleSides::kFront ||
                 (request.sides == VisibleSides::kAuto && info.hasFront());
    oriented = info.hasFront();
    kernel = static_cast<int>(info.blend_kernel);
    degree = info.degree;
    trimmed = request.trim;
    texels = texelsOfLeaf(degree, surface.hasColors());
    color_at = texelsOfLeaf(degree);
    detail = 0.5f * single(request.lod) * screen[0];
  }

  void setCamera(const SurfaceInfo& info, const Camera& camera) {
    const Vector3 forward = normalized(subtract(camera.look_at, camera.position));
    const Vector3 right = normalized(cross(forward, camera.up));
    const Vector3 up = cross(right, forward);
    const bool parallel = camera.projection == Camera::Projection::kOrthographic;
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = (camera.position[k] - info.origin[k]) / info.scale;
      eye[k] = single(at);
      eye_rest[k] = single(at - double{eye[k]});
      axes[k] = single(right[k]);
      axes[3 + k] = single(up[k]);
      axes[6 + k] = single(forward[k]);
    }
    const double height =
        parallel ? camera.view_height / info.scale : 2.0 * std::tan(camera.fov * M_PI / 360.0);
    screen[0] = single(height / camera.size.height);
    screen[1] = single(camera.size.width);
    screen[2] = single(camera.size.height);
    screen[3] = parallel ? 1.0f : 0.0f;
    for (std::size_t k = 0; k < 2; ++k) shift[k] = single(camera.pixel_offset[k]);
  }
};

/** \brief One frame's passes: programs, and textures to read while a pass runs. */
struct CardRasterizer::Pass {
  vtkOpenGLRenderWindow* window;
  vtkOpenGLState* state;
  const FrameValues& values;
  const LeafBuffer& leaves;
  vtkShaderProgram* program = nullptr;
  std::vector<vtkTextureObject*> read;

  Error begin(const std::string& vertex, const std::string& fragment) {
    program = window->GetShaderCache()->ReadyShaderProgram(vertex.c_str(), fragment.c_str(), "");
    if (program) return {};
    return {ErrorCode::kBadArgument,
            "the graphics card's driver does not take the shaders; draw on the CPU"};
  }

  void texture(const char* name, vtkTextureObject* source) {
    source->Activate();
    program->SetUniformi(name, source->GetTextureUnit());
    read.push_back(source);
  }

  /** \brief Draws a rectangle around every leaf, and every internal surfel that a level of detail
   * may show. \param[in] reach share of its radius; turned_away: those too whose inner sides alone
   * are seen */
  void drawLeaves(float reach, bool is_first = false, bool turned_away = false) {
    texture("slimLeaves", leaves.texture());
    const FrameValues& v = values;
    program->SetUniform3f("slimEye", v.eye);
    program->SetUniform3f("slimEyeRest", v.eye_rest);
    program->SetUniformMatrix3x3("slimAxes", const_cast<float*>(v.axes));
    program->SetUniform4f("slimScreen", v.screen);
    program->SetUniform2f("slimShift", v.shift);
    program->SetUniformf("slimReach", reach);
    program->SetUniformi("slimTexelsOfLeaf", v.texels);
    program->SetUniformi("slimDegree", v.degree);
    program->SetUniformi("slimFrontOnly", v.front_only && !turned_away);
    program->SetUniformi("slimKernel", v.kernel);
    program->SetUniformf("slimNear", v.near_depth);
    program->SetUniformf("slimCoverRadius", v.cover_radius);
    program->SetUniformf("slimScale", v.scale);
    program->SetUniformf("slimDetail", v.detail);
    program->SetUniformi("slimFirstPass", is_first);
    program->SetUniformi("slimMostSide", TrimMap::kMostSide);
    program->SetUniformi("slimTrimmed", v.trimmed);
    program->SetUniformi("slimColorAt", v.color_at);
    program->SetUniformi("slimOriented", v.oriented);
    const int count = v.detail > 0.0f ? leaves.surfels() : leaves.leaves();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
    end();
  }

  void drawFrame() {
    program->SetUniformf("slimMinCoverage", values.min_coverage);
    program->SetUniformf("slimScale", values.scale);
    program->SetUniformi("slimOriented", values.oriented);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    end();
  }

  void end() {
    for (vtkTextureObject* source : read) source->Deactivate();
    read.clear();
  }

  /** \brief Draws where the depth buffer does not stop it. */
  void drawOpenPixels() {
    state->vtkglEnable(GL_DEPTH_TEST);
    state->vtkglDepthFunc(GL_LESS);
    state->vtkglDepthMask(GL_FALSE);
  }

  void addInto(unsigned equation) {
    state->vtkglEnable(GL_BLEND);
    state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE, GL_ONE, GL_ONE);
    state->vtkglBlendEquationSeparate(equation, equation);
  }
};

bool CardRasterizer::isSoftware() {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string renderer = name ? name : "llvmpipe";
  for (const char* software : {"llvmpipe", "softpipe", "SWR", "Software"}) {
    if (renderer.find(software) != std::string::npos) return true;
  }
  return false;
}

void CardRasterizer::setSurface(const SLIMSurface* surface) {
  if (surface == surface_) return;
  surface_ = surface;
  leaves_.forget();
}

Error CardRasterizer::draw(vtkOpenGLRenderWindow* window, const ViewCamera& view,
                           const FrameRequest& request, FrameTextures& frame,
                           std::uint64_t& covered) {
  covered = 0;
  if (!surface_) return {};
  if (Error error = leaves_.upload(window, *surface_, request.lod > 0.0)) return error;
  if (leaves_.leaves() == 0) return {};
  const int width = view.camera.size.width, height = view.camera.size.height;
  const CardState keeper(window);
  targets_.resize(window, width, height);
  const bool colored = (request.columns & kColorColumn) != 0 && surface_->hasColors();
  frame.allocate(window, width, height, colored);
  if (vertices_ == 0) glGenVertexArrays(1, &vertices_);
  if (query_ == 0) glGenQueries(1, &query_);
  glBindVertexArray(vertices_);
  window->GetState()->vtkglViewport(0, 0, width, height);
  const FrameValues values(*surface_, view, request);
  Pass pass{window, window->GetState(), values, leaves_, nullptr, {}};
  if (Error error = drawPasses(pass, frame, covered)) return error;
  return colored ? addColors(pass, frame) : Error{};
}

Error CardRasterizer::drawPasses(Pass& pass, FrameTextures& frame, std::uint64_t& covered) {
  if (Error error = targets_.drawInto({frame.geometry(), frame.attributes(), targets_.met})) {
    return error;
  }
  for (int target = 0; target < 2; ++target) clear(target, 0.0f);
  clear(2, kNothing);
  if (Error error = targets_.drawInto({targets_.nearest[0]}, true)) return error;
  clear(0, pass.values.near_depth);
  targets_.clearDepth(1.0f);
  std::uint64_t left = 1;
  for (int i = 0; i < kMaxLayers && left > 0; ++i) {
    const int from = i % 2;
    if (Error error = findFirst(pass, from)) return error;
    if (Error error = blend(pass)) return error;
    if (Error error = writeResult(pass, from, frame, covered)) return error;
    if (Error error = peel(pass, from, left)) return error;
  }
  return nameLeaves(pass, frame);
}

Error CardRasterizer::findFirst(Pass& pass, int from) {
  if (Error error = targets_.drawInto({targets_.first}, true)) return error;
  clear(0, kNothing);
  if (Error error = pass.begin(leafVertexShader(), firstPassShader())) return error;
  pass.addInto(GL_MIN);
  pass.drawOpenPixels();
  pass.texture("slimNearest", targets_.nearest[static_cast<std::size_t>(from)]);
  pass.texture("slimTrims", leaves_.trims());
  pass.drawLeaves(pass.values.shrink, true);
  return {};
}

Error CardRasterizer::blend(Pass& pass) {
  auto& sums = targets_.sums;
  if (Error error = targets_.drawInto({sums[0], sums[1], sums[2], sums[3], sums[4]}, true))
    return error;
  for (int target = 0; target < 5; ++target) clear(target, 0.0f);
  if (Error error = pass.begin(leafVertexShader(), blendPassShader())) return error;
  pass.addInto(GL_FUNC_ADD);
  pass.drawOpenPixels();
  pass.texture("slimFirst", targets_.first);
  pass.texture("slimTrims", leaves_.trims());
  pass.drawLeaves(pass.values.reach);
  return {};
}

Error CardRasterizer::writeResult(Pass& pass, int from, FrameTextures& frame,
                                  std::uint64_t& covered) {
  if (Error error = targets_.drawInto({frame.geometry(), frame.attributes(), targets_.met})) {
    return error;
  }
  if (Error error = pass.begin(frameVertexShader(), resultShader())) return error;
  pass.state->vtkglDisable(GL_BLEND);
  pass.state->vtkglDisable(GL_DEPTH_TEST);
  pass.texture("slimFirst", targets_.first);
  pass.texture("slimNearest", targets_.nearest[static_cast<std::size_t>(from)]);
  for (std::size_t i = 0; i < 5; ++i) {
    pass.texture(("slimSums" + std::to_string(i)).c_str(), targets_.sums[i]);
  }
  glBeginQuery(GL_SAMPLES_PASSED, query_);
  pass.drawFrame();
  covered += countDrawn();
  return {};
}

Error CardRasterizer::peel(Pass& pass, int from, std::uint64_t& left) {
  const auto source = static_cast<std::size_t>(from);
  if (Error error = targets_.drawInto({targets_.nearest[1 - source]}, true)) return error;
  clear(0, -1.0f);
  // In the next round the card discards the fragments on pixels that are done before they are
  // shaded.
  pass.state->vtkglDepthMask(GL_TRUE);
  targets_.clearDepth(0.0f);
  pass.state->vtkglEnable(GL_DEPTH_TEST);
  pass.state->vtkglDepthFunc(GL_ALWAYS);
  if (Error error = pass.begin(frameVertexShader(), peelShader())) return error;
  pass.texture("slimFirst", targets_.first);
  pass.texture("slimNearest", targets_.nearest[source]);
  for (std::size_t i = 0; i < 5; ++i) {
    pass.texture(("slimSums" + std::to_string(i)).c_str(), targets_.sums[i]);
  }
  glBeginQuery(GL_SAMPLES_PASSED, query_);
  pass.drawFrame();
  left = countDrawn();
  return {};
}

Error CardRasterizer::nameLeaves(Pass& pass, FrameTextures& frame) {
  if (Error error = targets_.drawInto({frame.attributes()}, true)) return error;
  pass.state->vtkglDepthMask(GL_TRUE);
  targets_.clearDepth(1.0f);
  if (Error error = pass.begin(leafVertexShader(), leafPassShader())) return error;
  pass.state->vtkglDisable(GL_BLEND);
  pass.state->vtkglEnable(GL_DEPTH_TEST);
  pass.state->vtkglDepthFunc(GL_LESS);
  // Curvatures are in the first two channels already.
  pass.state->vtkglColorMask(GL_FALSE, GL_FALSE, GL_TRUE, GL_TRUE);
  pass.texture("slimFirst", targets_.met);
  pass.drawLeaves(pass.values.reach);
  return {};
}

Error CardRasterizer::addColors(Pass& pass, FrameTextures& frame) {
  if (Error error = targets_.drawInto({frame.colors()})) return error;
  pass.state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE,
                             GL_TRUE);  // heeded when buffers are cleared
  clear(0, 0.0f);
  const bool textured = surface_->hasTextures();
  if (Error error = pass.begin(leafVertexShader(), colorPassShader(textured))) {
    return error;
  }
  pass.state->vtkglDisable(GL_DEPTH_TEST);
  pass.addInto(GL_FUNC_ADD);
  pass.texture("slimShown", frame.geometry());
  if (textured) pass.texture("slimTextures", leaves_.colors());
  pass.drawLeaves(1.0f, false, true);
  return {};
}

void CardRasterizer::readMet(std::vector<float>& depths) const {
  depths.resize(std::size_t{targets_.met->GetWidth()} * targets_.met->GetHeight());
  targets_.met->Activate();
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, depths.data());
  targets_.met->Deactivate();
}

/** \brief Ends a count of pixels drawn. */
std::uint64_t CardRasterizer::countDrawn() {
  glEndQuery(GL_SAMPLES_PASSED);
  GLuint count = 0;
  glGetQueryObjectuiv(query_, GL_QUERY_RESULT, &count);
  return count;
}

void CardRasterizer::release(vtkWindow* window) {
  if (vertices_ == 0) return;
  window->MakeCurrent();
  leaves_.release(window);
  targets_.release(window);
  glDeleteVertexArrays(1, &vertices_);
  glDeleteQueries(1, &query_);
  vertices_ = query_ = 0;
}

}  // namespace pcl_slim::detail
