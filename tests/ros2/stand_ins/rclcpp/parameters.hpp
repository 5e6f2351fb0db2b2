// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for ROS's header of this name: what the nodes use of it.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace rclcpp {

enum ParameterType : std::uint8_t {
  PARAMETER_NOT_SET = 0,
  PARAMETER_BOOL = 1,
  PARAMETER_INTEGER = 2,
  PARAMETER_DOUBLE = 3,
  PARAMETER_STRING = 4,
  PARAMETER_DOUBLE_ARRAY = 8
};

class ParameterValue {
 public:
  ParameterValue() = default;
  explicit ParameterValue(bool value) : value_(value) {}
  explicit ParameterValue(int value) : value_(std::int64_t{value}) {}
  explicit ParameterValue(std::int64_t value) : value_(value) {}
  explicit ParameterValue(double value) : value_(value) {}
  explicit ParameterValue(const std::string& value) : value_(value) {}
  explicit ParameterValue(const char* value) : value_(std::string(value)) {}
  explicit ParameterValue(const std::vector<double>& value) : value_(value) {}

  ParameterType get_type() const {
    constexpr ParameterType kTypes[] = {PARAMETER_NOT_SET, PARAMETER_BOOL,
                                        PARAMETER_INTEGER, PARAMETER_DOUBLE,
                                        PARAMETER_STRING,  PARAMETER_DOUBLE_ARRAY};
    return kTypes[value_.index()];
  }
  /** Throws where the value is of another type. */
  template <typename T>
  const T& get() const {
    return std::get<T>(value_);
  }
  bool operator==(const ParameterValue& other) const { return value_ == other.value_; }

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>> value_;
};

class Parameter {
 public:
  Parameter() = default;
  Parameter(const std::string& name, const ParameterValue& value) : name_(name), value_(value) {}
  template <typename T>
  Parameter(const std::string& name, T value) : Parameter(name, ParameterValue(value)) {}

  const std::string& get_name() const { return name_; }
  ParameterType get_type() const { return value_.get_type(); }
  const ParameterValue& get_parameter_value() const { return value_; }

 private:
  std::string name_;
  ParameterValue value_;
};

namespace exceptions {

class InvalidParameterValueException : public std::runtime_error {
  using std::runtime_error::runtime_error;
};
class InvalidParameterTypeException : public std::runtime_error {
  using std::runtime_error::runtime_error;
};
class ParameterNotDeclaredException : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace exceptions
}  // namespace rclcpp
