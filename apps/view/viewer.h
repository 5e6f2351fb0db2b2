// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <memory>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/picture_lines.h"
#include "render/region_request.h"
#include "render/view_request.h"
#include "view/fit_task.h"
#include "view/key_table.h"
#include "view/overlay.h"
#include "view/scene/cut_box.h"
#include "view/scene/scene.h"

class vtkRenderWindow;
class vtkRenderWindowInteractor;
class vtkRenderer;

namespace pcl_slim {

/** \brief How a window begins. */
struct ViewerSettings {
  std::string title, mode = "auto", camera_file = "pcl_slim_camera.txt", backend = "auto",
                     lines = "none";
  double range = 0.0, frame_budget = 50.0, lod = 0.0, line_width = LineStyle().width;
  bool balls = false, points = false, normals = false, help = false;
  int threads = 0;
  ViewRequest view;
  RegionRequest region;
};

/** \brief The window of pcl_slim_view: a scene, text over it, keys and the mouse. */
class Viewer {
 public:
  explicit Viewer(const ViewerSettings& settings, bool on_screen);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  Scene& scene() { return scene_; }

  /** \brief Sets the first mode, the requested extras and the camera for the model in the scene. */
  void begin();
  /** \brief Opens the window and returns when it is closed. */
  void run();
  /** \brief The same while a scan is being fitted; its surface replaces the points when it is there.
   * \return what was wrong with the fit. */
  Error runFit(FitTask& task);
  /** \brief Draws the window once and saves it as a PNG file. */
  Error saveScreenshot(const std::string& path);

  // Called by the interactor's style ------------------------------------------------------------
  void onKey(const std::string& symbol);
  void onResized();
  void onTimer();

 private:
  void render();
  void resetCamera();
  bool isCameraTheUsers() const;
  void execute(const Key& key);
  void toggle(Command command);
  Error loadCameraFile();
  void stepDetail();
  void stepLevelOfDetail();
  void toggleTrimming();
  void toggleCutBox();
  void stepLines();
  void setLines(const std::string& kind);
  void updateBackground();
  void setDigitMode(int digit);
  void stepBackend();
  void stepSides();
  void focusUnderMouse();
  void screenshotByKey();
  void readUnderMouse();
  void makeRoomForBar();
  void updateStatus();
  void takeFit();

  ViewerSettings settings_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  Scene scene_;
  Overlay overlay_;
  CutBox cut_box_;
  FitTask* task_ = nullptr;
  Error fit_error_;
  std::string message_;         ///< shown once in the status line
  std::vector<double> framed_;  ///< the camera of resetCamera(); another one is the user's
  bool mouse_rests_ = true;     ///< the mouse has not moved since the last readout
};

}  // namespace pcl_slim
