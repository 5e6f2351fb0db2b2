// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/projection.h"

namespace pcl_slim::paper {

/** \brief The settings of every study. */
struct StudySettings {
  std::string data;  ///< folder of scans
  std::string out;   ///< folder for tables and pictures
  int threads = 1;
};

/** \brief Points with normals, in units of their own. */
struct Model {
  std::string name;
  std::vector<Vector3> points;
  std::vector<float> normals;  ///< x y z a point; empty: none

  /** \brief A view of the points; valid while this lives. */
  CloudView view() const;
};

/** \brief A scan of the data folder; normals come from the file's faces or fields. */
Result<Model> loadModel(const StudySettings& settings, const std::string& file);

/** \brief Points evenly spread over a palm with five fingers, exact but for rounding: stands for
 * the scan of a hand, which is not public. Unit: the palm's height. */
Model handModel(std::size_t count);

/** \brief Writes points with normals as a binary PLY of floats. */
Error savePoints(const Model& model, const std::string& path);

/** \brief A model fitted and projected onto its own surface, by the guarded formula whatever the
 * fit: as printed, (6) flings single points far away, which then are all that an RMS shows. */
struct Fitted {
  PointStore store;
  SLIMSurface surface;
  FitStatistics statistics;
  Projection projection;
  double seconds = 0;  ///< CPU time of store and fit
};

Result<Fitted> fitModel(const Model& model, const FitParams& params);

/** \brief RMS distance of the points from their projections, as a share of the diagonal. */
double projectionError(const Fitted& fitted);

/** \brief Floats a surfel of a degree takes: centre, radius, and coefficients with the normal where
 * the degree needs one: 7, 12, 16, 21. */
int floatsOf(int degree);

/** \brief Errors of a sweep over a setting, descending, and the leaves that each took. */
struct LeafSweep {
  std::vector<double> error, leaves;

  /** \brief Leaves at an error between two of the sweep's, by a power law; negative: beyond it. */
  double leavesAt(double wanted) const;
};

/** \brief Collects a Markdown table and writes it with a heading; prints it too. */
class Table {
 public:
  Table(std::string title, std::vector<std::string> columns);
  void row(const std::vector<std::string>& cells);
  Error save(const StudySettings& settings, const std::string& name) const;

 private:
  std::string text_;
};

/** \brief A number as text: %.3g and the like. */
std::string number(const char* format, double value);

/** \brief A curve of a plot; one of a single place is a dot, and none without a label has one. */
struct Curve {
  std::string label, color;
  std::vector<double> x, y;
};

/** \brief Plots panels of curves on logarithmic axes, side by side, into an SVG file. */
Error savePlot(const std::string& path, const std::vector<std::string>& titles,
               const std::vector<std::vector<Curve>>& panels, const std::string& x_label,
               const std::string& y_label);

// The studies, each named after what it reproduces.
Error energyCurves(const StudySettings& settings);     ///< Fig. 4
Error radiusIntervals(const StudySettings& settings);  ///< Fig. 5
Error treeOfBalls(const StudySettings& settings);      ///< Fig. 6
Error blendingOnRays(const StudySettings& settings);   ///< Figs. 8 and 9
Error ballsByLevel(const StudySettings& settings);     ///< Fig. 7
Error splatsBeside(const StudySettings& settings);  ///< Fig. 18, below: QSplat on scans with gaps
Error sparsity(const StudySettings& settings);      ///< Fig. 21
Error compactness(const StudySettings& settings);   ///< bytes of a surface beside its points
Error saveHand(
    const StudySettings& settings);  ///< the points of handModel() as hand.ply, for Fig. 22
Error fitTimes(const StudySettings& settings);       ///< Table 1
Error rotationDrift(const StudySettings& settings);  ///< "not invariant", section 3
Error ellipsoidalSupports(
    const StudySettings& settings);                   ///< future work: ellipsoids in place of balls
Error costOfRays(const StudySettings& settings);      ///< cost of a frame, section 4
Error parabolicLines(const StudySettings& settings);  ///< shading where the Gaussian curvature is 0

}  // namespace pcl_slim::paper
