// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace pcl_slim {

/** \brief Places of the six entries that a symmetric 3x3 matrix has: row by row, from the diagonal
 * on. Every Hessian and every matrix of second moments is stored in this order. */
enum SymmetricEntry : std::size_t { kXX, kXY, kXZ, kYY, kYZ, kZZ };

/** \brief A symmetric 3x3 matrix: xx xy xz yy yz zz. */
template <typename T>
using Symmetric3 = std::array<T, 6>;

/** \brief The place of entry (row, column). */
inline constexpr SymmetricEntry kSymmetricEntry[3][3] = {
    {kXX, kXY, kXZ}, {kXY, kYY, kYZ}, {kXZ, kYZ, kZZ}};

/** \brief The product of a symmetric matrix and a vector. */
template <typename T>
std::array<T, 3> multiplied(const Symmetric3<T>& m, const std::array<T, 3>& v) {
  return {m[kXX] * v[0] + m[kXY] * v[1] + m[kXZ] * v[2],
          m[kXY] * v[0] + m[kYY] * v[1] + m[kYZ] * v[2],
          m[kXZ] * v[0] + m[kYZ] * v[1] + m[kZZ] * v[2]};
}

}  // namespace pcl_slim
