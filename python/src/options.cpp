// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <type_traits>
#include <variant>

#include "pcl_slim/fit/fit_parameters.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

/** The keyword of a parameter: lambda is a word of the language. */
std::string keywordOf(const char* name) {
  return std::strcmp(name, "lambda") == 0 ? "lambda_" : name;
}

std::string reprOf(const py::handle& value) {
  return py::repr(value).cast<std::string>();
}

[[noreturn]] void raiseNumber(const std::string& name, const char* kind, double low, double high,
                              const py::handle& value) {
  const std::string range =
      high > low ? " from " + numberText(low) + " to " + numberText(high) : "";
  raiseValue(name + " takes a " + kind + range + ", not " + reprOf(value));
}

double toNumber(const std::string& name, const py::handle& value, double low, double high) {
  double number = NAN;
  try {
    if (!py::isinstance<py::str>(value))
      number = py::float_(py::reinterpret_borrow<py::object>(value));
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
  }
  if (!std::isfinite(number) || (high > low && !(number >= low && number <= high)))
    raiseNumber(name, "number", low, high, value);
  return number;
}

std::int64_t toInteger(const std::string& name, const py::handle& value, double low, double high) {
  const double number = toNumber(name, value, low, high);
  if (number != std::floor(number) || std::abs(number) > 9e18)
    raiseNumber(name, "whole number", low, high, value);
  return static_cast<std::int64_t>(number);
}

bool toSwitch(const std::string& name, const py::handle& value) {
  const int truth = py::isinstance<py::str>(value) ? -1 : PyObject_IsTrue(value.ptr());
  if (truth >= 0) return truth != 0;
  PyErr_Clear();
  raiseValue(name + " takes True or False, not " + reprOf(value));
}

/** Sets one parameter from a keyword's value. */
class ParameterSetter {
 public:
  ParameterSetter(const FitParameter& row, const py::object& value, FitParams& params)
      : row_(row), name_(keywordOf(row.name)), value_(value), params_(params) {}

  void operator()(std::optional<std::array<double, 3>> FitParams::*member) const {
    params_.*member = readPlace(value_, name_.c_str());
  }
  template <typename Holder, typename Value>
  void operator()(Value Holder::*member) const {
    using Number = decltype(getParameter(params_, member));
    const double low = row_.option.low, high = row_.option.high;
    if constexpr (std::is_same_v<Number, bool>) {
      params_.*member = toSwitch(name_, value_);
    } else if constexpr (std::is_integral_v<Number>) {
      setParameter(params_, member, static_cast<Number>(toInteger(name_, value_, low, high)));
    } else if (row_.option.on) {
      setParameter(params_, member, toSwitch(name_, value_) ? *row_.option.on : 0.0);
    } else {
      setParameter(params_, member, toNumber(name_, value_, low, high));
    }
  }

 private:
  const FitParameter& row_;
  const std::string name_;
  const py::object& value_;
  FitParams& params_;
};

bool isOption(const FitParameter& row, FitUse use) {
  if (row.group == FitOption::kNone) return false;
  return use == FitUse::kSurface || row.group != FitOption::kTrim;
}

void checkExclusive(const std::vector<std::string>& given) {
  for (const auto& names : exclusiveFitParameters()) {
    std::string first;
    for (const char* name : names) {
      const std::string keyword = keywordOf(name);
      if (std::find(given.begin(), given.end(), keyword) == given.end()) continue;
      if (!first.empty()) raiseValue(first + " and " + keyword + " exclude each other: give one");
      first = keyword;
    }
  }
}

}  // namespace

py::object Keywords::take(const char* name) {
  known_.emplace_back(name);
  return given_.contains(name) ? py::object(given_[name]) : py::none();
}

bool Keywords::takeSwitch(const char* name, bool unset) {
  const py::object value = take(name);
  return value.is_none() ? unset : toSwitch(name, value);
}

double Keywords::takeNumber(const char* name, double low, double high, double unset) {
  const py::object value = take(name);
  return value.is_none() ? unset : toNumber(name, value, low, high);
}

std::int64_t Keywords::takeInteger(const char* name, std::int64_t low, std::int64_t high,
                                   std::int64_t unset) {
  const py::object value = take(name);
  return value.is_none()
             ? unset
             : toInteger(name, value, static_cast<double>(low), static_cast<double>(high));
}

std::string Keywords::takeWord(const char* name, std::initializer_list<const char*> words,
                               const char* unset) {
  const py::object value = take(name);
  if (value.is_none()) return unset;
  std::string all;
  for (const char* word : words) {
    if (py::isinstance<py::str>(value) && value.cast<std::string>() == word) return word;
    all += (all.empty() ? "" : ", ") + std::string(word);
  }
  raiseValue(std::string(name) + " takes one of " + all + ", not " + reprOf(value));
}

int Keywords::takeThreads() {
  return threadsFor(static_cast<int>(takeInteger("threads", 0, 4096, 0)));
}

void Keywords::takeScan(ScanArguments& scan, FitParams& params) {
  scan.sensors = take("sensors");
  scan.frames = take("frames");
  params.viewpoint = readPlace(take("viewpoint"), "viewpoint");
  if (params.viewpoint && !scan.sensors.is_none())
    raiseValue("viewpoint and sensors exclude each other: give one");
}

FitParams Keywords::takeFit(FitUse use) {
  FitParams params;
  params.trim = use == FitUse::kSurface;
  std::vector<std::string> given;
  for (const FitParameter& row : fitParameters()) {
    if (!isOption(row, use) || row.group == FitOption::kSensor || row.group == FitOption::kThreads)
      continue;
    const std::string keyword = keywordOf(row.name);
    const py::object value = take(keyword.c_str());
    if (value.is_none()) continue;
    given.push_back(keyword);
    if (row.group == FitOption::kFit || row.group == FitOption::kRun) only_fits_.push_back(keyword);
    std::visit(ParameterSetter(row, value, params), row.member);
  }
  checkExclusive(given);
  sensor_noise_ = takeSensorNoise(take("sensor_noise"), params);
  if (sensor_noise_) only_fits_.emplace_back("sensor_noise");
  params.threads = takeThreads();
  return params;
}

void Keywords::refuseWithSurface() const {
  if (only_fits_.empty()) return;
  raiseValue(only_fits_.front() +
             " is of a fit and changes nothing of a surface that is given: leave one of them out");
}

void Keywords::finish() const {
  for (const auto& item : given_) {
    const auto name = item.first.cast<std::string>();
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    std::vector<std::string> sorted = known_;
    std::sort(sorted.begin(), sorted.end());
    std::string all;
    for (const std::string& known : sorted) all += (all.empty() ? "" : ", ") + known;
    throw py::type_error(std::string(function_) + "() has no option '" + name + "': it takes " +
                         all);
  }
}

std::string withoutDashes(std::string sentence) {
  for (std::size_t i = 0; i + 1 < sentence.size(); ++i) {
    const bool begins = i == 0 || sentence[i - 1] == ' ' || sentence[i - 1] == '(';
    const bool letter = sentence[i + 1] >= 'a' && sentence[i + 1] <= 'z';
    if (sentence[i] == '-' && begins && letter) sentence.erase(i, 1);
  }
  return sentence;
}

}  // namespace pcl_slim::python
