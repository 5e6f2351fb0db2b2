// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fit_constants.h"

/** \brief Changes of the fit's constants: what an ablation switches off, halves and doubles. */
namespace pcl_slim::ablation {

/** \brief One fit other than the library's. */
struct Change {
  std::string name;     ///< "radius.sure_margin"
  std::string becomes;  ///< "off" or the changed value
  std::function<void(detail::FitConstants&)> apply;
};

/** \brief Every rule that a value of its constants switches off. */
std::vector<Change>
rulesOff();

/** \brief Every tuning constant halved and doubled; whole numbers and angles within their limits. */
std::vector<Change>
constantsScaled();

}  // namespace pcl_slim::ablation
