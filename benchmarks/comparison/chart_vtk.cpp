// SPDX-License-Identifier: BSD-3-Clause
#include <sys/wait.h>
#include <unistd.h>
#include <vtkAxis.h>
#include <vtkChartLegend.h>
#include <vtkChartMatrix.h>
#include <vtkChartXY.h>
#include <vtkContextScene.h>
#include <vtkContextView.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPen.h>
#include <vtkPlotPoints.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "comparison/tables.h"

namespace pcl_slim::comparison {

namespace {

constexpr int kPanelWidth = 400, kPanelHeight = 300;

/** A colour and mark in every panel. */
struct Series {
  const char* name;
  Method method;
  int degree;  ///< of MLS; 0: any
  int given;   ///< normals of SLIM; -1: either
  bool automatic;
  unsigned char color[3];
  int mark;
};

const Series kSeries[] = {
    {"MLS order 1", Method::kMls, 1, -1, false, {170, 170, 170}, vtkPlotPoints::SQUARE},
    {"MLS order 2", Method::kMls, 2, -1, false, {230, 120, 20}, vtkPlotPoints::SQUARE},
    {"MLS order 3", Method::kMls, 3, -1, false, {150, 70, 10}, vtkPlotPoints::SQUARE},
    {"SLIM, no normals", Method::kSlim, 0, 0, false, {120, 170, 240}, vtkPlotPoints::CIRCLE},
    {"SLIM, normals", Method::kSlim, 0, 1, false, {120, 210, 150}, vtkPlotPoints::CIRCLE},
    {"default, no normals", Method::kSlim, 0, 0, true, {0, 50, 190}, vtkPlotPoints::DIAMOND},
    {"default, normals", Method::kSlim, 0, 1, true, {0, 110, 40}, vtkPlotPoints::DIAMOND},
};

bool belongs(const Run& run, const Series& series) {
  const Setting& s = run.setting;
  if (s.method != series.method || !(run.errors.position > 0) || !(run.cpu > 0)) return false;
  if (series.degree > 0 && s.degree != series.degree) return false;
  if (series.given >= 0 && s.normals != (series.given == 1)) return false;
  return !series.automatic || s.automatic();
}

void addSeries(const SceneRuns& scene, const Series& series, vtkChart* chart) {
  vtkNew<vtkFloatArray> cost, error;
  cost->SetName("cost");
  error->SetName(series.name);
  for (const Run& run : scene.runs) {
    if (!belongs(run, series)) continue;
    cost->InsertNextValue(static_cast<float>(1e6 * run.cpu / static_cast<double>(scene.points)));
    error->InsertNextValue(static_cast<float>(run.errors.position));
  }
  if (cost->GetNumberOfTuples() == 0) return;
  vtkNew<vtkTable> table;
  table->AddColumn(cost);
  table->AddColumn(error);
  auto* plot = vtkPlotPoints::SafeDownCast(chart->AddPlot(vtkChart::POINTS));
  plot->SetInputData(table, 0, 1);
  plot->SetColor(series.color[0], series.color[1], series.color[2], 255);
  plot->SetMarkerStyle(series.mark);
  plot->SetMarkerSize(series.automatic ? 13.0f : 7.0f);
}

/** From a power of ten to a power of ten around all values of both axes. */
void fitAxis(vtkChart* chart, int which, const char* title, double low, double high) {
  vtkAxis* axis = chart->GetAxis(which);
  axis->SetTitle(title);
  axis->GetTitleProperties()->SetFontSize(11);
  axis->GetTitleProperties()->BoldOff();
  axis->GetLabelProperties()->SetFontSize(10);
  axis->SetNotation(vtkAxis::STANDARD_NOTATION);
  axis->SetUnscaledMinimum(std::pow(10, std::floor(std::log10(low / 1.2))));
  axis->SetUnscaledMaximum(std::pow(10, std::ceil(std::log10(high * 1.2))));
  axis->SetLogScale(true);
  axis->SetBehavior(vtkAxis::FIXED);
}

void drawPanel(const SceneRuns& scene, bool legend, vtkChart* chart) {
  double low[2] = {1e30, 1e30}, high[2] = {0, 0};
  for (const Run& run : scene.runs) {
    const double values[2] = {1e6 * run.cpu / static_cast<double>(scene.points),
                              run.errors.position};
    if (!(values[0] > 0) || !(values[1] > 0)) continue;
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], values[a]);
      high[a] = std::max(high[a], values[a] * 1.001);
    }
  }
  chart->SetTitle(scene.title());
  chart->GetTitleProperties()->SetFontSize(13);
  if (high[0] <= 0) return;
  for (const Series& series : kSeries) addSeries(scene, series, chart);
  fitAxis(chart, vtkAxis::BOTTOM, "CPU microseconds per point", low[0], high[0]);
  fitAxis(chart, vtkAxis::LEFT,
          scene.mean_edges ? "RMS error, mean edges" : "RMS error, scene units", low[1], high[1]);
  chart->SetShowLegend(legend);
  // Nothing is both dear and accurate.
  chart->GetLegend()->SetLabelSize(10);
  chart->GetLegend()->SetHorizontalAlignment(vtkChartLegend::RIGHT);
  chart->GetLegend()->SetVerticalAlignment(vtkChartLegend::BOTTOM);
}

/** As many columns as scenes of the first name have noises; otherwise a square. */
int numColumns(const std::vector<SceneRuns>& scenes) {
  const auto count = static_cast<int>(scenes.size());
  const auto same = static_cast<int>(std::count_if(
      scenes.begin(), scenes.end(), [&](const SceneRuns& s) { return s.name == scenes[0].name; }));
  if (same > 1 && count % same == 0) return same;
  return static_cast<int>(std::ceil(std::sqrt(count)));
}

bool render(const std::vector<SceneRuns>& scenes, const std::string& path) {
  const int columns = numColumns(scenes);
  const int rows = (static_cast<int>(scenes.size()) + columns - 1) / columns;
  vtkNew<vtkContextView> view;
  view->GetRenderer()->SetBackground(1, 1, 1);
  vtkRenderWindow* window = view->GetRenderWindow();
  window->SetOffScreenRendering(1);
  window->SetSize(columns * kPanelWidth, rows * kPanelHeight);
  vtkNew<vtkChartMatrix> matrix;
  view->GetScene()->AddItem(matrix);
  matrix->SetSize(vtkVector2i(columns, rows));
  matrix->SetGutter(vtkVector2f(70.0f, 60.0f));
  matrix->SetBorders(70, 50, 20, 30);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const auto place = static_cast<int>(i);
    // Row 0 of a matrix is the lowest.
    drawPanel(scenes[i], i == 0,
              matrix->GetChart(vtkVector2i(place % columns, rows - 1 - place / columns)));
  }
  window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputConnection(image->GetOutputPort());
  writer->Write();
  return writer->GetErrorCode() == 0;
}

}  // namespace

Error drawChart(const std::vector<SceneRuns>& scenes, const std::string& path) {
  const char* display = std::getenv("DISPLAY");
  if (!display || !*display) {
    return {ErrorCode::kIo,
            "'" + path + "' is not drawn: there is no X server; run under xvfb-run -a"};
  }
  if (scenes.empty()) return {ErrorCode::kBadInput, "nothing was measured; name a scene"};
  // VTK ends the process where the X server does not answer; the tables shall outlive that.
  const pid_t child = fork();
  if (child == 0) _exit(render(scenes, path) ? 0 : 1);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status) ||
      WEXITSTATUS(status) != 0) {
    return {ErrorCode::kIo, "'" + path +
                                "' cannot be drawn: the X server does not answer or the file "
                                "cannot be written; run under xvfb-run -a"};
  }
  return {};
}

}  // namespace pcl_slim::comparison
