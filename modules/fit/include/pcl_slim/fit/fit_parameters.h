// SPDX-License-Identifier: BSD-3-Clause
// The table of a fit's parameters. A new one is a member of FitParams and a row of this table: the
// programs' options, their help, what excludes what and the ranges of FitParams::validate() follow.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim {

/** \brief Where a parameter is: a member of FitParams, or of one of its size rules. */
using FitMember = std::variant<
    bool FitParams::*, int FitParams::*, std::uint64_t FitParams::*, double FitParams::*,
    std::optional<bool> FitParams::*, std::optional<int> FitParams::*,
    std::optional<double> FitParams::*, std::optional<std::array<double, 3>> FitParams::*,
    std::optional<double> PenaltyWeight::*, double MDLThreshold::*, double TargetError::*,
    std::uint64_t MaxSurfels::*, double NoiseFactor::*, double TargetDistance::*>;

/** \brief Which programs have a parameter as an option. */
enum class FitOption : unsigned char {
  kNone,     ///< none
  kFit,      ///< all that fit; no effect on a surface that was fitted before
  kScan,     ///< all that fit; has an effect on scans beside such a surface, too
  kSensor,   ///< all that read scans
  kRun,      ///< all that fit, after the options of loading a scan; no effect on such a surface
  kThreads,  ///< all that fit, likewise; has an effect beside such a surface, too
  kTrim      ///< those whose surface is kept or drawn
};

/** \brief A parameter of a fit. */
struct FitParameter {
  /** \brief What programs accept and show. */
  struct Option {
    double low = 0, high = 0;       ///< bounds of a number
    const char* unset = "";         ///< the default shown; "": the member's value
    const char* parts = "";         ///< of three numbers or a word: its form, "A,B,C"
    std::optional<double> on = {};  ///< of a number that is a switch: its value there
    /** \brief Reads a word in place of a number. */
    Error (*read)(const std::string& word, FitParams& params) = nullptr;
  };
  /** \brief What a fit accepts: numbers in [least, most]. */
  struct Range {
    double least = std::numeric_limits<double>::lowest();
    double most = std::numeric_limits<double>::max();
    const char* error = nullptr;  ///< of other numbers; null: the range is not checked
  };

  const char* name;  ///< of the option, without its dash
  FitMember member;
  FitOption group;
  const char* help;
  Option option = {};
  Range range = {};
};

/** \brief All parameters, in the order of a program's help. */
PCL_SLIM_EXPORT const std::vector<FitParameter>& fitParameters();

/** \brief Names of parameters of which at most one may be given. */
PCL_SLIM_EXPORT const std::vector<std::vector<const char*>>& exclusiveFitParameters();

/** \brief A parameter that was given and changed nothing. */
struct IdleFitParameter {
  std::string name, reason;
};
/** \brief Those that did not change a fit that was made. */
PCL_SLIM_EXPORT std::vector<IdleFitParameter> idleParameters(const FitParams& params,
                                                             const FitStatistics& fit);
/** \brief Those that other parameters make meaningless. */
PCL_SLIM_EXPORT std::vector<IdleFitParameter> overruledParameters(const FitParams& params);

/** \brief Sets a parameter that has a value always. */
template <typename Value>
void setParameter(FitParams& params, Value FitParams::*member, Value value) {
  params.*member = value;
}
/** \brief Sets one that may be unset; 0 unsets it. */
template <typename Value>
void setParameter(FitParams& params, std::optional<Value> FitParams::*member, Value value) {
  params.*member = value != Value() ? std::optional<Value>(value) : std::nullopt;
}
/** \brief Takes a size rule with this value; 0 returns from that rule to the default. */
template <typename Rule, typename Value, typename Number>
void setParameter(FitParams& params, Value Rule::*member, Number value) {
  if (value != 0)
    params.size.emplace<Rule>().*member = value;
  else if (std::holds_alternative<Rule>(params.size))
    params.size = {};
}

/** \brief A parameter's value; 0 where it is not set. */
template <typename Value>
Value getParameter(const FitParams& params, Value FitParams::*member) {
  return params.*member;
}
/** \brief The same for a parameter that may be unset. */
template <typename Value>
Value getParameter(const FitParams& params, std::optional<Value> FitParams::*member) {
  return (params.*member).value_or(Value());
}
/** \brief The value of a size rule; 0 where another rule is set. */
template <typename Rule, typename Value>
auto getParameter(const FitParams& params, Value Rule::*member) {
  const auto* rule = std::get_if<Rule>(&params.size);
  if constexpr (std::is_same_v<Rule, PenaltyWeight>)
    return rule ? (rule->*member).value_or(0) : 0;
  else
    return rule ? rule->*member : Value();
}

}  // namespace pcl_slim
