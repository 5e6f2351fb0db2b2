// SPDX-License-Identifier: BSD-3-Clause
#include "least_squares/dense.h"

#include <Eigen/QR>

namespace pcl_slim::detail {

Eigen::MatrixXd solveLeastSquares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

}  // namespace pcl_slim::detail
