// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameter.h"

#include <algorithm>
#include <cctype>
#include <type_traits>
#include <utility>

namespace pcl_slim_ros {

using pcl_slim::Error;
using pcl_slim::ErrorCode;
using pcl_slim::FitOption;
using pcl_slim::FitParameter;
using pcl_slim::FitParams;

namespace {

Error bad(const std::string& message) {
  return {ErrorCode::kBadArgument, message};
}

/** A help text of the programs without the dashes of their options. */
std::string withoutDashes(const std::string& text) {
  std::string made;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts = i == 0 || text[i - 1] == ' ' || text[i - 1] == '(';
    const bool option = text[i] == '-' && starts && i + 1 < text.size() &&
                        std::islower(static_cast<unsigned char>(text[i + 1]));
    if (!option) made += text[i];
  }
  return made;
}

/** What unset parameters are: "; 0: estimated". */
std::string unsetText(const char* value, const char* meaning) {
  return *meaning && std::string(meaning) != value
             ? std::string("; ") + value + ": " + withoutDashes(meaning)
             : "";
}

NodeParameter wordParameter(FitParams& params, const FitParameter& row) {
  // Reading a word leaves the parameter as it is where the word is the default one.
  const auto take = [&params, read = row.option.read](const Value& value) -> Error {
    FitParams fresh = params;
    fresh.noise_correlation = FitParams().noise_correlation;
    if (Error error = read(std::get<std::string>(value), fresh)) {
      if (!error.message.empty() && error.message.front() == '-') error.message.erase(0, 1);
      return error;
    }
    params = fresh;
    return {};
  };
  return {row.name, withoutDashes(row.help) + "; " + row.option.parts,
          Value(std::string(row.option.unset)), std::nullopt, take};
}

/** A switch with a third state, "auto". */
NodeParameter autoParameter(FitParams& params, const FitParameter& row,
                            std::optional<bool> FitParams::*member) {
  const std::vector<std::string> words = {"auto", "on", "off"};
  return choiceParameter(
      row.name, withoutDashes(row.help), words, [&params, member](std::size_t chosen) {
        params.*member = chosen == 0 ? std::nullopt : std::optional<bool>(chosen == 1);
      });
}

NodeParameter tripleParameter(FitParams& params, const FitParameter& row,
                              std::optional<std::array<double, 3>> FitParams::*member) {
  return placeParameter(row.name, withoutDashes(row.help), &(params.*member));
}

template <typename Holder, typename Member>
NodeParameter memberParameter(FitParams& params, const FitParameter& row, Member Holder::*member) {
  using pcl_slim::getParameter;
  using pcl_slim::setParameter;
  using Number = decltype(getParameter(params, member));
  const std::string help = withoutDashes(row.help);
  if constexpr (std::is_same_v<Member, std::optional<bool>>) {
    return autoParameter(params, row, member);
  } else if constexpr (std::is_same_v<Member, std::optional<std::array<double, 3>>>) {
    return tripleParameter(params, row, member);
  } else if constexpr (std::is_same_v<Number, bool>) {
    return switchParameter(row.name, help, &(params.*member));
  } else if (row.option.on) {
    const auto take = [&params, member, on = *row.option.on](const Value& value) -> Error {
      setParameter(params, member, static_cast<Number>(std::get<bool>(value) ? on : 0.0));
      return {};
    };
    return {row.name, help, Value(false), std::nullopt, take};
  } else {
    using Stored = std::conditional_t<std::is_integral_v<Number>, std::int64_t, double>;
    const auto take = [&params, member](const Value& value) -> Error {
      setParameter(params, member, static_cast<Number>(std::get<Stored>(value)));
      return {};
    };
    // 0 is no value of most options; here it unsets them.
    const double low = std::min(row.option.low, 0.0);
    return {row.name, help + unsetText("0", row.option.unset),
            Value(static_cast<Stored>(getParameter(params, member))),
            std::array<double, 2>{low, row.option.high}, take};
  }
}

}  // namespace

NodeParameter switchParameter(const std::string& name, const std::string& description,
                              bool* target) {
  return {name, description, Value(*target), std::nullopt, [target](const Value& value) -> Error {
            *target = std::get<bool>(value);
            return {};
          }};
}

NodeParameter choiceParameter(const std::string& name, const std::string& description,
                              const std::vector<std::string>& words,
                              const std::function<void(std::size_t)>& take) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : "|") + word;
  const auto checked = [=](const Value& value) -> Error {
    const auto& word = std::get<std::string>(value);
    const auto at = std::find(words.begin(), words.end(), word);
    if (at == words.end()) return bad(name + " '" + word + "' is none of " + list + "; give one");
    take(static_cast<std::size_t>(at - words.begin()));
    return {};
  };
  return {name, description + "; " + list, Value(words.front()), std::nullopt, checked};
}

NodeParameter placeParameter(const std::string& name, const std::string& description,
                             std::optional<std::array<double, 3>>* target) {
  const auto take = [name, target](const Value& value) -> Error {
    const auto& numbers = std::get<std::vector<double>>(value);
    if (!numbers.empty() && numbers.size() != 3)
      return bad(name + " has " + std::to_string(numbers.size()) + " numbers: give 3, or none");
    target->reset();
    if (numbers.size() == 3) *target = {numbers[0], numbers[1], numbers[2]};
    return {};
  };
  return {name, description + "; three numbers, or []", Value(std::vector<double>()), std::nullopt,
          take};
}

NodeParameters fitNodeParameters(FitParams& params) {
  NodeParameters parameters;
  for (const FitParameter& row : pcl_slim::fitParameters()) {
    if (row.group == FitOption::kNone || row.group == FitOption::kTrim) continue;
    if (row.option.read) {
      parameters.push_back(wordParameter(params, row));
      continue;
    }
    parameters.push_back(
        std::visit([&](auto member) { return memberParameter(params, row, member); }, row.member));
  }
  return parameters;
}

}  // namespace pcl_slim_ros
