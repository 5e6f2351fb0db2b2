// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/options.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim {

/** \brief A page in place of a picture, as given on the command line. */
struct PageRequest {
  double precision = PageParams().precision;

  /** \brief Adds -precision. */
  void declare(OptionTable& table);

  /** \brief Whether an output is a page, by its extension. */
  static bool isPage(const std::string& output);

  /** \brief Names the first option that makes no sense for the output. */
  static Error check(const OptionTable& table, const std::string& output, const std::string& mode);

  /** \brief What the page is called: the input's name without folder and extension. */
  static std::string titleOf(const std::string& input);
};

}  // namespace pcl_slim
