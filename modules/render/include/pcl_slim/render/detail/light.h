// SPDX-License-Identifier: BSD-3-Clause
// The light of pictures: its constants, for shade() and, by their names, for the shaders of windows
// and pages (visualization/src/frame/light_glsl.cpp).
#pragma once

#include <array>

namespace pcl_slim::detail {

constexpr std::array<double, 3> kKeyLight{-0.55, 0.75, -0.65};  ///< towards it; right, up, forward
constexpr double kAmbientLight = 0.10;
constexpr double kSkyLight = 0.12;   ///< on what faces upwards
constexpr double kHeadLight = 0.28;  ///< on what faces the viewer
constexpr double kKeyStrength = 0.62;
constexpr double kShine = 0.16;  ///< of the key light's highlight
constexpr double kShinePower = 40.0;
// Colours that encode something stay legible: less contrast, no highlight.
constexpr double kCodedAmbient = 0.45, kCodedDiffuse = 0.55;

constexpr std::array<double, 3> kClay{0.80, 0.74, 0.66};  ///< sRGB
constexpr std::array<double, 3> kClayBack{0.52, 0.56,
                                          0.64};  ///< the inner side, where both are shown

/** \brief The background's grey at the top, what it loses downwards, and what its blue has more. */
constexpr std::array<double, 3> kPaper{0.985, 0.145, 0.006};

// The shade in hollows: neighbours on a spiral, which repeats in 4 x 4 pixels.
constexpr double kHollowSamples = 16.0;
constexpr double kHollowReach = 0.045;  ///< radius of the spiral, of the picture's smaller side
constexpr double kHollowRise = 0.08;    ///< sine of an elevation that hides nothing yet
constexpr double kHollowStrength = 1.6;
constexpr double kGoldenAngle = 2.39996322972865332;

constexpr double kStripes = 12.0;     ///< of mirrored light, phase per radian
constexpr double kStripeEdge = 0.15;  ///< by the sine of the phase
constexpr std::array<double, 3> kStripeDark{0.08, 0.09, 0.12};
constexpr double kStripeLight = 0.96;

/** \brief A constant of the light by its name in shaders: a number or three. */
struct LightConstant {
  const char* name;
  std::array<double, 3> value;
  int count;

  constexpr LightConstant(const char* n, double v) : name(n), value{v, v, v}, count(1) {}
  constexpr LightConstant(const char* n, const std::array<double, 3>& v)
      : name(n), value(v), count(3) {}
};

constexpr std::array<LightConstant, 21> kLightConstants{
    {{"kKeyLight", kKeyLight},           {"kAmbientLight", kAmbientLight},
     {"kSkyLight", kSkyLight},           {"kHeadLight", kHeadLight},
     {"kKeyStrength", kKeyStrength},     {"kShine", kShine},
     {"kShinePower", kShinePower},       {"kCodedAmbient", kCodedAmbient},
     {"kCodedDiffuse", kCodedDiffuse},   {"kClay", kClay},
     {"kClayBack", kClayBack},           {"kPaper", kPaper},
     {"kHollowSamples", kHollowSamples}, {"kHollowReach", kHollowReach},
     {"kHollowRise", kHollowRise},       {"kHollowStrength", kHollowStrength},
     {"kGoldenAngle", kGoldenAngle},     {"kStripes", kStripes},
     {"kStripeEdge", kStripeEdge},       {"kStripeDark", kStripeDark},
     {"kStripeLight", kStripeLight}}};

}  // namespace pcl_slim::detail
