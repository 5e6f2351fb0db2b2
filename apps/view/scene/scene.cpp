// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene/scene.h"

#include <vtkActor.h>
#include <vtkMapper.h>
#include <vtkPlane.h>
#include <vtkPlaneCollection.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>

#include "pcl_slim/visualization/scalar_bar.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "pcl_slim/visualization/splat_mapper.h"
#include "view/scene/point_spheres.h"
#include "view/scene/scene_parts.h"

namespace pcl_slim {
namespace {

void
setShown(vtkActor* actor, bool shown)
{
  if (actor) actor->SetVisibility(shown);
}

bool
isShown(vtkActor* actor)
{
  return actor && actor->GetVisibility();
}

}  // namespace

Scene::Scene(vtkRenderer* renderer) : renderer_(renderer) {}
Scene::~Scene() = default;

void
Scene::setSurface(std::shared_ptr<const SLIMSurface> surface)
{
  surface_ = std::move(surface);
  vtkNew<SLIMMapper> mapper;
  mapper->setSurface(surface_);
  setMapper(mapper);
}

void
Scene::setSplats(std::shared_ptr<const SplatSet> splats)
{
  splats_ = std::move(splats);
  vtkNew<SplatMapper> mapper;
  mapper->setSplats(splats_);
  setMapper(mapper);
}

void
Scene::setMapper(GBufferMapper* mapper)
{
  mapper_ = mapper;
  model_ = vtkSmartPointer<vtkActor>::New();
  model_->SetMapper(mapper_);
  setClayLook(model_->GetProperty());
  add(model_);
  // Points of two pixels would cover the surface below them.
  if (points_) points_->GetProperty()->SetPointSize(1.0f);
}

void
Scene::setPoints(const CloudView& points, const ColorView& colors)
{
  points_ = makePoints(points, colors);
  add(points_);
  point_spheres_ = spheresOfPoints(points);
}

GBufferMapper*
Scene::mapper() const
{
  return mapper_;
}

SLIMMapper*
Scene::surfaceMapper() const
{
  return SLIMMapper::SafeDownCast(mapper_);
}

vtkActor*
Scene::model() const
{
  return model_;
}

BoundingSpheres
Scene::spheres() const
{
  if (surface_) return spheresOf(*surface_);
  if (splats_) return spheresOf(*splats_);
  return point_spheres_;
}

bool
Scene::setMode(DisplayMode mode, double range)
{
  if (!mapper_ || !mapper_->setMode(mode)) return false;
  mapper_->setRange(range);
  updateBar();
  return true;
}

void
Scene::stepMode(int step)
{
  if (!mapper_) return;
  const int count = static_cast<int>(displayModeNames().size());
  int mode = static_cast<int>(mapper_->getMode());
  do {
    mode = (mode + step + count) % count;
  } while (!mapper_->supports(static_cast<DisplayMode>(mode)));
  setMode(static_cast<DisplayMode>(mode), 0.0);
}

void
Scene::scaleRange(double factor)
{
  if (!mapper_ || !takesRange(mapper_->getMode())) return;
  mapper_->setRange(factor > 0.0 ? factor * mapper_->getRange() : 0.0);
}

void
Scene::updateBar()
{
  if (bar_) renderer_->RemoveActor2D(bar_);
  bar_ = nullptr;
  if (!showsNumbers(mapper_->getMode())) return;
  bar_ = makeScalarBar(*mapper_);
  contrastWith(renderer_, bar_);
  setLetters(bar_, letters_);
  renderer_->AddActor2D(bar_);
}

void
Scene::setBarLetters(int pixels)
{
  letters_ = pixels;
  if (bar_) setLetters(bar_, letters_);
}

/** Adds what a mapper draws to the window, cut as all else. */
void
Scene::add(vtkActor* actor)
{
  actor->GetMapper()->SetClippingPlanes(cuts_);
  renderer_->AddActor(actor);
}

void
Scene::cut(const std::vector<HalfSpace>& sides)
{
  cuts_->RemoveAllItems();
  for (const HalfSpace& side : sides) {
    vtkNew<vtkPlane> plane;
    plane->SetNormal(side.normal.data());
    plane->SetOrigin(side.normal[0] * side.offset, side.normal[1] * side.offset,
                     side.normal[2] * side.offset);
    cuts_->AddItem(plane);
  }
  for (vtkActor* actor : {model_.Get(), points_.Get(), balls_.Get(), normals_.Get()}) {
    if (actor) actor->GetMapper()->Modified();
  }
}

void
Scene::showModel(bool shown)
{
  setShown(model_, shown);
}

void
Scene::showPoints(bool shown)
{
  setShown(points_, shown);
}

void
Scene::showBalls(bool shown)
{
  if (shown && !balls_ && surface_) {
    balls_ = makeBalls(*surface_);
    add(balls_);
  }
  setShown(balls_, shown);
}

void
Scene::showNormals(bool shown)
{
  if (shown && !normals_ && (surface_ || splats_)) {
    normals_ = surface_ ? makeNormals(*surface_) : makeNormals(*splats_);
    add(normals_);
  }
  setShown(normals_, shown);
}

bool
Scene::modelShown() const
{
  return isShown(model_);
}

bool
Scene::pointsShown() const
{
  return isShown(points_);
}

bool
Scene::ballsShown() const
{
  return isShown(balls_);
}

bool
Scene::normalsShown() const
{
  return isShown(normals_);
}

}  // namespace pcl_slim
