// SPDX-License-Identifier: BSD-3-Clause
#include "view/viewer.h"

#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/render/image.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "pcl_slim/visualization/studio.h"
#include "view/readout.h"

namespace pcl_slim {

namespace {

/** Moves a camera's focal point along its axis to the depth of an object's middle, so that the
 * object turns in its place. O(spheres). */
void setTurningPoint(const BoundingSpheres& object, vtkCamera* camera) {
  std::vector<double> depths;
  const double *eye = camera->GetPosition(), *forward = camera->GetDirectionOfProjection();
  for (const BoundingSphere& sphere : object.spheres) {
    double depth = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = object.origin[k] + object.scale * double{sphere.center[k]};
      depth += (x - eye[k]) * forward[k];
    }
    depths.push_back(depth);
  }
  if (depths.empty()) return;
  // The middle of the bulk: a few strays far away do not count.
  std::sort(depths.begin(), depths.end());
  const std::size_t n = depths.size() - 1;
  const double middle = 0.5 * (depths[n / 50] + depths[n - n / 50]);
  if (middle > 0.0) camera->SetDistance(middle);
}

RayBackend backendOf(const std::string& name) {
  return name == "cpu"      ? RayBackend::kCPU
         : name == "opengl" ? RayBackend::kOpenGL
                            : RayBackend::kAuto;
}

constexpr double kBarShare = 0.14;  ///< of the window's width, left to the scalar bar

/** \brief What the user may change of a camera's place. */
std::vector<double> placeOf(vtkCamera* camera) {
  std::vector<double> place;
  for (const double* values :
       {camera->GetPosition(), camera->GetFocalPoint(), camera->GetViewUp()}) {
    place.insert(place.end(), values, values + 3);
  }
  place.push_back(camera->GetParallelScale());
  return place;
}

}  // namespace

Error savePicture(vtkRenderWindow* window, const std::string& path) {
  Image image;
  image.width = window->GetSize()[0];
  image.height = window->GetSize()[1];
  vtkNew<vtkUnsignedCharArray> pixels;
  window->GetPixelData(0, 0, image.width - 1, image.height - 1, 1, pixels);
  const auto row = static_cast<std::size_t>(3 * image.width);
  image.rgb.resize(row * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    // VTK's rows begin at the bottom.
    const unsigned char* from =
        pixels->GetPointer(0) + static_cast<std::size_t>(image.height - 1 - y) * row;
    std::copy(from, from + row, image.rgb.begin() + static_cast<std::ptrdiff_t>(y * row));
  }
  return savePng(path, image);
}

void setCamera(const Camera& from, vtkRenderer* renderer) {
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(from.position.data());
  camera->SetFocalPoint(from.look_at.data());
  camera->SetViewUp(from.up.data());
  const bool parallel = from.projection == Camera::Projection::kOrthographic;
  camera->SetParallelProjection(parallel);
  if (parallel) {
    camera->SetParallelScale(0.5 * from.view_height);
  } else {
    camera->SetViewAngle(from.fov);
  }
  renderer->ResetCameraClippingRange();
}

Viewer::Viewer(const ViewerSettings& settings, bool on_screen)
    : settings_(settings),
      scene_(renderer_),
      overlay_(renderer_),
      cut_box_([this] { scene_.cut(cut_box_.sides()); }) {
  scene_.setUnit(settings.unit);
  scene_.setLighting(settings.lighting);
  setStudioBackground(renderer_);
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

void Viewer::begin() {
  GBufferMapper* mapper = scene_.mapper();
  if (mapper) {
    mapper->setFrameBudget(settings_.frame_budget);
    mapper->setNumberOfThreads(settings_.threads);
    const std::string automatic = scene_.hasColors() ? "color" : "shaded";
    const bool painted = settings_.mode == "auto" || settings_.isUncertainty();
    const std::string& name = painted ? automatic : settings_.mode;
    if (const auto mode = displayModeOf(name)) scene_.setMode(*mode, settings_.range);
    if (settings_.region.sides.empty() && settings_.view.viewOf(scene_.spheres()).opens)
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
  ranges_fitted_ = false;
  fitRanges();
  updateStatus();
}

void Viewer::run() {
  window_->Render();
  interactor_->Initialize();
  interactor_->CreateRepeatingTimer(100);
  interactor_->Start();
}

Error Viewer::runFit(FitTask& task) {
  task_ = &task;
  run();
  task_ = nullptr;
  return fit_error_;
}

Error Viewer::runFrames(FrameSequence& frames) {
  frames_ = &frames;
  run();
  frames_ = nullptr;
  return fit_error_;
}

Error Viewer::showLast(FrameSequence& frames) {
  for (;;) {
    frames.wait();
    if (Error error = frames.error()) return error;
    if (frames.index() + 1 == frames.size()) break;
    frames.startNext();
  }
  scene_.setSurface(frames.task()->surface());
  begin();
  return {};
}

Error Viewer::saveScreenshot(const std::string& path) {
  // Nobody reads in a picture which keys there are.
  overlay_.setStatus("");
  return saveFinePicture(path);
}

void Viewer::render() {
  renderer_->ResetCameraClippingRange();
  window_->Render();
}

/** \brief Draws as a picture is drawn: several rays a pixel. The frame is kept until something moves.
 */
void Viewer::renderFine() {
  constexpr int kRays = 2;  // along each axis, as in pictures
  GBufferMapper* mapper = scene_.mapper();
  if (mapper) mapper->setSupersampling(kRays);
  render();
  if (mapper) mapper->setSupersampling(1);
}

/** \brief Saves what the window shows, finely drawn. */
Error Viewer::saveFinePicture(const std::string& path) {
  renderFine();
  // The model's own rays smooth its edges, which a filter would only blur.
  const GBufferMapper* mapper = scene_.mapper();
  const bool others = scene_.pointsShown() || scene_.ballsShown() || scene_.normalsShown();
  if (mapper && mapper->getStatistics().supersampling > 1 && !others) {
    renderer_->UseFXAAOff();
    render();
  }
  const Error error = savePicture(window_, path);
  renderer_->UseFXAAOn();
  return error;
}

/** \brief Draws finely once nothing has moved for a while, if that does not keep the user waiting. */
void Viewer::refineAtRest() {
  constexpr int kTicks = 3;          // of 100 ms
  constexpr double kPatience = 0.3;  // seconds, of four rays a pixel
  const GBufferMapper* mapper = scene_.mapper();
  if (!mapper || !scene_.modelShown()) return;
  const FrameStatistics& last = mapper->getStatistics();
  if (last.rasterized != frames_at_tick_) {
    frames_at_tick_ = last.rasterized;
    ticks_at_rest_ = 0;
  }
  if (++ticks_at_rest_ != kTicks || last.supersampling > 1) return;
  if (4.0 * last.rasterize_seconds <= kPatience) renderFine();
}

void Viewer::resetCamera() {
  settings_.view.size = {window_->GetSize()[0], window_->GetSize()[1]};
  const bool parallel = renderer_->GetActiveCamera()->GetParallelProjection() != 0;
  BoundingSpheres object = scene_.spheres();
  if (Result<BoundingSpheres> part = settings_.region.within(object)) object = std::move(*part);
  settings_.view.right_margin = scene_.barShown() ? kBarShare : 0.0;
  setCamera(settings_.view.viewOf(object).camera, renderer_);
  setTurningPoint(object, renderer_->GetActiveCamera());
  if (parallel && !settings_.view.orthographic) onKey("o");
  framed_ = placeOf(renderer_->GetActiveCamera());
}

/** \brief Whether keys or the mouse have moved the camera since it was put to show the whole
 * object. */
bool Viewer::isCameraTheUsers() const {
  return !framed_.empty() && framed_ != placeOf(renderer_->GetActiveCamera());
}

/** \brief Leaves the right margin to a scalar bar, unless the camera is the user's. */
void Viewer::makeRoomForBar() {
  const double margin = scene_.barShown() ? kBarShare : 0.0;
  if (margin == settings_.view.right_margin || isCameraTheUsers()) return;
  resetCamera();
}

/** \brief Gives numbers the colours that a picture of the first view has, where the user gave no
 * range. */
void Viewer::fitRanges() {
  GBufferMapper* mapper = scene_.mapper();
  if (ranges_fitted_ || !mapper || !showsNumbers(mapper->getMode())) return;
  ranges_fitted_ = mapper->fitRanges(renderer_, scene_.model());
}

void Viewer::onKey(const std::string& symbol) {
  const Key* key = findKey(symbol);
  if (!key) return;
  message_.clear();
  execute(*key);
  makeRoomForBar();
  if (key->command == Command::kAutomaticRange) ranges_fitted_ = false;
  fitRanges();
  updateStatus();
  if (key->command != Command::kQuit) render();
}

void Viewer::updateBackground() {
  const GBufferMapper* mapper = scene_.mapper();
  const bool is_paper = mapper && mapper->getMode() == DisplayMode::kSketch;
  if (!is_paper) {
    if (!renderer_->GetTexturedBackground()) setStudioBackground(renderer_);
    return;
  }
  renderer_->TexturedBackgroundOff();
  renderer_->GradientBackgroundOff();
  renderer_->SetBackground(1.0, 1.0, 1.0);
}

void Viewer::onResized() {
  const int width = window_->GetSize()[0], height = window_->GetSize()[1];
  overlay_.fitTo(width, height);
  scene_.setBarLetters(static_cast<int>(13 * std::max(0.6, Overlay::letterScale(width, height))));
}

void Viewer::onTimer() {
  if (frames_) onFrameTimer();
  if (task_) {
    std::string stage;
    const float fraction = task_->progress(stage);
    overlay_.setProgress(fraction, stage);
    if (task_->finished()) takeFit();
    render();
    return;
  }
  auto* style = vtkInteractorStyle::SafeDownCast(interactor_->GetInteractorStyle());
  if (style->GetState() != VTKIS_NONE) return;
  refineAtRest();
  if (mouse_rests_) return;
  mouse_rests_ = true;
  readUnderMouse();
}

/** Shows a frame as soon as it is fitted, unless the sequence is paused. */
void Viewer::onFrameTimer() {
  const FitTask* const task = frames_->task();
  if (task && !task->finished()) {
    if (!frame_.empty()) return;  // the frame before is shown
    std::string stage;
    const float fraction = task->progress(stage);
    overlay_.setProgress(fraction, stage);
    render();
    return;
  }
  if (playing_ || step_) showFrame();
}

void Viewer::showFrame() {
  overlay_.setProgress(-1.0f, "");
  step_ = false;
  message_.clear();
  if (const Error error = frames_->error()) {
    message_ = error.message;
    if (!fit_error_) fit_error_ = error;
  } else {
    const FitJob& job = frames_->job();
    scene_.setPoints(frames_->cloud().view(job.use_normals),
                     job.color ? colorsOf(frames_->cloud()) : ColorView());
    const bool first = scene_.mapper() == nullptr;
    scene_.setSurface(frames_->task()->surface());
    if (first) begin();
  }
  frame_ = "frame " + std::to_string(frames_->index() + 1) + " of " +
           std::to_string(frames_->size()) + ", " + frames_->file();
  if (frames_->index() + 1 == frames_->size()) playing_ = false;
  frames_->startNext();
  updateStatus();
  render();
}

void Viewer::readUnderMouse() {
  if (!scene_.mapper() || !scene_.modelShown()) return;
  const int* at = interactor_->GetEventPosition();
  overlay_.setReadout(describeUnder(scene_, renderer_, at[0], at[1]));
  render();
}

void Viewer::takeFit() {
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

void Viewer::updateStatus() {
  updateBackground();
  overlay_.raise();
  const std::string frame = frame_.empty() ? "" : frame_ + "   ";
  overlay_.setStatus(frame + describeScene(scene_) + (message_.empty() ? "" : "\n" + message_));
}

}  // namespace pcl_slim
