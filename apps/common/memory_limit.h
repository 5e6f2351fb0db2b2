// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/options.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Adds -max_memory, in 2^20 bytes; 0, the default, is no limit. */
void
declareMemoryLimit(OptionTable& options, std::uint64_t* megabytes);

/** \brief Limits the memory of this process from here on: an allocation beyond the limit fails, and
 * guarded() reports it. 0: no limit. Linux only; elsewhere only checkMemory() enforces the limit.
 * \return an error where the program itself takes more. */
Error
limitMemory(std::uint64_t megabytes);

/** \brief Refuses work that would take it beyond the limit set. \param[in] bytes a lower bound of what
 * the work will take on top; \param[in] what needs it, as in "fitting 5000000 points";
 * \param[in] relief what else helps than a higher limit. */
Error
checkMemory(double bytes, const std::string& what, const std::string& relief = "use fewer points");

/** \brief Bytes that the limit leaves; without one, most of what the machine has free. */
double
memoryLeft();

/** \brief " within -max_memory 500", or nothing where there is no limit. */
std::string
memoryLimitText();

}  // namespace pcl_slim
