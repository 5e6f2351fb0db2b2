// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

/** \brief Lists on the command line of programs that measure. */
namespace pcl_slim::measure {

/** \brief An option that takes several values, "1,2,4": one row is measured for each. */
struct ListOption {
  const char* name;
  const std::string* text;
  double low, high;  ///< allowed values, both included
  bool whole;        ///< no fractions
  std::vector<double>* values;
};

/** \brief Parses every list. \return the first mistake, naming option and remedy. */
Error
parseLists(const std::vector<ListOption>& options);

/** \brief Parses "sphere,torus". \return the first name that is none. */
Error
parseShapes(const std::string& text, std::vector<std::string>& names);

}  // namespace pcl_slim::measure
