// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "trim/bit_rows.h"

namespace pcl_slim::detail {

/** \brief Sets the bits that one or the other has. */
void
uniteRows(const BitRows& one, const BitRows& other, BitRows& united);

/** \brief Sets every bit within a distance of a set one. O(distance * words).
 * \param[in] reach in cells \param scratch of the caller's, to keep its memory */
void
spreadByDisc(const BitRows& rows, double reach, BitRows& scratch, BitRows& spread);

/** \brief Turns every bit over. \return whether any is set then. */
bool
complement(BitRows& rows);

}  // namespace pcl_slim::detail
