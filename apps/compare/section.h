// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"
#include "common/program.h"
#include "compare/measurement.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief A plane that both objects are cut by, as given on the command line. */
struct SectionRequest {
  std::vector<double> plane;  ///< place and normal, or empty
  std::string file;

  /** \brief Adds the options. The request must outlive the table's parse(). */
  void declare(OptionTable& table);
  /** \brief No error where both or none of plane and file are given. */
  Error parse() const;
};

/** \brief Cuts both objects, A where its motion takes it, and writes their outlines as SVG. Nothing
 * without a plane. \return an error where the plane meets neither. */
Error writeSection(const SectionRequest& request, const Comparison& comparison,
                   const ComparisonJob& job, const std::string& unit, const ComparedInput& a,
                   const ComparedInput& b, Console& console, Report& report);

}  // namespace pcl_slim
