// SPDX-License-Identifier: BSD-3-Clause
#include "render/idle_options.h"

#include <algorithm>

namespace pcl_slim {

namespace {

/** Options that change nothing where the rule applies, and why. */
struct Rule {
  bool applies;
  std::vector<const char*> names;
  const char* why;
};

/** Of the colours: the first rule that names an option gives the reason. */
std::vector<Rule>
colorRules(const DrawnThing& d)
{
  const ShadingMode mode = d.shading.mode;
  const bool plain = mode == ShadingMode::kNormal || mode == ShadingMode::kReflection;
  const bool traced = d.picture.isTraced(), picture = !d.is_page && !traced;
  return {
      {traced,
       {"range", "map", "bar", "unit", "lighting", "lod", "repeat"},
       "-mode raytraced does not use it"},
      {!traced, {"lights"}, "only -mode raytraced has lights"},
      {d.lines.sketch, {"ao", "aa", "lighting", "white"}, "-mode sketch draws lines on white"},
      {!showsNumbers(mode), {"range"}, "the mode shows no numbers"},
      {picture && !showsNumbers(mode), {"map", "unit"}, "the mode shows no numbers"},
      {picture && !hasColorBar(mode), {"bar"}, "the mode shows no numbers"},
      {picture && !d.picture.bar, {"unit"}, "only -bar names it"},
      {plain, {"lighting"}, "the mode has no light"},
      {picture && (plain || !d.shading.lighting), {"ao"}, "nothing is lit"},
  };
}

/** Of what is drawn. */
std::vector<Rule>
objectRules(const DrawnThing& d)
{
  const PictureLineParams found = d.lines.finding(1);
  return {
      {d.is_splats,
       {"hole", "trim", "lod", "repeat"},
       "it is for surfaces"},
      {!d.is_splats, {"filtered"}, "it is for splats"},
      {!d.trim, {"hole"}, "-trim 0 keeps no borders"},
      {!d.lines.any(), {"line_width"}, "no lines are drawn; give -lines"},
      {!found.crest, {"line_curvature"}, "no crest lines are drawn"},
      {!found.suggestive, {"line_slope"}, "no suggestive contours are drawn"},
      {!found.crest && !found.suggestive && !found.contour,
       {"line_length"},
       "no lines are looked for"},
  };
}

}  // namespace

std::vector<std::string>
idleOptions(const OptionTable& table, const DrawnThing& drawn)
{
  std::vector<std::string> notes, named;
  for (const auto& rules : {colorRules(drawn), objectRules(drawn)}) {
    for (const Rule& rule : rules) {
      for (const std::string name : rule.names) {
        const bool again = std::find(named.begin(), named.end(), name) != named.end();
        if (!rule.applies || again || !table.given(name)) continue;
        named.push_back(name);
        notes.push_back("  -" + name + " has no effect: " + rule.why);
      }
    }
  }
  return notes;
}

}  // namespace pcl_slim
