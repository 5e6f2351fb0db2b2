// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Round numbers inside a range, for the scale of a colour bar.
 *
 * On a linear scale they are the multiples of a step, which is 1, 2 or 5 times a power of ten; on a
 * logarithmic one powers of ten, or 1 and 5, or 1, 2 and 5 times these. A logarithmic range too
 * short for three of those gets linear ones.
 * \param[in] low, high ends, in any order; both positive on a logarithmic scale
 * \return 3 to 6 numbers, rising; 7 where the next wider step leaves but two. One, the range's lower end,
 * where its ends agree to twelve digits; none where they are not finite or not positive. O(1). */
PCL_SLIM_EXPORT std::vector<double> roundTicks(double low, double high, bool logarithmic);

/** \brief A tick as text: at most twelve significant digits, no needless zeros, "2e6" and "5e-4"
 * for what is 1e5 or more or less than 1e-3. */
PCL_SLIM_EXPORT std::string tickText(double tick);

}  // namespace pcl_slim::detail
