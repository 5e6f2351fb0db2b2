// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <string>

class vtkRenderer;
class vtkTextActor;

namespace pcl_slim {

/** \brief Text over a window's picture: a status line, a readout at the mouse, help, a colour bar. */
class Overlay {
 public:
  explicit Overlay(vtkRenderer* renderer);
  ~Overlay();

  /** \brief Makes text small enough for a window, and large enough to be read in a large one. */
  void fitTo(int width, int height);
  /** \brief Size of letters over that in a window of 800 x 600: as the height beyond that, less where the
   * width has no room. */
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

}  // namespace pcl_slim
