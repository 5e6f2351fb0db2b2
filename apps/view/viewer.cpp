// SPDX-License-Identifier: BSD-3-Clause
#include "view/viewer.h"

#include <vtkCamera.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <algorithm>

#include "pcl_slim/visualization/scalar_bar.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "view/readout.h"
#include "view/viewer_style.h"
#include "view/vtk_camera.h"

namespace pcl_slim {
namespace {

/** \brief A grey that grows lighter upwards, or white paper. */
void
setBackground(vtkRenderer* renderer, bool is_paper)
{
  renderer->SetGradientBackground(!is_paper);
  if (is_paper) return renderer->SetBackground(1.0, 1.0, 1.0);
  renderer->SetBackground(0.84, 0.84, 0.846);
  renderer->SetBackground2(0.985, 0.985, 0.99);
}

RayBackend
backendOf(const std::string& name)
{
  return name == "cpu"      ? RayBackend::kCPU
         : name == "opengl" ? RayBackend::kOpenGL
                            : RayBackend::kAuto;
}

constexpr double kBarShare = 0.14;  ///< of the window's width, left to the scalar bar

/** \brief What the user may change of a camera's place. */
std::vector<double>
placeOf(vtkCamera* camera)
{
  std::vector<double> place;
  for (const double* values :
       {camera->GetPosition(), camera->GetFocalPoint(), camera->GetViewUp()}) {
    place.insert(place.end(), values, values + 3);
  }
  place.push_back(camera->GetParallelScale());
  return place;
}

}  // namespace

Viewer::Viewer(const ViewerSettings& settings, bool on_screen)
    : settings_(settings),
      scene_(renderer_),
      overlay_(renderer_),
      cut_box_([this] { scene_.cut(cut_box_.sides()); })
{
  setBackground(renderer_, false);
  setStudioLights(renderer_);
  renderer_->UseFXAAOn();
  window_->SetMultiSamples(0);
  if (!on_screen) window_->SetOffScreenRendering(1);
  window_->SetSize(settings.view.size.width, settings.view.size.height);
  window_->SetWindowName(settings.title.c_str());
  window_->AddRenderer(renderer_);
  if (!on_screen) return;
  interactor_->SetRenderWindow(window_);
  vtkNew<ViewerStyle> style;
  style->on_key = [this](const std::string& symbol) { onKey(symbol); };
  style->on_move = [this] { mouse_rests_ = false; };
  style->on_resize = [this] { onResized(); };
  style->on_timer = [this] { onTimer(); };
  interactor_->SetInteractorStyle(style);
}

Viewer::~Viewer() = default;

void
Viewer::begin()
{
  GBufferMapper* mapper = scene_.mapper();
  if (mapper) {
    mapper->setFrameBudget(settings_.frame_budget);
    mapper->setNumberOfThreads(settings_.threads);
    const std::string automatic = scene_.hasColors() ? "color" : "shaded";
    const std::string& name = settings_.mode == "auto" ? automatic : settings_.mode;
    if (const auto mode = displayModeOf(name)) scene_.setMode(*mode, settings_.range);
    if (settings_.region.sides.empty() && settings_.view.opens(scene_.spheres()))
      mapper->setSides(VisibleSides::kFront);
  }
  if (SLIMMapper* surface = scene_.surfaceMapper()) {
    surface->setBackend(backendOf(settings_.backend));
    surface->setLevelOfDetail(settings_.lod);
    setLines(settings_.lines);
  }
  scene_.cut(cut_box_.shown() ? cut_box_.sides() : settings_.region.sides);
  scene_.showBalls(settings_.balls);
  scene_.showNormals(settings_.normals);
  scene_.showPoints(settings_.points || !mapper);
  overlay_.showHelp(settings_.help);
  if (!isCameraTheUsers()) resetCamera();
  onResized();
  updateStatus();
}

void
Viewer::run()
{
  window_->Render();
  interactor_->Initialize();
  interactor_->CreateRepeatingTimer(100);
  interactor_->Start();
}

Error
Viewer::runFit(FitTask& task)
{
  task_ = &task;
  run();
  task_ = nullptr;
  return fit_error_;
}

Error
Viewer::saveScreenshot(const std::string& path)
{
  // Nobody reads in a picture which keys there are.
  overlay_.setStatus("");
  render();
  return savePicture(window_, path);
}

void
Viewer::render()
{
  renderer_->ResetCameraClippingRange();
  window_->Render();
}

void
Viewer::resetCamera()
{
  settings_.view.size = {window_->GetSize()[0], window_->GetSize()[1]};
  const bool parallel = renderer_->GetActiveCamera()->GetParallelProjection() != 0;
  BoundingSpheres object = scene_.spheres();
  if (Result<BoundingSpheres> part = settings_.region.within(object)) object = std::move(*part);
  settings_.view.right_margin = scene_.barShown() ? kBarShare : 0.0;
  setCamera(settings_.view.cameraFor(object), renderer_);
  setTurningPoint(object, renderer_->GetActiveCamera());
  if (parallel && !settings_.view.orthographic) onKey("o");
  framed_ = placeOf(renderer_->GetActiveCamera());
}

/** \brief Whether keys or the mouse have moved the camera since it was put to show the whole object. */
bool
Viewer::isCameraTheUsers() const
{
  return !framed_.empty() && framed_ != placeOf(renderer_->GetActiveCamera());
}

/** \brief Leaves the right margin to a scalar bar, unless the camera is the user's. */
void
Viewer::makeRoomForBar()
{
  const double margin = scene_.barShown() ? kBarShare : 0.0;
  if (margin == settings_.view.right_margin || isCameraTheUsers()) return;
  resetCamera();
}

void
Viewer::onKey(const std::string& symbol)
{
  const Key* key = findKey(symbol);
  if (!key) return;
  message_.clear();
  execute(*key);
  makeRoomForBar();
  updateStatus();
  if (key->command != Command::kQuit) render();
}

void
Viewer::updateBackground()
{
  const GBufferMapper* mapper = scene_.mapper();
  setBackground(renderer_, mapper && mapper->getMode() == DisplayMode::kSketch);
}

void
Viewer::onResized()
{
  const int width = window_->GetSize()[0], height = window_->GetSize()[1];
  overlay_.fitTo(width, height);
  scene_.setBarLetters(static_cast<int>(13 * std::max(0.6, Overlay::letterScale(width, height))));
}

void
Viewer::onTimer()
{
  if (task_) {
    std::string stage;
    const float fraction = task_->progress(stage);
    overlay_.setProgress(fraction, stage);
    if (task_->finished()) takeFit();
    render();
    return;
  }
  auto* style = vtkInteractorStyle::SafeDownCast(interactor_->GetInteractorStyle());
  if (mouse_rests_ || style->GetState() != VTKIS_NONE) return;
  mouse_rests_ = true;
  readUnderMouse();
}

void
Viewer::readUnderMouse()
{
  if (!scene_.mapper() || !scene_.modelShown()) return;
  const int* at = interactor_->GetEventPosition();
  overlay_.setReadout(describeUnder(scene_, renderer_, at[0], at[1]));
  render();
}

void
Viewer::takeFit()
{
  overlay_.setProgress(-1.0f, "");
  fit_error_ = task_->error();
  if (!fit_error_) {
    scene_.setSurface(task_->surface());
    begin();
  } else {
    message_ = fit_error_.message;
    updateStatus();
  }
  task_ = nullptr;
}

void
Viewer::updateStatus()
{
  updateBackground();
  overlay_.raise();
  overlay_.setStatus(describeScene(scene_) + (message_.empty() ? "" : "\n" + message_));
}

}  // namespace pcl_slim
