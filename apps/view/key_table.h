// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pcl_slim {

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

const std::vector<Key>&
keyTable();

/** \brief The key of a symbol, or null. */
const Key*
findKey(const std::string& symbol);

/** \brief All keys and the mouse, one a line. */
std::string
helpText();

}  // namespace pcl_slim
