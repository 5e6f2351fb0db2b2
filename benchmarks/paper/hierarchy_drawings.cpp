// SPDX-License-Identifier: BSD-3-Clause
// The intervals in which radii are looked for, with the radii found (Fig. 5), and the tree of balls
// in a slice of a surface (Fig. 6), both of fits by the paper's rules.
#include <algorithm>
#include <cmath>
#include <random>

#include "paper/study.h"
#include "paper/svg.h"

namespace pcl_slim::paper {

namespace {

constexpr double kGolden = 0.6180339887498949;
const std::array<const char*, 6> kColors = {"#1f4e9c", "#2a9d8f", "#e9a21b",
                                            "#d1495b", "#7b4fa3", "#555555"};

std::string fill(const std::string& color, double opacity = 1.0) {
  return "fill=\"" + color + "\" fill-opacity=\"" + number("%.2f", opacity) + "\"";
}

std::string stroke(const std::string& color, double width, double opacity = 1.0) {
  return "stroke=\"" + color + "\" stroke-width=\"" + number("%.2f", width) +
         "\" stroke-opacity=\"" + number("%.2f", opacity) + "\"";
}

Result<Fitted> paperFit(const StudySettings& settings, const char* file, double threshold) {
  const auto model = loadModel(settings, file);
  if (!model) return model.error();
  FitParams params;
  params.paper_mode = true;
  params.degree = 2;
  params.size = MDLThreshold{threshold};
  params.threads = settings.threads;
  return fitModel(*model, params);
}

/** One level of Fig. 5: its interval as a bar, its leaves' radii as dots. \return leaves inside it
 */
std::size_t drawLevel(const SLIMSurface& s, int level, double top, double height, Svg& svg) {
  constexpr double kLeft = 90, kDecade = 560;
  const auto x = [](double r) { return kLeft + kDecade * (std::log10(r) + 2.5) / 1.5; };
  const double high = 0.1 * std::pow(kGolden, level - 1), low = kGolden * kGolden * high;
  const std::string color = kColors[static_cast<std::size_t>(level - 1) % kColors.size()];
  svg.rectangle({x(low), top}, x(high) - x(low), height,
                fill(color, 0.15) + " " + stroke(color, 1));
  svg.line({x(kGolden * high), top}, {x(kGolden * high), top + height},
           stroke(color, 1) + " stroke-dasharray=\"4 3\"");
  std::mt19937 random(static_cast<unsigned>(level));
  std::uniform_real_distribution<double> place(0.12, 0.88);
  std::size_t leaves = 0, inside = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.level[i] != level || !s.isLeaf(i)) continue;
    const double r = double{s.radius[i]} / s.info.diagonal;
    ++leaves;
    inside += r >= low * 0.9999 && r <= high * 1.0001 ? 1 : 0;
    svg.circle({x(r), top + height * place(random)}, 1.1, fill(color, 0.55));
  }
  const double middle = top + 0.5 * height + 4;
  svg.text({kLeft - 14, middle}, "end", "k = " + std::to_string(level));
  svg.text({kLeft + kDecade + 12, middle}, "start", std::to_string(leaves) + " leaves");
  return inside;
}

}  // namespace

Error radiusIntervals(const StudySettings& settings) {
  const auto fitted = paperFit(settings, "stanford_dragon_res2.ply", 0.01);
  if (!fitted) return fitted.error();
  const SLIMSurface& s = fitted->surface;
  const int levels = *std::max_element(s.level.begin(), s.level.end());
  constexpr double kRow = 46, kTop = 40;
  Svg svg(770, kTop + kRow * levels + 46);
  Table table("Radii of leaves within their level's interval (Fig. 5)",
              {"level k", "interval / L", "leaves inside"});
  for (int level = 1; level <= levels; ++level) {
    const double high = 0.1 * std::pow(kGolden, level - 1);
    const std::size_t inside = drawLevel(s, level, kTop + kRow * (level - 1) + 5, kRow - 10, svg);
    table.row({std::to_string(level),
               number("%.4f to ", kGolden * kGolden * high) + number("%.4f", high),
               std::to_string(inside)});
  }
  const double bottom = kTop + kRow * levels + 4;
  for (const double r : {0.005, 0.01, 0.02, 0.05, 0.1}) {
    const double x = 90 + 560 * (std::log10(r) + 2.5) / 1.5;
    svg.line({x, kTop}, {x, bottom}, stroke("#bbbbbb", 0.7));
    svg.text({x, bottom + 16}, "middle", number("%g", r));
  }
  svg.text({370, bottom + 34}, "middle", "radius / L");
  svg.text({370, 22}, "middle",
           "r_l, r_m (dashed), r_r of each level, and the radii of its leaves");
  if (Error error = svg.save(settings.out + "/fig05.svg")) return error;
  return table.save(settings, "fig05");
}

namespace {

/** Balls of a surface whose centres are near a plane across z. */
struct Slice {
  const SLIMSurface& s;
  std::vector<std::uint32_t> balls;
  Point2 middle{};

  explicit Slice(const SLIMSurface& surface) : s(surface) {
    const float z = s.root_ball[2] + 0.02f;
    for (std::uint32_t i = 0; i < s.size(); ++i) {
      if (std::abs(s.cz[i] - z) < 0.008f) balls.push_back(i);
    }
    for (const std::uint32_t i : balls) {
      middle[0] += s.cx[i] / static_cast<double>(balls.size());
      middle[1] += s.cy[i] / static_cast<double>(balls.size());
    }
  }

  double angle(std::uint32_t i) const {
    return std::atan2(s.cy[i] - middle[1], s.cx[i] - middle[0]);
  }
};

std::string colorOf(const SLIMSurface& s, std::uint32_t i) {
  return kColors[static_cast<std::size_t>(s.level[i] - 1) % kColors.size()];
}

/** The balls as discs, coarse ones below. */
void drawBalls(const Slice& slice, const Point2& at, double scale, Svg& svg) {
  const SLIMSurface& s = slice.s;
  const int levels = *std::max_element(s.level.begin(), s.level.end());
  for (int level = 1; level <= levels; ++level) {
    for (const std::uint32_t i : slice.balls) {
      if (s.level[i] != level) continue;
      const Point2 c = {at[0] + scale * (s.cx[i] - slice.middle[0]),
                        at[1] - scale * (s.cy[i] - slice.middle[1])};
      const std::string color = colorOf(s, i);
      svg.circle(
          c, scale * double{s.radius[i]},
          (s.isLeaf(i) ? fill(color, 0.28) + " " : "fill=\"none\" stroke-dasharray=\"4 3\" ") +
              stroke(color, s.isLeaf(i) ? 0.8 : 1.3));
    }
  }
}

/** The levels as rows of nodes around the slice, with the links between them. \return links */
std::size_t drawTree(const Slice& slice, const Point2& corner, double width, double row, Svg& svg) {
  const SLIMSurface& s = slice.s;
  const auto place = [&](std::uint32_t i) {
    return Point2{corner[0] + width * (0.5 - slice.angle(i) / (2 * 3.14159265358979)),
                  corner[1] + row * s.level[i]};
  };
  const Point2 root = {corner[0] + 0.5 * width, corner[1]};
  std::vector<bool> shown(s.size(), false);
  for (const std::uint32_t i : slice.balls) shown[i] = true;
  for (const std::uint32_t i : s.roots) {
    if (shown[i]) svg.line(root, place(i), stroke("#888888", 0.6, 0.7));
  }
  std::size_t links = 0;
  for (const std::uint32_t i : slice.balls) {
    for (std::uint32_t k = s.child_begin[i]; k < s.child_begin[i + 1]; ++k) {
      const bool around = std::abs(place(i)[0] - place(s.children[k])[0]) > 0.5 * width;
      if (!shown[s.children[k]] || around) continue;
      svg.line(place(i), place(s.children[k]), stroke("#888888", 0.6, 0.7));
      ++links;
    }
  }
  for (const std::uint32_t i : slice.balls) {
    const bool leaf = s.isLeaf(i);
    svg.circle(place(i), leaf ? 3.0 : 4.5,
               (leaf ? fill(colorOf(s, i)) : fill("#ffffff")) + " " + stroke(colorOf(s, i), 1.4));
  }
  svg.circle(root, 5, fill("#222222"));
  svg.text({root[0] + 12, root[1] + 4}, "start", "enclosing ball");
  const int levels = *std::max_element(s.level.begin(), s.level.end());
  for (int level = 1; level <= levels; ++level)
    svg.text({corner[0] - 8, corner[1] + row * level + 4}, "end", "k = " + std::to_string(level));
  return links;
}

}  // namespace

Error treeOfBalls(const StudySettings& settings) {
  const auto fitted = paperFit(settings, "stanford_bunny_zipper.ply", 0.05);
  if (!fitted) return fitted.error();
  const Slice slice(fitted->surface);
  Svg svg(1180, 440);
  drawBalls(slice, {240, 235}, 820, svg);
  const std::size_t links = drawTree(slice, {540, 70}, 620, 100, svg);
  svg.text({240, 24}, "middle", "balls in a slice; dashed: internal");
  svg.text({840, 24}, "middle", "their tree, unrolled; open: internal, full: leaves");
  std::printf("slice of %zu balls, %zu links\n", slice.balls.size(), links);
  return svg.save(settings.out + "/fig06.svg");
}

}  // namespace pcl_slim::paper
