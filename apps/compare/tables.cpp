// SPDX-License-Identifier: BSD-3-Clause
#include "compare/tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace pcl_slim {
namespace {

/** Significant digits of what is printed and of what files keep. */
constexpr int kShort = 3, kLong = 9;

/** "12.3 %" of a whole; "0 %" where it is 0. */
std::string percentText(double part, double whole) {
  if (!(whole > 0.0) || !(part > 0.0)) return "0 %";
  return numberText(100.0 * part / whole, kShort) + " %";
}

std::string signedText(double value) {
  return (value > 0.0 ? "+" : "") + numberText(value, kShort);
}

ReportValue shareOf(const PlaceShare& share) {
  return {{"places", share.places}, {"area", share.area}};
}

ReportValue::Object figuresOf(const DeviationFigures& f) {
  return {{"all", shareOf(f.all)},
          {"measured", shareOf(f.measured)},
          {"no_counterpart", shareOf(f.no_counterpart)},
          {"significant_up", shareOf(f.significant_up)},
          {"significant_down", shareOf(f.significant_down)},
          {"mean", f.mean},
          {"rms", f.rms},
          {"standard_deviation", f.deviation},
          {"absolute_95", f.absolute_95},
          {"least", f.least},
          {"greatest", f.greatest},
          {"quantiles", std::vector<double>(f.quantiles.begin(), f.quantiles.end())},
          {"level_of_detection", f.detection},
          {"volume_up", f.volume_up},
          {"volume_down", f.volume_down},
          {"significant_volume_up", f.significant_volume_up},
          {"significant_volume_down", f.significant_volume_down}};
}

ReportValue::Object verdictOf(const ComponentVerdict& c) {
  ReportValue::Object fields = figuresOf(c.figures);
  fields.push_back({"above", shareOf(c.above)});
  fields.push_back({"below", shareOf(c.below)});
  fields.push_back({"in_doubt", shareOf(c.in_doubt)});
  fields.push_back({"passes", c.passes});
  return fields;
}

const char* wordOf(MeasuredAt at) {
  switch (at) {
    case MeasuredAt::kPoints: return "points";
    case MeasuredAt::kReference: return "reference";
    default: return "surface";
  }
}

/** Why places have no counterpart: "30 beyond a border, 4 too far". */
std::string reasonsText(const std::vector<std::uint64_t>& states) {
  static constexpr std::pair<FootState, const char*> kReasons[] = {
      {FootState::kBorder, "beyond a border"},
      {FootState::kTooFar, "too far"},
      {FootState::kFacesAway, "facing away"},
      {FootState::kHidden, "behind a wall"},
      {FootState::kNotFinite, "not finite"}};
  std::string text;
  for (const auto& [state, words] : kReasons) {
    const std::uint64_t count = states[static_cast<std::size_t>(state)];
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + words;
  }
  return text;
}

}  // namespace

void printSummary(const Comparison& comparison, const DeviationSummary& summary,
                  const DeviationSummaryParams& params, double registration_error,
                  Console& console) {
  const DeviationFigures& f = summary.total;
  const auto share = [&](const PlaceShare& part) { return percentText(part.area, f.all.area); };
  const std::string registration =
      registration_error > 0.0 ? "with a registration error of " + numberText(registration_error)
                               : "without a registration error; -registration_error X adds one";
  if (f.measured.places > 0) {
    console.note("  level of detection: " + numberText(f.detection, kShort) + " (95 %, median), " +
                 registration);
    console.note("  deviation: mean " + signedText(f.mean) + ", RMS " + numberText(f.rms, kShort) +
                 ", 95 % within " + numberText(f.absolute_95, kShort) + ", from " +
                 signedText(f.least) + " to " + signedText(f.greatest));
    console.note("  significant: above the reference " + share(f.significant_up) +
                 " of the area, below it " + share(f.significant_down));
    console.note("  volume between: above " + numberText(f.volume_up, kShort) + ", below " +
                 numberText(f.volume_down, kShort) + "; of what is significant " +
                 numberText(f.significant_volume_up, kShort) + " and " +
                 numberText(f.significant_volume_down, kShort));
  }
  if (f.no_counterpart.places > 0) {
    console.note("  no counterpart: " + share(f.no_counterpart) + " of the area, " +
                 reasonsText(comparison.states()));
  }
  if (!params.has_tolerance) return;
  console.note("  tolerance " + numberText(params.tolerance_low) + " to " +
               numberText(params.tolerance_high) + ": " +
               (summary.passes ? "all components are within it" : verdictText(summary)));
}

void reportSummary(const Comparison& comparison, const DeviationSummary& summary,
                   const DeviationSummaryParams& params, double registration_error,
                   Report& report) {
  const std::vector<std::uint64_t> states = comparison.states();
  const auto count = [&](FootState state) { return states[static_cast<std::size_t>(state)]; };
  ReportValue::Object fields = figuresOf(summary.total);
  fields.insert(fields.begin(), {"at", wordOf(comparison.measuredAt())});
  fields.push_back({"registration_error", registration_error});
  fields.push_back({"reasons",
                    {{"border", count(FootState::kBorder)},
                     {"too_far", count(FootState::kTooFar)},
                     {"faces_away", count(FootState::kFacesAway)},
                     {"hidden", count(FootState::kHidden)},
                     {"not_finite", count(FootState::kNotFinite)}}});
  fields.push_back({"histogram",
                    {{"low", summary.histogram_low},
                     {"high", summary.histogram_high},
                     {"area", summary.histogram},
                     {"significant", summary.histogram_significant}}});
  if (params.has_tolerance) {
    fields.push_back({"tolerance",
                      {{"low", params.tolerance_low},
                       {"high", params.tolerance_high},
                       {"passes", summary.passes}}});
  }
  ReportValue::List components;
  for (const ComponentVerdict& component : summary.components)
    components.emplace_back(verdictOf(component));
  fields.push_back({"components", components});
  report.set("deviation", fields);
  report.set("points", comparison.places().size());
}

namespace {

std::string number(double value) {
  return std::isfinite(value) ? numberText(value, kLong) : "";
}

std::string csvLine(const std::string& name, const DeviationFigures& f, const ComponentVerdict* v) {
  std::string line = name;
  for (const double value :
       {static_cast<double>(f.all.places), f.all.area, f.measured.area, f.no_counterpart.area,
        f.mean, f.rms, f.deviation, f.absolute_95, f.least, f.greatest, f.detection,
        f.significant_up.area, f.significant_down.area, f.volume_up, f.volume_down,
        f.significant_volume_up, f.significant_volume_down}) {
    line += "," + number(value);
  }
  if (v == nullptr) return line + ",,,,\n";
  return line + "," + number(v->above.area) + "," + number(v->below.area) + "," +
         number(v->in_doubt.area) + "," + (v->passes ? "1" : "0") + "\n";
}

}  // namespace

std::string summaryCsv(const DeviationSummary& summary) {
  std::string text =
      "component,places,area,measured_area,no_counterpart_area,mean,rms,standard_deviation,"
      "absolute_95,least,greatest,level_of_detection,significant_up_area,significant_down_area,"
      "volume_up,volume_down,significant_volume_up,significant_volume_down,above_area,below_area,"
      "in_doubt_area,passes\n";
  text += csvLine("all", summary.total, nullptr);
  for (std::size_t c = 0; c < summary.components.size(); ++c) {
    const ComponentVerdict& component = summary.components[c];
    text += csvLine(std::to_string(c + 1), component.figures, &component);
  }
  return text;
}

std::string histogramCsv(const DeviationSummary& summary) {
  std::string text = "from,to,area,significant_area\n";
  const double bins = static_cast<double>(summary.histogram.size());
  const double width = (summary.histogram_high - summary.histogram_low) / bins;
  for (std::size_t i = 0; i < summary.histogram.size(); ++i) {
    const double from = summary.histogram_low + static_cast<double>(i) * width;
    text += number(from) + "," + number(from + width) + "," + number(summary.histogram[i]) + "," +
            number(summary.histogram_significant[i]) + "\n";
  }
  return text;
}

std::string verdictText(const DeviationSummary& summary) {
  constexpr std::size_t kMostNamed = 3;
  std::size_t failed = 0;
  std::string named;
  for (std::size_t c = 0; c < summary.components.size(); ++c) {
    const ComponentVerdict& component = summary.components[c];
    if (component.passes) continue;
    if (++failed > kMostNamed) continue;
    const double area = component.figures.all.area;
    named += (named.empty() ? "" : "; ") + ("component " + std::to_string(c + 1)) + ": " +
             percentText(component.above.area, area) + " of its area above, " +
             percentText(component.below.area, area) + " below";
  }
  return std::to_string(failed) + " of " + counted(summary.components.size(), "component") +
         " beyond it (" + named + (failed > kMostNamed ? "; ..." : "") + ")";
}

}  // namespace pcl_slim
