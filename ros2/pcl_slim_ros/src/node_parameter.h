// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <pcl_slim/core/error.h>
#include <pcl_slim/fit/fit_parameters.h>

namespace pcl_slim_ros {

/** \brief A value of the types that ROS's parameters have here. */
using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

/** \brief A parameter of a node, without ROS: what is declared, and where its value goes. */
struct NodeParameter {
  std::string name, description;
  Value value;                                        ///< the default
  std::optional<std::array<double, 2>> range;         ///< of numbers, both ends included
  std::function<pcl_slim::Error(const Value&)> take;  ///< stores a value of the default's type
};

using NodeParameters = std::vector<NodeParameter>;

/** \brief A parameter that is stored as it is. \param[in] target outlives the parameter. */
template <typename Number>
NodeParameter numberParameter(const std::string& name, const std::string& description,
                              Number* target, double low, double high) {
  using Stored = std::conditional_t<std::is_integral_v<Number>, std::int64_t, double>;
  return {name, description, Value(static_cast<Stored>(*target)), std::array<double, 2>{low, high},
          [target](const Value& value) -> pcl_slim::Error {
            *target = static_cast<Number>(std::get<Stored>(value));
            return {};
          }};
}

/** \brief A switch, likewise. */
NodeParameter switchParameter(const std::string& name, const std::string& description,
                              bool* target);

/** \brief One of a few words. \param[in] take gets its index. */
NodeParameter choiceParameter(const std::string& name, const std::string& description,
                              const std::vector<std::string>& words,
                              const std::function<void(std::size_t)>& take);

/** \brief A place, x y z; no numbers: none. */
NodeParameter placeParameter(const std::string& name, const std::string& description,
                             std::optional<std::array<double, 3>>* target);

/** \brief The parameters of a fit, of the table that the programs' options come from; those of trim
 * maps, which no node makes, are left out. \param[in] params outlives them. */
NodeParameters fitNodeParameters(pcl_slim::FitParams& params);

}  // namespace pcl_slim_ros
