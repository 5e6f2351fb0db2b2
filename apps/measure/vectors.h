// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"

namespace pcl_slim::measure {

/** \brief Limits all kernels to one instruction set, such as "AVX2"; "best" lifts no limit.
 * \return an error that names those of this processor, if it is none of them. */
Error
chooseVectors(const std::string& name);

}  // namespace pcl_slim::measure
