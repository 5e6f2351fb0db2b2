// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/picture_lines.h"
#include "render/view_request.h"
#include "view/controls.h"
#include "view/fit_task.h"
#include "view/scene.h"

class vtkRenderWindow;
class vtkRenderWindowInteractor;
class vtkRenderer;

namespace pcl_slim {

/** \brief How a window begins. */
struct ViewerSettings {
  /** \brief Whether surfaces are to be painted with their standard error. */
  bool isUncertainty() const { return mode == "uncertainty"; }

  std::string title, mode = "auto", camera_file = "pcl_slim_camera.txt", backend = "auto",
                     lines = "none", unit;
  double range = 0.0, frame_budget = 50.0, lod = 0.0, line_width = LineStyle().width;
  bool balls = false, points = false, normals = false, help = false, lighting = true;
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
  /** \brief The same while a scan is being fitted; its surface replaces the points when it is
   * there.
   * \return what was wrong with the fit. */
  Error runFit(FitTask& task);
  /** \brief The same for the frames of a sensor, each as soon as it is fitted. \return what was
   * wrong with the first one that could not be shown. */
  Error runFrames(FrameSequence& frames);
  /** \brief Fits all frames and shows the last one. */
  Error showLast(FrameSequence& frames);
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
  void fitRanges();
  void renderFine();
  Error saveFinePicture(const std::string& path);
  void refineAtRest();
  void updateStatus();
  void takeFit();
  void onFrameTimer();
  void showFrame();

  ViewerSettings settings_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  Scene scene_;
  Overlay overlay_;
  CutBox cut_box_;
  FitTask* task_ = nullptr;
  FrameSequence* frames_ = nullptr;
  bool playing_ = true, step_ = false;  ///< frames follow each other; one more is to be shown
  std::string frame_;                   ///< name and number of the frame that is shown
  Error fit_error_;
  std::string message_;         ///< shown once in the status line
  std::vector<double> framed_;  ///< the camera of resetCamera(); another one is the user's
  bool ranges_fitted_ = false;  ///< to what the camera saw when numbers were first shown
  int ticks_at_rest_ = 0;       ///< of the timer, since rays were last intersected
  std::uint64_t frames_at_tick_ = 0;
  bool mouse_rests_ = true;  ///< the mouse has not moved since the last readout
};

/** \brief Saves a window that has been drawn as a PNG file. */
Error savePicture(vtkRenderWindow* window, const std::string& path);

/** \brief Gives a renderer's camera the place and opening of another. */
void setCamera(const Camera& camera, vtkRenderer* renderer);

}  // namespace pcl_slim
