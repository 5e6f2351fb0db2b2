// SPDX-License-Identifier: BSD-3-Clause
#include "view/key_table.h"

#include "pcl_slim/visualization/display_mode.h"

namespace pcl_slim {
namespace {

std::vector<Key>
makeTable()
{
  std::vector<Key> keys;
  const std::vector<std::string> modes = displayModeNames();
  // The digits 1 to 9 and 0 choose ten modes; the help lists five of them a line.
  for (std::size_t i = 0; i < 10; ++i) {
    Key key{std::to_string((i + 1) % 10), Command::kMode, "", "", static_cast<int>(i)};
    if (i % 5 == 0) {
      key.shown = i == 0 ? "1 - 5" : "6 - 0";
      key.meaning = "colours:";
      for (std::size_t j = i; j < i + 5; ++j) key.meaning += " " + modes[j];
      // What splats have on the last digit, surfaces do not, and the other way round.
      if (i == 5) key.meaning += " or error";
    }
    keys.push_back(key);
  }
  const std::vector<Key> others{
      {"m", Command::kNextMode, "m, M", "next, previous colours"},
      {"M", Command::kPreviousMode, "M", ""},
      {"bracketright", Command::kWiderRange, "]  [",
       "wider, narrower range of curvatures or errors"},
      {"bracketleft", Command::kNarrowerRange, "[", ""},
      {"a", Command::kAutomaticRange, "a", "automatic range"},
      {"s", Command::kModel, "s", "surface or splats on, off"},
      {"p", Command::kPoints, "p", "points of the scan on, off"},
      {"b", Command::kBalls, "b", "balls of the leaves by size on, off"},
      {"n", Command::kNormals, "n", "normals on, off"},
      {"d", Command::kDetail, "d", "detail while the mouse moves: 50 ms, 20 ms, full"},
      {"v", Command::kLevelOfDetail, "v",
       "level of detail: every leaf, surfels of 1, 2, 4 ... 32 pixels"},
      {"t", Command::kTrim, "t", "borders: where the data end, or all of every ball"},
      {"k", Command::kCutBox, "k", "cut: a box whose sides the mouse drags on, off"},
      {"l", Command::kLines, "l", "lines: crest, suggestive contours, contours, all, none"},
      {"g", Command::kBackend, "g",
       "rays by: graphics card or CPU, whichever is faster; CPU; card"},
      {"e", Command::kSides, "e", "sides: automatic, front, both"},
      {"o", Command::kParallel, "o", "parallel or perspective projection"},
      {"r", Command::kReset, "r", "the whole object"},
      {"f", Command::kFocus, "f", "turn about the point under the mouse"},
      {"c", Command::kSaveCamera, "c, C", "save, load the camera"},
      {"C", Command::kLoadCamera, "C", ""},
      {"x", Command::kScreenshot, "x", "save a picture"},
      {"h", Command::kHelp, "h", "this help"},
      {"F1", Command::kHelp, "F1", ""},
      {"q", Command::kQuit, "q", "quit"},
      {"Escape", Command::kQuit, "Escape", ""}};
  keys.insert(keys.end(), others.begin(), others.end());
  return keys;
}

const std::vector<std::pair<std::string, std::string>> kMouse{
    {"left", "turn (with Shift: move, with Ctrl: spin)"},
    {"middle", "move"},
    {"right, wheel", "nearer, farther"},
    {"rest", "tells what lies under the mouse"}};

}  // namespace

const std::vector<Key>&
keyTable()
{
  static const std::vector<Key> table = makeTable();
  return table;
}

const Key*
findKey(const std::string& symbol)
{
  for (const Key& key : keyTable()) {
    if (key.symbol == symbol) return &key;
  }
  return nullptr;
}

std::string
helpText()
{
  const auto row = [](const std::string& name, const std::string& meaning) {
    return " " + name + std::string(name.size() < 13 ? 13 - name.size() : 1, ' ') + meaning + " \n";
  };
  std::string text;
  for (const Key& key : keyTable()) {
    if (!key.meaning.empty()) text += row(key.shown, key.meaning);
  }
  for (const auto& [button, meaning] : kMouse) text += row(button, meaning);
  return text.substr(0, text.size() - 1);
}

}  // namespace pcl_slim
