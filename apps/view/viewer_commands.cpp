// SPDX-License-Identifier: BSD-3-Clause
// What the keys of the window do.
#include <vtkCamera.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "pcl_slim/visualization/slim_mapper.h"
#include "render/camera_file.h"
#include "view/viewer.h"

namespace pcl_slim {
namespace {

const std::vector<std::string> kLineKinds{"none", "crest", "suggestive", "contour", "all"};

/** pcl_slim_view_001.png, or the first number that no file has. */
std::string freePictureName() {
  for (int number = 1;; ++number) {
    char name[40];
    std::snprintf(name, sizeof(name), "pcl_slim_view_%03d.png", number);
    std::error_code code;
    if (!std::filesystem::exists(name, code)) return name;
  }
}

/** Changes between parallel and perspective projection; what is at the camera's target keeps its
 * size. */
void toggleParallel(vtkCamera* camera) {
  constexpr double kDegrees = 180.0 / M_PI;
  const bool parallel = camera->GetParallelProjection() != 0;
  const double half = std::tan(0.5 * camera->GetViewAngle() / kDegrees);
  if (parallel) {
    // The pinhole steps to where it sees as much at the target.
    const double factor = camera->GetDistance() * half / camera->GetParallelScale();
    camera->Dolly(factor);
  } else {
    camera->SetParallelScale(camera->GetDistance() * half);
  }
  camera->SetParallelProjection(!parallel);
}

/** A renderer's camera, but for the picture's size. */
Camera cameraOf(vtkRenderer* renderer) {
  vtkCamera* from = renderer->GetActiveCamera();
  Camera camera;
  from->GetPosition(camera.position.data());
  from->GetFocalPoint(camera.look_at.data());
  from->GetViewUp(camera.up.data());
  camera.fov = from->GetViewAngle();
  if (from->GetParallelProjection()) {
    camera.projection = Camera::Projection::kOrthographic;
    camera.view_height = 2.0 * from->GetParallelScale();
  }
  return camera;
}

}  // namespace

void Viewer::execute(const Key& key) {
  switch (key.command) {
    case Command::kMode: return setDigitMode(key.mode);
    case Command::kNextMode: return scene_.stepMode(1);
    case Command::kPreviousMode: return scene_.stepMode(-1);
    case Command::kWiderRange: return scene_.scaleRange(1.25);
    case Command::kNarrowerRange: return scene_.scaleRange(0.8);
    case Command::kAutomaticRange: return scene_.scaleRange(0.0);
    case Command::kDetail: return stepDetail();
    case Command::kLevelOfDetail: return stepLevelOfDetail();
    case Command::kTrim: return toggleTrimming();
    case Command::kCutBox: return toggleCutBox();
    case Command::kLines: return stepLines();
    case Command::kBackend: return stepBackend();
    case Command::kSides: return stepSides();
    case Command::kReset: return resetCamera();
    case Command::kPlay: playing_ = !playing_; return;
    case Command::kNextFrame: step_ = true; return;
    case Command::kFocus: return focusUnderMouse();
    case Command::kScreenshot: return screenshotByKey();
    case Command::kHelp: return overlay_.showHelp(!overlay_.helpShown());
    case Command::kQuit: return interactor_->TerminateApp();
    default: return toggle(key.command);
  }
}

void Viewer::setDigitMode(int digit) {
  auto mode = static_cast<DisplayMode>(digit);
  if (scene_.setMode(mode, 0.0)) return;
  if (mode == DisplayMode::kColor) mode = DisplayMode::kError;
  if (!scene_.setMode(mode, 0.0)) message_ = "nothing here has " + nameOf(mode) + " colours";
}

void Viewer::toggle(Command command) {
  const auto told = [this](const Error& error, const std::string& done) {
    message_ = error ? error.message : done + settings_.camera_file;
  };
  switch (command) {
    case Command::kModel: return scene_.showModel(!scene_.modelShown());
    case Command::kPoints: return scene_.showPoints(!scene_.pointsShown());
    case Command::kBalls: return scene_.showBalls(!scene_.ballsShown());
    case Command::kNormals: return scene_.showNormals(!scene_.normalsShown());
    case Command::kSaveCamera:
      return told(saveCamera(settings_.camera_file, cameraOf(renderer_)), "camera saved: ");
    case Command::kLoadCamera: return told(loadCameraFile(), "camera loaded: ");
    case Command::kParallel: return toggleParallel(renderer_->GetActiveCamera());
    default: return;
  }
}

Error Viewer::loadCameraFile() {
  const Result<Camera> camera = loadCamera(settings_.camera_file);
  if (!camera) return camera.error();
  setCamera(*camera, renderer_);
  return {};
}

void Viewer::stepDetail() {
  GBufferMapper* mapper = scene_.mapper();
  if (!mapper) return;
  const double budget = mapper->getFrameBudget();
  mapper->setFrameBudget(budget > 20.0 ? 20.0 : budget > 0.0 ? 0.0 : 50.0);
  message_ = mapper->getFrameBudget() > 0.0
                 ? "while the mouse moves, frames of at most " +
                       std::to_string(static_cast<int>(mapper->getFrameBudget())) + " ms"
                 : "full detail while the mouse moves";
}

void Viewer::stepLevelOfDetail() {
  SLIMMapper* mapper = scene_.surfaceMapper();
  if (!mapper) return;
  const double now = mapper->getLevelOfDetail();
  mapper->setLevelOfDetail(now <= 0.0 ? 1.0 : now < 32.0 ? 2.0 * now : 0.0);
  char text[80];
  std::snprintf(text, sizeof(text), "surfels below %g pixels stand for their descendants",
                mapper->getLevelOfDetail());
  message_ = mapper->getLevelOfDetail() > 0.0 ? text : "every leaf is drawn";
}

void Viewer::toggleTrimming() {
  SLIMMapper* mapper = scene_.surfaceMapper();
  if (!mapper) return;
  mapper->setTrimming(!mapper->getTrimming());
  message_ = mapper->getTrimming() ? "the surface ends where its data do" : "all of every ball";
}

void Viewer::toggleCutBox() {
  if (cut_box_.shown()) {
    cut_box_.hide();
    settings_.region = {};
    scene_.cut({});
    message_ = "all is shown";
    return;
  }
  cut_box_.show(interactor_, settings_.region.bounds(scene_.spheres()));
  scene_.cut(cut_box_.sides());
  message_ = "cut: drag the box by its handles";
}

void Viewer::stepLines() {
  const auto at = std::find(kLineKinds.begin(), kLineKinds.end(), settings_.lines);
  const auto next = static_cast<std::size_t>(at - kLineKinds.begin() + 1) % kLineKinds.size();
  setLines(kLineKinds[next]);
  message_ = "lines: " + settings_.lines;
}

void Viewer::setLines(const std::string& kind) {
  SLIMMapper* mapper = scene_.surfaceMapper();
  if (!mapper) return;
  settings_.lines = kind;
  const bool all = kind == "all";
  PictureLineParams params = mapper->getLines();
  params.crest = all || kind == "crest";
  params.suggestive = all || kind == "suggestive";
  params.contour = all || kind == "contour";
  LineStyle style;
  style.width = settings_.line_width;
  if (const Error error = mapper->setLines(params, style)) message_ = error.message;
}

void Viewer::stepBackend() {
  SLIMMapper* mapper = scene_.surfaceMapper();
  if (!mapper) return;
  const char* const names[] = {"rays by whichever is faster", "rays by the CPU",
                               "rays by the graphics card"};
  const int next = (static_cast<int>(mapper->getBackend()) + 1) % 3;
  mapper->setBackend(static_cast<RayBackend>(next));
  message_ = names[next];
}

void Viewer::stepSides() {
  GBufferMapper* mapper = scene_.mapper();
  if (!mapper) return;
  const char* const names[] = {"sides: automatic", "sides: front", "sides: both"};
  const int next = (static_cast<int>(mapper->getSides()) + 1) % 3;
  mapper->setSides(static_cast<VisibleSides>(next));
  message_ = names[next];
}

void Viewer::focusUnderMouse() {
  const int* at = interactor_->GetEventPosition();
  SurfacePick pick;
  SLIMMapper* mapper = scene_.surfaceMapper();
  if (!mapper || !mapper->pick(renderer_, scene_.model(), at[0], at[1], pick)) return;
  renderer_->GetActiveCamera()->SetFocalPoint(pick.position.data());
}

void Viewer::screenshotByKey() {
  const std::string path = freePictureName();
  const Error error = saveFinePicture(path);
  message_ = error ? error.message : "saved " + path;
}

}  // namespace pcl_slim
