// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim {

/** Reads a number written in decimals, "nan" or "inf". \param[in,out] in_float cleared where a float
 * does not hold every digit written. false: it is no number. */
bool
parseDecimal(const char* begin, const char* end, double& value, bool& in_float);

}  // namespace pcl_slim
