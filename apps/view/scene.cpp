// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene.h"

#include <vtkActor.h>
#include <vtkBoxRepresentation.h>
#include <vtkBoxWidget2.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkLookupTable.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPlane.h>
#include <vtkPlaneCollection.h>
#include <vtkPlanes.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/visualization/polydata.h"
#include "pcl_slim/visualization/scalar_bar.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "pcl_slim/visualization/splat_mapper.h"
#include "pcl_slim/visualization/studio.h"

namespace pcl_slim {
namespace {

/** \brief Lines from each point along its normal, as long as half its radius. */
vtkSmartPointer<vtkActor> linesAlongNormals(vtkPolyData* pieces) {
  vtkDataArray* normals = pieces->GetPointData()->GetNormals();
  vtkDataArray* radii = pieces->GetPointData()->GetArray("radius");
  vtkNew<vtkPoints> ends;
  ends->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  for (vtkIdType i = 0; i < pieces->GetNumberOfPoints(); ++i) {
    double from[3], n[3];
    pieces->GetPoint(i, from);
    normals->GetTuple(i, n);
    const double size = 0.5 * radii->GetTuple1(i);
    const vtkIdType a = ends->InsertNextPoint(from);
    const vtkIdType b =
        ends->InsertNextPoint(from[0] + size * n[0], from[1] + size * n[1], from[2] + size * n[2]);
    lines->InsertNextCell({a, b});
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(ends);
  data->SetLines(lines);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.10, 0.25, 0.55);
  actor->GetProperty()->SetLighting(false);
  return actor;
}

/** \brief The table of sizeColor() over the radii's 2nd to 98th percentile, by the logarithm. */
vtkSmartPointer<vtkLookupTable> sizeTable(vtkDataArray* radii) {
  std::vector<double> sorted;
  for (vtkIdType i = 0; i < radii->GetNumberOfTuples(); ++i) sorted.push_back(radii->GetTuple1(i));
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(256);
  for (int i = 0; i < 256; ++i) {
    const Color color = sizeColor(i / 255.0);
    table->SetTableValue(i, color[0], color[1], color[2]);
  }
  table->SetScaleToLog10();
  table->SetTableRange(at(0.02), std::max(at(0.98), 1.0001 * at(0.02)));
  return table;
}

/** A scan's finite points, two pixels wide, in their colours if they have any. O(points). */
vtkSmartPointer<vtkActor> makePoints(const CloudView& points, const ColorView& colors) {
  vtkNew<vtkPoints> positions;
  positions->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkUnsignedCharArray> rgb;
  rgb->SetNumberOfComponents(3);
  for (std::size_t i = 0; i < points.count(); ++i) {
    const std::size_t input = points.inputIndex(i);
    const std::array<double, 3> p = points.position(input);
    if (!isFinite(p)) continue;
    const vtkIdType id = positions->InsertNextPoint(p.data());
    vertices->InsertNextCell(1, &id);
    if (!colors.bgr) continue;
    const auto* bgr = static_cast<const unsigned char*>(colors.bgr) + input * colors.stride;
    rgb->InsertNextTuple3(bgr[2], bgr[1], bgr[0]);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(positions);
  data->SetVerts(vertices);
  if (colors.bgr) data->GetPointData()->SetScalars(rgb);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.23, 0.25, 0.29);
  actor->GetProperty()->SetPointSize(2.0f);
  actor->GetProperty()->SetLighting(false);
  return actor;
}

/** The balls of a surface's leaves as far as they cover, small red to large blue (Fig. 1 of
 * Ohtake, Belyaev, Alexa 2005). O(leaves). */
vtkSmartPointer<vtkActor> makeBalls(const SLIMSurface& surface) {
  const vtkSmartPointer<vtkPolyData> leaves = toPolyData(surface, true);
  vtkDataArray* radii = leaves->GetPointData()->GetArray("radius");
  vtkNew<vtkFloatArray> reach;
  reach->SetName("reach");
  for (vtkIdType i = 0; i < radii->GetNumberOfTuples(); ++i) {
    reach->InsertNextValue(static_cast<float>(surface.info.cover_radius * radii->GetTuple1(i)));
  }
  leaves->GetPointData()->AddArray(reach);
  leaves->GetPointData()->SetActiveScalars("radius");
  vtkNew<vtkOpenGLSphereMapper> mapper;
  mapper->SetInputData(leaves);
  mapper->SetScaleArray("reach");
  mapper->SetScalarModeToUsePointData();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  if (radii->GetNumberOfTuples() == 0) return actor;
  const vtkSmartPointer<vtkLookupTable> table = sizeTable(radii);
  mapper->SetLookupTable(table);
  mapper->SetUseLookupTableScalarRange(true);
  actor->GetProperty()->SetAmbient(0.3);
  actor->GetProperty()->SetDiffuse(0.8);
  return actor;
}

/** Normals of leaves or splats as lines of half a radius. O(leaves or splats). */
vtkSmartPointer<vtkActor> makeNormals(const SLIMSurface& surface) {
  return linesAlongNormals(toPolyData(surface, true));
}

vtkSmartPointer<vtkActor> makeNormals(const SplatSet& splats) {
  return linesAlongNormals(toPolyData(splats));
}

void setShown(vtkActor* actor, bool shown) {
  if (actor) actor->SetVisibility(shown);
}

bool isShown(vtkActor* actor) {
  return actor && actor->GetVisibility();
}

}  // namespace

Scene::Scene(vtkRenderer* renderer) : renderer_(renderer) {}
Scene::~Scene() = default;

void Scene::setSurface(std::shared_ptr<const SLIMSurface> surface) {
  surface_ = std::move(surface);
  if (SLIMMapper* const shown = surfaceMapper()) {
    shown->setSurface(surface_);
    const bool balls = ballsShown(), normals = normalsShown();
    remove(balls_);
    remove(normals_);
    showBalls(balls);
    showNormals(normals);
    return;
  }
  vtkNew<SLIMMapper> mapper;
  mapper->setSurface(surface_);
  setMapper(mapper);
}

void Scene::setSplats(std::shared_ptr<const SplatSet> splats) {
  splats_ = std::move(splats);
  vtkNew<SplatMapper> mapper;
  mapper->setSplats(splats_);
  setMapper(mapper);
}

void Scene::setMapper(GBufferMapper* mapper) {
  mapper_ = mapper;
  mapper_->setLight(ObjectLight::kStudio);
  model_ = vtkSmartPointer<vtkActor>::New();
  model_->SetMapper(mapper_);
  setClayLook(model_->GetProperty());
  model_->GetProperty()->SetLighting(lit_);
  const BoundingSpheres object = spheres();
  diagonal_ = object.scale * object.diagonal;
  add(model_);
  // Points of two pixels would cover the surface below them.
  if (points_) points_->GetProperty()->SetPointSize(1.0f);
}

void Scene::setPoints(const CloudView& points, const ColorView& colors) {
  const bool shown = !points_ || pointsShown();
  remove(points_);
  points_ = makePoints(points, colors);
  points_->SetVisibility(shown);
  if (model_) points_->GetProperty()->SetPointSize(1.0f);
  add(points_);
  point_spheres_ = spheresOfPoints(points);
}

void Scene::setLighting(bool lit) {
  lit_ = lit;
  if (model_) model_->GetProperty()->SetLighting(lit);
}

GBufferMapper* Scene::mapper() const {
  return mapper_;
}

SLIMMapper* Scene::surfaceMapper() const {
  return SLIMMapper::SafeDownCast(mapper_);
}

vtkActor* Scene::model() const {
  return model_;
}

BoundingSpheres Scene::spheres() const {
  if (surface_) return spheresOf(*surface_);
  if (splats_) return spheresOf(*splats_);
  return point_spheres_;
}

bool Scene::setMode(DisplayMode mode, double range) {
  if (!mapper_ || !mapper_->setMode(mode)) return false;
  mapper_->setRange(range);
  updateBar();
  return true;
}

void Scene::stepMode(int step) {
  if (!mapper_) return;
  const int count = static_cast<int>(displayModeNames().size());
  int mode = static_cast<int>(mapper_->getMode());
  do {
    mode = (mode + step + count) % count;
  } while (!mapper_->supports(static_cast<DisplayMode>(mode)));
  setMode(static_cast<DisplayMode>(mode), 0.0);
}

void Scene::scaleRange(double factor) {
  if (!mapper_ || !takesRange(mapper_->getMode())) return;
  mapper_->setRange(factor > 0.0 ? factor * mapper_->getRange() : 0.0);
}

void Scene::updateBar() {
  if (bar_) renderer_->RemoveActor2D(bar_);
  bar_ = nullptr;
  if (!showsNumbers(mapper_->getMode())) return;
  bar_ = makeScalarBar(*mapper_, unit_);
  contrastWith(renderer_, bar_);
  setLetters(bar_, letters_);
  renderer_->AddActor2D(bar_);
}

void Scene::setBarLetters(int pixels) {
  letters_ = pixels;
  if (bar_) setLetters(bar_, letters_);
}

/** Adds what a mapper draws to the window, cut as all else. */
void Scene::add(vtkActor* actor) {
  actor->GetMapper()->SetClippingPlanes(cuts_);
  renderer_->AddActor(actor);
}

void Scene::remove(vtkSmartPointer<vtkActor>& actor) {
  if (actor) renderer_->RemoveActor(actor);
  actor = nullptr;
}

void Scene::cut(const std::vector<HalfSpace>& sides) {
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

void Scene::showModel(bool shown) {
  setShown(model_, shown);
}

void Scene::showPoints(bool shown) {
  setShown(points_, shown);
}

void Scene::showBalls(bool shown) {
  if (shown && !balls_ && surface_) {
    balls_ = makeBalls(*surface_);
    add(balls_);
  }
  setShown(balls_, shown);
}

void Scene::showNormals(bool shown) {
  if (shown && !normals_ && (surface_ || splats_)) {
    normals_ = surface_ ? makeNormals(*surface_) : makeNormals(*splats_);
    add(normals_);
  }
  setShown(normals_, shown);
}

bool Scene::modelShown() const {
  return isShown(model_);
}

bool Scene::pointsShown() const {
  return isShown(points_);
}

bool Scene::ballsShown() const {
  return isShown(balls_);
}

bool Scene::normalsShown() const {
  return isShown(normals_);
}

namespace {

void onDragged(vtkObject*, unsigned long, void* dragged, void*) {
  (*static_cast<std::function<void()>*>(dragged))();
}

}  // namespace

CutBox::CutBox(const std::function<void()>& dragged) : dragged_(dragged) {
  box_->SetPlaceFactor(1.0);
  box_->InsideOutOn();
  box_->GetOutlineProperty()->SetColor(0.25, 0.3, 0.4);
  box_->GetSelectedOutlineProperty()->SetColor(0.85, 0.35, 0.1);
  box_->GetHandleProperty()->SetColor(0.25, 0.3, 0.4);
  box_->GetSelectedHandleProperty()->SetColor(0.85, 0.35, 0.1);
  box_->GetFaceProperty()->SetOpacity(0.0);
  box_->GetSelectedFaceProperty()->SetOpacity(0.0);
  widget_->SetRepresentation(box_);
  widget_->SetKeyPressActivation(0);
  widget_->RotationEnabledOff();
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(onDragged);
  command->SetClientData(&dragged_);
  widget_->AddObserver(vtkCommand::InteractionEvent, command);
}

CutBox::~CutBox() = default;

void CutBox::show(vtkRenderWindowInteractor* interactor, const std::array<double, 6>& bounds) {
  std::array<double, 6> place = bounds;
  box_->PlaceWidget(place.data());
  widget_->SetInteractor(interactor);
  widget_->On();
}

void CutBox::hide() {
  widget_->Off();
}

bool CutBox::shown() const {
  return const_cast<vtkBoxWidget2*>(widget_.Get())->GetEnabled() != 0;
}

std::vector<HalfSpace> CutBox::sides() const {
  vtkNew<vtkPlanes> planes;
  const_cast<vtkBoxRepresentation*>(box_.Get())->GetPlanes(planes);
  std::vector<HalfSpace> sides;
  for (int i = 0; i < planes->GetNumberOfPlanes(); ++i) {
    vtkPlane* const plane = planes->GetPlane(i);
    const double *n = plane->GetNormal(), *p = plane->GetOrigin();
    sides.push_back({{n[0], n[1], n[2]}, n[0] * p[0] + n[1] * p[1] + n[2] * p[2]});
  }
  return sides;
}

}  // namespace pcl_slim
