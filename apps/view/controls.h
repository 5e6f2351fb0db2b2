// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkSmartPointer.h>

#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

class vtkRenderer;
class vtkTextActor;

namespace pcl_slim {

/** \brief Text over a window's picture: a status line, a readout at the mouse, help, a colour bar.
 */
class Overlay {
 public:
  explicit Overlay(vtkRenderer* renderer);
  ~Overlay();

  /** \brief Makes text small enough for a window, and large enough to be read in a large one. */
  void fitTo(int width, int height);
  /** \brief Size of letters over that in a window of 800 x 600: as the height beyond that, less
   * where the width has no room. */
  static double letterScale(int width, int height);
  /** \brief Draws the help over what has been added since, such as a scalar bar. */
  void raise();
  /** \brief The upper left corner: what is shown. */
  void setStatus(const std::string& text);
  /** \brief The lower left corner: the readout at the mouse; empty: none. */
  void setReadout(const std::string& text);
  /** \brief A stage and its share done in the lower middle; below 0: nothing. */
  void setProgress(float fraction, const std::string& stage);
  void showHelp(bool shown);
  bool helpShown() const;

 private:
  vtkSmartPointer<vtkTextActor> addText(vtkRenderer* renderer, int size);

  vtkRenderer* renderer_;
  vtkSmartPointer<vtkTextActor> status_, readout_, progress_, help_;
};

/** \brief What a key makes the window do. */
enum class Command : unsigned char {
  kMode,  ///< of the digit pressed
  kNextMode,
  kPreviousMode,
  kWiderRange,
  kNarrowerRange,
  kAutomaticRange,
  kModel,
  kPoints,
  kBalls,
  kNormals,
  kDetail,
  kLevelOfDetail,
  kTrim,
  kCutBox,
  kLines,
  kBackend,
  kSides,
  kParallel,
  kReset,
  kPlay,
  kNextFrame,
  kFocus,
  kSaveCamera,
  kLoadCamera,
  kScreenshot,
  kHelp,
  kQuit,
};

/** \brief One key, as X calls it, and what it does. */
struct Key {
  std::string symbol;  ///< vtkRenderWindowInteractor::GetKeySym()
  Command command;
  std::string shown, meaning;  ///< as the help shows them; no meaning: see a key above
  int mode = 0;                ///< of kMode: the DisplayMode
};

const std::vector<Key>& keyTable();

/** \brief The key of a symbol, or null. */
const Key* findKey(const std::string& symbol);

/** \brief All keys and the mouse, one a line. */
std::string helpText();

/** \brief VTK's trackball, which reports keys, moves, sizes and time instead of what VTK does
 * with them. */
class ViewerStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static ViewerStyle* New();
  vtkTypeMacro(ViewerStyle, vtkInteractorStyleTrackballCamera)

  std::function<void(const std::string& symbol)> on_key;
  std::function<void()> on_move, on_resize, on_timer;

  void OnChar() override {}
  void OnKeyPress() override;
  void OnMouseMove() override;
  void OnConfigure() override;
  /** \brief Nothing but on_timer(): VTK's own would turn the camera on, by the last move of the
   * mouse, at every tick while a button is down. */
  void OnTimer() override;
};

/** \brief Whether a window can be opened here. VTK ends the program where it cannot, so this tries
 * the X server first. */
Error checkDisplay();

}  // namespace pcl_slim
