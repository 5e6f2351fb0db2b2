// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/picture_lines.h"
#include "render/view_request.h"
#include "scan/fit_job.h"
#include "view/controls.h"
#include "view/scene.h"

class vtkRenderWindow;
class vtkRenderWindowInteractor;
class vtkRenderer;

namespace pcl_slim {

/** \brief A fit in a thread of its own, apart from the window's. The scan must outlive it. */
class FitTask {
 public:
  /** \param[in] min_component points; what is connected to fewer is not shown \param[in]
   * uncertainty paints the surface with its standard error */
  FitTask(const FitJob& job, double min_component, const CloudFile& cloud, bool uncertainty);
  /** \brief Stops the fit and waits for it. */
  ~FitTask();
  FitTask(const FitTask&) = delete;
  FitTask& operator=(const FitTask&) = delete;

  bool finished() const { return finished_.load(); }
  /** \brief Share done; \param[out] stage what runs now. */
  float progress(std::string& stage) const;

  /** \brief Once finished: what was wrong, or nothing. */
  const Error& error() const { return error_; }
  std::shared_ptr<const SLIMSurface> surface() const { return surface_; }

 private:
  void run();

  FitJob job_;
  double min_component_;
  bool uncertainty_;
  const CloudFile& cloud_;
  std::shared_ptr<SLIMSurface> surface_ = std::make_shared<SLIMSurface>();
  Error error_;
  std::atomic<bool> finished_{false};
  mutable std::mutex mutex_;  ///< of fraction and stage
  float fraction_ = 0.0f;
  std::string stage_ = "preparing";
  Progress progress_;
  std::thread thread_;  ///< last: all else is there when it starts
};

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
