// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim {

/** \brief Colour of a surfel: a polynomial of this degree over its (u, v) plane, in units of its
 * radius, for each of red, green and blue. */
constexpr int kColorDegree = 2;
constexpr int kColorTerms = numCoefficients(kColorDegree);
/** Terms in the order of evaluateHeight(), three bytes each: the first red, green, blue; the others
 * signed, in steps of kColorStep. */
constexpr std::size_t kColorBytes = 3 * static_cast<std::size_t>(kColorTerms);
constexpr float kColorStep = 2.0f;  ///< [1/255 of white]: terms of up to 254 fit into a signed byte

/** \brief Red, green and blue of each term, 0..255 being the range of colours. */
using ColorPolynomial = std::array<std::array<float, 3>, static_cast<std::size_t>(kColorTerms)>;

/** \brief Rounds a polynomial to kColorBytes bytes; terms out of range are clamped. */
PCL_SLIM_EXPORT void encodeColor(const ColorPolynomial& color, std::uint8_t* bytes);

/** \brief The polynomial in kColorBytes bytes. */
PCL_SLIM_EXPORT ColorPolynomial decodeColor(const std::uint8_t* bytes);

/** \brief Rewrites a colour for the frame of the opposite normal, in which v is reversed. */
PCL_SLIM_EXPORT void flipColor(std::uint8_t* bytes);

}  // namespace pcl_slim
