// SPDX-License-Identifier: BSD-3-Clause
#include "ablation/table.h"

#include <cmath>
#include <cstdio>

namespace pcl_slim::ablation {

namespace {

using Member = double Figures::*;

/** Errors at rounding say nothing: clean fits of exact surfaces differ there for no reason. */
constexpr double kNothing = 1e-12;

Spread
spreadOf(const Cases& cases, const std::vector<Figures>& library,
         const std::vector<Figures>& changed, Member member)
{
  Spread spread;
  double logs = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const double was = library[i].*member, is = changed[i].*member;
    if (!(was > kNothing) || !(is > kNothing)) continue;
    const double ratio = is / was;
    logs += std::log(ratio);
    ++count;
    if (ratio < spread.least) spread.least = ratio, spread.least_case = cases[i]->name();
    if (ratio > spread.greatest) spread.greatest = ratio, spread.greatest_case = cases[i]->name();
  }
  if (count > 0) spread.mean = std::exp(logs / static_cast<double>(count));
  return spread;
}

std::string
cell(const Spread& spread)
{
  char text[256];
  std::snprintf(text, sizeof text, "%.3f; %.3f %s; %.3f %s | ", spread.mean, spread.least,
                spread.least_case.c_str(), spread.greatest, spread.greatest_case.c_str());
  return text;
}

std::string
shortCell(const Spread& spread)
{
  char text[64];
  std::snprintf(text, sizeof text, "%.3f | ", spread.mean);
  return text;
}

}  // namespace

Comparison
compareFigures(const Cases& cases, const std::vector<Figures>& library,
               const std::vector<Figures>& changed)
{
  Comparison c;
  const auto spread = [&](Member member) { return spreadOf(cases, library, changed, member); };
  c.position = spread(&Figures::position);
  c.normal = spread(&Figures::normal);
  c.curvature = spread(&Figures::curvature);
  c.leaves = spread(&Figures::leaves);
  c.seconds = spread(&Figures::seconds);
  c.farthest = spread(&Figures::farthest);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Figures &a = library[i], &b = changed[i];
    c.uncovered += b.uncovered - a.uncovered;
    c.same = c.same && a.position == b.position && a.normal == b.normal &&
             a.curvature == b.curvature && a.leaves == b.leaves && a.uncovered == b.uncovered &&
             a.farthest == b.farthest;
  }
  return c;
}

std::string
tableHeader()
{
  return "| rule or constant | becomes | position: mean; least; greatest | normals | curvature | "
         "leaves | time | farthest move | uncovered |\n|---|---|---|---|---|---|---|---|---|\n";
}

std::string
tableRow(const std::string& name, const std::string& becomes, const Comparison& comparison)
{
  const std::string row = "| " + name + " | " + becomes + " | ";
  if (comparison.same)
    return row + "nothing changes | | | | " + shortCell(comparison.seconds) + "| |\n";
  char uncovered[32];
  std::snprintf(uncovered, sizeof uncovered, "%+.0f |\n", comparison.uncovered);
  return row + cell(comparison.position) + cell(comparison.normal) + cell(comparison.curvature) +
         shortCell(comparison.leaves) + shortCell(comparison.seconds) + cell(comparison.farthest) +
         uncovered;
}

}  // namespace pcl_slim::ablation
