// SPDX-License-Identifier: BSD-3-Clause
// The table of parameters: names, ranges, what excludes what.
#include "pcl_slim/fit/fit_parameters.h"

#include <gtest/gtest.h>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace pcl_slim {
namespace {

template <typename Holder>
FitParams with(std::optional<double> Holder::*member, double x) {
  FitParams params;
  if constexpr (std::is_same_v<Holder, FitParams>)
    params.*member = x;
  else
    params.size.emplace<Holder>().*member = x;
  return params;
}
template <typename Holder>
FitParams with(double Holder::*member, double x) {
  FitParams params;
  if constexpr (std::is_same_v<Holder, FitParams>)
    params.*member = x;
  else
    params.size.emplace<Holder>().*member = x;
  return params;
}
template <typename Member>
FitParams with(Member, double) {
  return FitParams();
}

TEST(FitParameters, NamesAreUniqueAndSetsNameRows) {
  std::set<std::string> names;
  for (const FitParameter& row : fitParameters()) EXPECT_TRUE(names.insert(row.name).second);
  for (const auto& set : exclusiveFitParameters()) {
    for (const char* name : set) EXPECT_EQ(names.count(name), 1u) << name;
  }
}

TEST(FitParameters, ValuesOutOfRangeGiveTheRowsError) {
  EXPECT_FALSE(FitParams().validate());
  int checked = 0;
  for (const FitParameter& row : fitParameters()) {
    if (row.range.error == nullptr) continue;
    const auto messageAt = [&](double x) {
      const auto at = [x](auto member) { return with(member, x); };
      return std::visit(at, row.member).validate().message;
    };
    if (messageAt(std::nan("")).empty()) continue;  // no real number
    ++checked;
    for (const double x : {std::nan(""), -1.0, 2 * row.range.most})
      EXPECT_EQ(messageAt(x), row.range.error) << row.name << " " << x;
    EXPECT_NE(messageAt(row.range.least), row.range.error) << row.name;
    EXPECT_NE(messageAt(row.range.most), row.range.error) << row.name;
  }
  EXPECT_GE(checked, 10);
}

TEST(FitParameters, ASizeRuleSetTo0ReturnsToTheDefault) {
  FitParams params;
  setParameter(params, &TargetError::rms, 0.25);
  setParameter(params, &MaxSurfels::leaves, 0);
  EXPECT_EQ(getParameter(params, &TargetError::rms), 0.25);
  setParameter(params, &TargetError::rms, 0.0);
  EXPECT_TRUE(std::holds_alternative<PenaltyWeight>(params.size));
  EXPECT_EQ(getParameter(params, &PenaltyWeight::kappa), 0.0);
}

TEST(FitParameters, NoiseIsUnsetBy0) {
  FitParams params;
  setParameter(params, &FitParams::noise, 0.005);
  EXPECT_EQ(getParameter(params, &FitParams::noise), 0.005);
  setParameter(params, &FitParams::noise, 0.0);
  EXPECT_FALSE(params.noise);
}

TEST(FitParameters, GivenNoiseMakesItsMeasureIdle) {
  FitParams params;
  params.noise = 0.005;
  params.local_noise = false;
  const std::vector<IdleFitParameter> idle = idleParameters(params, FitStatistics());
  ASSERT_EQ(idle.size(), 1u);
  EXPECT_EQ(idle[0].name, "local_noise");
  EXPECT_NE(idle[0].reason.find("-noise"), std::string::npos);
}

TEST(FitParameters, WithoutEffect) {
  FitParams params;
  params.sides = false;
  params.trim = false;
  params.hole_size = 6;
  FitStatistics fit;
  EXPECT_TRUE(idleParameters(params, fit).empty());
  fit.sides.source = SideSource::kNormals;
  ASSERT_EQ(idleParameters(params, fit).size(), 1u);
  EXPECT_EQ(idleParameters(params, fit)[0].name, "sides");
  ASSERT_EQ(overruledParameters(params).size(), 1u);
  EXPECT_EQ(overruledParameters(params)[0].name, "hole");
}

}  // namespace
}  // namespace pcl_slim
