// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/g_buffer_mapper.h"

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "color/color_scale.h"
#include "mapper/mapper_state.h"

namespace pcl_slim {

using namespace detail;

GBufferMapper::GBufferMapper() : state_(std::make_unique<State>())
{
  SetLookupTable(state_->table);
  ScalarVisibilityOff();
}

GBufferMapper::~GBufferMapper() = default;

bool
GBufferMapper::setMode(DisplayMode mode)
{
  if (!supports(mode)) return false;
  if (mode == state_->mode) return true;
  if (mode == DisplayMode::kSketch || state_->mode == DisplayMode::kSketch) dropLines();
  state_->mode = mode;
  state_->table_current = false;
  updateTable();
  Modified();
  return true;
}

DisplayMode
GBufferMapper::getMode() const
{
  return state_->mode;
}

void
GBufferMapper::setRange(double range)
{
  range = std::isfinite(range) ? std::max(0.0, range) : 0.0;
  if (range == state_->range) return;
  state_->range = range;
  state_->table_current = false;
  updateTable();
  Modified();
}

double
GBufferMapper::getRange() const
{
  if (takesRange(state_->mode) && state_->range > 0.0) return state_->range;
  return automaticRange(state_->mode)[1];
}

void
GBufferMapper::setFrameBudget(double milliseconds)
{
  state_->budget = std::isfinite(milliseconds) ? std::max(0.0, milliseconds) : 0.0;
}

double
GBufferMapper::getFrameBudget() const
{
  return state_->budget;
}

void
GBufferMapper::setSides(VisibleSides sides)
{
  if (sides == state_->sides) return;
  state_->sides = sides;
  Modified();
}

VisibleSides
GBufferMapper::getSides() const
{
  return state_->sides;
}

void
GBufferMapper::setNumberOfThreads(int threads)
{
  state_->threads = std::max(0, threads);
}

int
GBufferMapper::getNumberOfThreads() const
{
  return state_->threads;
}

const FrameStatistics&
GBufferMapper::getStatistics() const
{
  return state_->statistics;
}

const Error&
GBufferMapper::getError() const
{
  return state_->error;
}

void
GBufferMapper::objectChanged(vtkPolyData* points, const std::array<double, 6>& bounds)
{
  state_->bounds = bounds;
  ++state_->object;
  state_->frame.clear();
  state_->table_current = false;
  SetInputData(points);
  if (!supports(state_->mode)) state_->mode = DisplayMode::kShaded;
  updateTable();
  Modified();
}

/** \brief Fills the table of colours anew where mode, range or object have changed. */
void
GBufferMapper::updateTable()
{
  State& s = *state_;
  if (s.table_current || !showsNumbers(s.mode)) return;
  std::array<double, 2> limits = automaticRange(s.mode);
  if (takesRange(s.mode) && s.range > 0.0) {
    limits = {showsCurvature(s.mode) ? -s.range : 0.0, s.range};
  }
  fillColorTable(s.mode, limits, *s.table);
  s.table_current = true;
  ++s.statistics.tables;
}

void
GBufferMapper::ComputeBounds()
{
  std::copy(state_->bounds.begin(), state_->bounds.end(), Bounds);
}

void
GBufferMapper::UpdateBufferObjects(vtkRenderer* /*renderer*/, vtkActor* /*actor*/)
{
  // There are no vertices: rays meet the object itself.
}

void
GBufferMapper::complete(FrameRequest& /*request*/) const
{
}

bool
GBufferMapper::wantsLines() const
{
  return false;
}

Error
GBufferMapper::drawLinesOver(const Camera& /*camera*/, const FrameRequest& /*request*/,
                             const GBuffer* /*buffer*/, std::vector<std::uint8_t>& /*rgba*/)
{
  return {};
}

void
GBufferMapper::dropLines()
{
  state_->lines_current = false;
  Modified();
}

bool
GBufferMapper::usesCard(vtkOpenGLRenderWindow* /*window*/, const FrameRequest& /*request*/)
{
  return false;
}

Error
GBufferMapper::drawOnCard(vtkOpenGLRenderWindow* /*window*/, const ViewCamera& /*view*/,
                          const FrameRequest& /*request*/, FrameTextures& /*textures*/,
                          std::uint64_t& /*covered*/)
{
  return {ErrorCode::kBadArgument, "the graphics card does not draw this; draw it on the CPU"};
}

void
GBufferMapper::frameMade(const FrameRequest& /*request*/, const ImageSize& /*size*/,
                         double /*seconds*/)
{
}

void
GBufferMapper::dropFrame()
{
  state_->frame.clear();
  Modified();
}

bool
GBufferMapper::castRay(vtkRenderer* renderer, vtkActor* actor, int x, int y, GBuffer& pixel)
{
  pixel.resize(0, 0);
  int width = 0, height = 0, left = 0, bottom = 0;
  renderer->GetTiledSizeAndOrigin(&width, &height, &left, &bottom);
  x -= left;
  y -= bottom;
  if (x < 0 || y < 0 || x >= width || y >= height) return false;
  const VtkView view = viewOf(renderer, actor, state_->bounds, width, height);
  ViewCamera translated;
  if (translateView(view.gl, view.near_distance, 1, translated)) return false;
  const double column = (x + 0.5) * translated.texels_x - 0.5;
  FrameRequest request{translated.near_plane, state_->sides, state_->threads,
                       clipPlanesOf(this, actor)};
  complete(request);
  request.lod = 0.0;
  const Camera camera = cameraOfPixel(translated.camera, column, height - 1 - y);
  if (rasterize(camera, request, pixel)) return false;
  return pixel.numPixels() == 1 && pixel.covered(0);
}

void
GBufferMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Mode: " << nameOf(state_->mode) << "\n";
  os << indent << "Range: " << state_->range << "\n";
  os << indent << "FrameBudget: " << state_->budget << "\n";
  os << indent << "OnCard: " << state_->statistics.on_card << "\n";
  os << indent << "Rasterized: " << state_->statistics.rasterized << " of "
     << state_->statistics.frames << "\n";
}

}  // namespace pcl_slim
