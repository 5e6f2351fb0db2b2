// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_compare: signed deviations of a scan, a surface or a mesh from another one, with the level
// above which they are more than noise.
#include <string>
#include <vector>

#include "common/file_program.h"
#include "common/options.h"
#include "common/program.h"
#include "common/programs.h"
#include "common/standard_output.h"
#include "compare/compared_input.h"
#include "compare/drawing.h"
#include "compare/measurement.h"
#include "compare/point_output.h"
#include "compare/section.h"
#include "compare/tables.h"
#include "pcl_slim/core/file_access.h"
#include "scan/fit_job.h"
#include "scan/scan_files.h"
#include "scan/small_components.h"

namespace {

using namespace pcl_slim;

struct Settings {
  ScanFiles files;  ///< input is A
  std::string reference;
  std::string matrix, csv, histogram;  ///< files, or none
  std::string at = "auto", faces = "both";
  bool smooth = true;
  std::vector<double> tolerance;
  FitJob fit;
  ComparisonJob job;
  DeviationSummaryParams summary;
  DrawingRequest drawing;
  SectionRequest section;
};

void declareComparison(OptionTable& options, Settings& s) {
  options.choice(
      "at", &s.at, {"auto", "surface", "points", "reference"},
      "where to measure: evenly over A, at A's points or vertices, or evenly over B; auto: "
      "over A, with -smooth 0 at its points");
  options.toggle("smooth", &s.smooth,
                 "move a cloud's points onto its surface first; 0: as measured, with the noise as "
                 "their error");
  options.choice(
      "faces", &s.faces, {"both", "a", "b", "none"},
      "which of the two is its exact triangles, if it has faces; else a surface is fitted "
      "to the vertices");
  options.number("registration_error", &s.job.deviation.registration_error, 0, 1e300,
                 "standard error of the alignment of A and B, which raises the level of detection");
  options.number("max_distance", &s.job.deviation.feet.max_distance, 0, 1e300,
                 "no counterpart beyond this distance; 0: no limit");
  options.toggle("align", &s.job.align, "move A by the motion that remains between both");
  options.text("matrix", &s.matrix, "FILE", "write that motion, a matrix of 4 rows",
               FileUse::kWritten);
  options.numbers("tolerance", &s.tolerance, "LOW,HIGH",
                  "deviations allowed; a component beyond them, and not within its level of "
                  "detection of them, ends the program with status 3");
  options.number("edge", &s.job.carrier.longest_edge, 0, 1e300,
                 "largest distance of neighbouring places; 0: twice the spacing of the points");
  options.integer("places", &s.job.carrier.most_places, 3, 1000000000,
                  "about how many places at most");
  options.text("csv", &s.csv, "FILE.csv", "write the table, a line a component", FileUse::kWritten);
  options.text("histogram", &s.histogram, "FILE.csv", "write the area in each bin of deviations",
               FileUse::kWritten);
  options.integer("bins", &s.summary.bins, 2, 65536, "of the histogram");
}

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_compare");
  options.input("A", &s.files.input,
                "a scan, a surface (.slim .pcd .ply .vtp) or a mesh (.stl .obj .ply .off .vtp)");
  options.input("B", &s.reference, "the reference: likewise");
  options.optionalOutput("OUT.pcd|.ply|.las|.vtp", &s.files.output,
                         "A with deviation level_of_detection significant sigma_position", ".pcd");
  declareComparison(options, s);
  s.drawing.declare(options);
  s.section.declare(options);
  declareFitOptions(options, s.fit);
  declareTrimOptions(options, s.fit);
  declareComponentOption(options, s.job.carrier.min_component_points);
  declareReport(options, s.files, false);
  options.endsWith(kExitBeyondLimits, "The work is done, and a component is beyond -tolerance.");
  return options;
}

/** Completes the settings and checks what can be checked before the inputs are read. */
Error finishSettings(Settings& s) {
  const auto bad = [](const std::string& why) { return Error{ErrorCode::kBadArgument, why}; };
  if (Error error = finishFitOptions(s.fit)) return error;
  if (!s.fit.frames.empty() || !s.fit.trajectory.empty())
    return bad(
        "-frames and -trajectory are of one scan: fit it by pcl_slim_fit and name the surface");
  if (!s.smooth && (s.at == "surface" || s.at == "reference"))
    return bad("-smooth 0 compares the points as measured: leave -at out, or give -at points");
  s.job.at = s.at == "reference"             ? MeasuredAt::kReference
             : s.at == "points" || !s.smooth ? MeasuredAt::kPoints
                                             : MeasuredAt::kSurface;
  s.job.points = s.smooth ? ScanPlaces::kMoved : ScanPlaces::kMeasured;
  s.job.deviation.feet.threads = s.job.carrier.threads = s.fit.params.threads;
  if (!s.tolerance.empty()) {
    s.summary.has_tolerance = true;
    s.summary.tolerance_low = s.tolerance[0];
    s.summary.tolerance_high = s.tolerance[1];
  }
  for (const Error& error : {s.job.deviation.validate(), s.job.carrier.validate(),
                             s.summary.validate(), s.drawing.parse(), s.section.parse()}) {
    if (error) return error;
  }
  if (!s.files.output.empty()) {
    if (Error error = checkPointExtension(s.files.output, true)) return error;
  }
  return checkPlaces({s.files.input, s.reference},
                     {s.files.output, s.files.json, s.matrix, s.csv, s.histogram, s.drawing.picture,
                      s.drawing.page, s.section.file});
}

/** Loads both and fits surfaces to clouds. \return whether that is because of the input */
Exit prepareBoth(const Settings& s, Console& console, Report& report, ComparedInput& a,
                 ComparedInput& b, const OptionTable& options) {
  Report of_a(options, s.files.input, s.fit.params.threads);
  Report of_b(options, s.reference, s.fit.params.threads);
  const bool a_is_mesh = s.faces == "both" || s.faces == "a";
  const bool b_is_mesh = s.faces == "both" || s.faces == "b";
  if (Error error = loadCompared(s.files.input, a_is_mesh, s.fit, console, of_a, a))
    return Exit::usage(error);
  if (Error error = loadCompared(s.reference, b_is_mesh, s.fit, console, of_b, b))
    return Exit::usage(error);
  if (Error error = fitCompared(s.fit, console, of_a, a)) return error;
  if (Error error = fitCompared(s.fit, console, of_b, b)) return error;
  report.addPart("a", of_a);
  report.addPart("b", of_b);
  return {};
}

std::string matrixText(const RigidMotion& motion) {
  const std::array<double, 16> m = motion.matrix();
  std::string text;
  for (std::size_t i = 0; i < m.size(); ++i)
    text += numberText(m[i], 17) + (i % 4 == 3 ? "\n" : " ");
  return text;
}

Error writeText(const std::string& path, const std::string& text) {
  return path.empty() ? Error{} : writeFile(path, text.data(), text.size());
}

/** A's points with their deviations, where they are wanted. */
Error writePoints(const Settings& s, Comparison& comparison, const ComparedInput& a,
                  Console& console) {
  if (s.files.output.empty()) return {};
  console.begin("Saving " + shownName(s.files.output));
  const Result<Deviations> deviations = comparison.atPoints(console);
  if (!deviations) return console.failed(deviations.error());
  const PointFile file = withDeviations(a, comparison, *deviations, s.job.align);
  if (Error error = savePointFile(s.files.output, file)) return console.failed(error);
  console.done(counted(numPoints(file.cloud), "point"));
  noteWhatIsNotKept(s.files.output, file.cloud.height > 1, file.hasSensorPose(), console);
  return {};
}

/** All files of a comparison, which appear together. */
Error writeAll(const Settings& s, Comparison& comparison, const DeviationSummary& summary,
               const ComparedInput& a, const ComparedInput& b, Console& console, Report& report) {
  FileTransaction files;
  if (Error error = writePoints(s, comparison, a, console)) return error;
  if (Error error = writeText(s.matrix, matrixText(comparison.registration().motion))) return error;
  if (Error error = writeText(s.csv, summaryCsv(summary))) return error;
  if (Error error = writeText(s.histogram, histogramCsv(summary))) return error;
  if (Error error =
          writeSection(s.section, comparison, s.job, s.drawing.unit, a, b, console, report))
    return error;
  if (s.drawing.any()) {
    DeviationDrawing drawing(s.drawing, comparison, summary.total.detection, s.fit.params.threads);
    if (Error error = drawing.prepare(console, report)) return error;
    if (Error error = drawing.drawPicture(console, report)) return error;
    if (Error error = drawing.writePage(a.name() + " from " + b.name(), console, report))
      return error;
  }
  if (console.interrupted()) return stopped();
  if (!s.files.output.empty())
    report.set("output", isStandardOutput(s.files.output) ? "-" : s.files.output);
  if (Error error = report.write(s.files.json)) return error;
  return commitOutputs(files);
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.files.quiet);
  Report report(options, s.files.input, s.fit.params.threads);
  report.set("reference", s.reference);

  ComparedInput a, b;
  const Exit prepared = prepareBoth(s, console, report, a, b, options);
  if (prepared.status != kExitDone) return prepared;

  Comparison comparison(s.job, a, b);
  if (Error error = comparison.run(console, report)) return error;
  const Result<DeviationSummary> summary =
      summarizeDeviations(comparison.deviations(), comparison.shares(), s.summary);
  if (!summary) return summary.error();
  const double registration_error = s.job.deviation.registration_error;
  printSummary(comparison, *summary, s.summary, registration_error, console);
  reportSummary(comparison, *summary, s.summary, registration_error, report);

  if (Error error = writeAll(s, comparison, *summary, a, b, console, report)) {
    return error.code == ErrorCode::kBadArgument ? Exit::usage(error) : Exit(error);
  }
  if (summary->passes) return {};
  return {kExitBeyondLimits,
          "'" + s.files.input + "' is not within its tolerance: " + verdictText(*summary)};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(
      options, argc, argv,
      {"use smaller scans", [&] { return finishSettings(s); }, [&] { return run(options, s); }});
}
