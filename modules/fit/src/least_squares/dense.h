// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace pcl_slim::detail {

/** \brief X of the least |A X - B|, by QR with column pivoting.
 * Not for inner loops: the matrices are allocated. Compiled in one place, as Eigen's decompositions
 * take seconds to compile for each type of matrix. O(rows cols^2). */
Eigen::MatrixXd solveLeastSquares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace pcl_slim::detail
