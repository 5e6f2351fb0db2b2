// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"

namespace pcl_slim {

/** \brief A program as the command pcl_slim starts it. */
struct ProgramEntry {
  const char *command, *name, *summary;
  const char* needs;  ///< what it is not built without, or an empty text
};

/** \brief All programs, in the order in which they are listed. */
const std::vector<ProgramEntry>& programs();

/** \brief The empty table of a program's arguments, with its summary and the version. */
OptionTable programOptions(const std::string& name);

}  // namespace pcl_slim
