// SPDX-License-Identifier: BSD-3-Clause
// What the window of pcl_slim_view has beside the scene: keys and mouse, and text over the picture.
#include "view/controls.h"

#include <vtkObjectFactory.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/visualization/display_mode.h"

namespace pcl_slim {
namespace {

std::vector<Key> makeTable() {
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
      {"a", Command::kAutomaticRange, "a", "automatic range, of what is seen now"},
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
      {"space", Command::kPlay, "space, .", "frames of a sensor: pause or go on, the next one"},
      {"period", Command::kNextFrame, ".", ""},
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
    {"rest", "shows the values under the mouse"}};

}  // namespace

const std::vector<Key>& keyTable() {
  static const std::vector<Key> table = makeTable();
  return table;
}

const Key* findKey(const std::string& symbol) {
  for (const Key& key : keyTable()) {
    if (key.symbol == symbol) return &key;
  }
  return nullptr;
}

std::string helpText() {
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

namespace {

constexpr int kLetter = 14;        ///< pixels, in a window that has room for it
constexpr int kSmallest = 6;       ///< that can be read
constexpr double kWidest = 560.0;  ///< pixels that the readout takes

void place(vtkTextActor* actor, double x, double y, int horizontal, int vertical) {
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->GetPositionCoordinate()->SetValue(x, y);
  actor->GetTextProperty()->SetJustification(horizontal);
  actor->GetTextProperty()->SetVerticalJustification(vertical);
}

void setText(vtkTextActor* actor, const std::string& text) {
  actor->SetInput(text.c_str());
  actor->SetVisibility(!text.empty());
}

}  // namespace

Overlay::Overlay(vtkRenderer* renderer)
    : renderer_(renderer),
      status_(addText(renderer, kLetter)),
      readout_(addText(renderer, kLetter)),
      progress_(addText(renderer, 16)),
      help_(addText(renderer, kLetter)) {
  place(status_, 0.012, 0.985, VTK_TEXT_LEFT, VTK_TEXT_TOP);
  place(readout_, 0.012, 0.015, VTK_TEXT_LEFT, VTK_TEXT_BOTTOM);
  place(progress_, 0.5, 0.08, VTK_TEXT_CENTERED, VTK_TEXT_BOTTOM);
  place(help_, 0.0, 0.5, VTK_TEXT_LEFT, VTK_TEXT_CENTERED);
  for (vtkTextActor* text : {status_.Get(), readout_.Get()}) {
    text->GetTextProperty()->SetLineSpacing(1.25);
  }
  help_->GetTextProperty()->SetFontFamilyToCourier();
  help_->GetTextProperty()->SetBackgroundOpacity(0.88);
  help_->GetTextProperty()->SetFrame(true);
  help_->GetTextProperty()->SetFrameColor(0.6, 0.6, 0.62);
  help_->SetInput(helpText().c_str());
}

Overlay::~Overlay() = default;

vtkSmartPointer<vtkTextActor> Overlay::addText(vtkRenderer* renderer, int size) {
  auto actor = vtkSmartPointer<vtkTextActor>::New();
  vtkTextProperty* look = actor->GetTextProperty();
  look->SetFontFamilyToArial();
  look->SetFontSize(size);
  look->SetColor(0.12, 0.13, 0.15);
  look->SetBackgroundColor(1.0, 1.0, 1.0);
  look->SetBackgroundOpacity(0.6);
  actor->SetVisibility(false);
  renderer->AddActor2D(actor);
  return actor;
}

double Overlay::letterScale(int width, int height) {
  constexpr double kHeight = 600.0;  // of a window whose letters are kLetter
  return std::min(std::max(1.0, height / kHeight), width / kWidest);
}

void Overlay::fitTo(int width, int height) {
  const double scale = letterScale(width, height);
  const int letter = std::max(kSmallest, static_cast<int>(kLetter * scale));
  for (vtkTextActor* text : {status_.Get(), readout_.Get()})
    text->GetTextProperty()->SetFontSize(letter);
  progress_->GetTextProperty()->SetFontSize(std::max(kSmallest, static_cast<int>(16 * scale)));
  double box[4]{};
  const auto widthAt = [&](int size) {
    help_->GetTextProperty()->SetFontSize(size);
    help_->GetBoundingBox(renderer_, box);
    return box[1] - box[0];
  };
  int size = std::max(kLetter, letter);
  while (widthAt(size) > 0.96 * width || box[3] - box[2] > 0.9 * height) {
    if (--size < kSmallest) break;
  }
  help_->GetPositionCoordinate()->SetValue(0.5 - 0.5 * (box[1] - box[0]) / width, 0.5);
}

void Overlay::raise() {
  renderer_->RemoveViewProp(help_);
  renderer_->AddViewProp(help_);
}

void Overlay::setStatus(const std::string& text) {
  setText(status_, text);
}

void Overlay::setReadout(const std::string& text) {
  setText(readout_, text);
}

void Overlay::setProgress(float fraction, const std::string& stage) {
  if (fraction < 0.0f) return setText(progress_, "");
  constexpr int kWidth = 30;
  const int filled = std::clamp(static_cast<int>(std::lround(fraction * kWidth)), 0, kWidth);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '|') +
                          std::string(static_cast<std::size_t>(kWidth - filled), '.');
  const int percent = static_cast<int>(std::lround(100.0f * fraction));
  setText(progress_, "Fitting: " + stage + "\n" + bar + "  " + std::to_string(percent) + " %");
}

void Overlay::showHelp(bool shown) {
  help_->SetVisibility(shown);
}

bool Overlay::helpShown() const {
  return help_->GetVisibility() != 0;
}

vtkStandardNewMacro(ViewerStyle)

void ViewerStyle::OnKeyPress() {
  if (on_key) on_key(Interactor->GetKeySym());
}

void ViewerStyle::OnMouseMove() {
  Superclass::OnMouseMove();
  if (on_move) on_move();
}

void ViewerStyle::OnConfigure() {
  Superclass::OnConfigure();
  if (on_resize) on_resize();
}

void ViewerStyle::OnTimer() {
  if (on_timer) on_timer();
}

}  // namespace pcl_slim
