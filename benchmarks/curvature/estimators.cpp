// SPDX-License-Identifier: BSD-3-Clause
#include "curvature/estimators.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>

#include "rivals/jets.h"

namespace pcl_slim::curvature {

namespace {

using Point = Eigen::Vector3d;

Point pointOf(const Vector3& v) {
  return {v[0], v[1], v[2]};
}

Vector3 vectorOf(const Point& p) {
  return {p[0], p[1], p[2]};
}

double weightAt(const Point& offset, double radius) {
  const double t = 1 - offset.squaredNorm() / (radius * radius);
  return t > 0 ? t * t : 0;
}

/** Axes of the weighted covariance about the first point's neighbourhood, the normal last. */
Eigen::Matrix3d pcaFrame(const std::vector<Vector3>& points, double radius) {
  Point sum = Point::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double total = 0;
  for (const Vector3& p : points) {
    const Point d = pointOf(p) - pointOf(points.front());
    const double w = weightAt(d, radius);
    total += w;
    sum += w * d;
    moments += w * d * d.transpose();
  }
  moments -= sum * sum.transpose() / total;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments);
  Eigen::Matrix3d frame;
  frame << axes.eigenvectors().col(2), axes.eigenvectors().col(1), axes.eigenvectors().col(0);
  return frame;
}

Differential quadric(const Neighborhood& near) {
  const Eigen::Matrix3d frame = pcaFrame(near.points, near.radius);
  const auto count = static_cast<Eigen::Index>(near.points.size());
  Eigen::MatrixXd rows(count, 6);
  Eigen::VectorXd heights(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point d = pointOf(near.points[static_cast<std::size_t>(i)]) - pointOf(near.points[0]);
    const Point q = frame.transpose() * d;
    const double w = std::sqrt(weightAt(d, near.radius));
    rows.row(i) << w, w * q[0], w * q[1], w * q[0] * q[0], w * q[0] * q[1], w * q[1] * q[1];
    heights[i] = w * q[2];
  }
  const Eigen::VectorXd c = rows.colPivHouseholderQr().solve(heights);
  const double hu = c[1], hv = c[2], root = 1 + hu * hu + hv * hv;
  const double mean =
      -((1 + hv * hv) * c[3] - hu * hv * c[4] + (1 + hu * hu) * c[5]) / (root * std::sqrt(root));
  const Point normal = frame * Point(-hu, -hv, 1).normalized();
  return {vectorOf(normal), mean, (4 * c[3] * c[5] - c[4] * c[4]) / (root * root)};
}

Estimator jets(std::size_t degree) {
  return {"jets " + std::to_string(degree), false, [degree](const Neighborhood& near) {
            const rivals::Monge monge = rivals::mongeByJets(near.points, degree);
            return Differential{monge.normal, -(monge.k1 + monge.k2) / 2, monge.k1 * monge.k2};
          }};
}

/** Normals as linear functions over the tangent plane of their mean. */
Differential normalSlopes(const Neighborhood& near) {
  Point mean = Point::Zero();
  for (std::size_t i = 0; i < near.points.size(); ++i) {
    mean += weightAt(pointOf(near.points[i]) - pointOf(near.points[0]), near.radius) *
            pointOf(near.normals[i]);
  }
  mean.normalize();
  const Point u = mean.unitOrthogonal(), v = mean.cross(u);
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < near.points.size(); ++i) {
    const Point d = pointOf(near.points[i]) - pointOf(near.points[0]), n = pointOf(near.normals[i]);
    const double w = weightAt(d, near.radius);
    const Point row(1, d.dot(u), d.dot(v));
    normal_matrix += w * row * row.transpose();
    right += w * row * Eigen::RowVector2d(n.dot(u), n.dot(v));
  }
  const Eigen::Matrix<double, 3, 2> slopes = normal_matrix.ldlt().solve(right);
  const double uu = slopes(1, 0), uv = (slopes(1, 1) + slopes(2, 0)) / 2, vv = slopes(2, 1);
  return {vectorOf(mean), (uu + vv) / 2, uu * vv - uv * uv};
}

/** Ratios of the measures that random triangles of neighbours have. */
Differential correctedCurrents(const Neighborhood& near) {
  constexpr int kTriangles = 200;
  std::mt19937_64 rng(near.points.size());
  std::uniform_int_distribution<std::size_t> any(0, near.points.size() - 1);
  double area = 0, mean = 0, gaussian = 0;
  Point normal = Point::Zero();
  for (int t = 0; t < kTriangles; ++t) {
    std::size_t corner[3] = {any(rng), any(rng), any(rng)};
    Point x[3], n[3], sum = Point::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = pointOf(near.points[corner[k]]) - pointOf(near.points[0]);
      n[k] = pointOf(near.normals[corner[k]]);
      sum += n[k];
    }
    sum /= 3;
    const double measure = sum.dot((x[1] - x[0]).cross(x[2] - x[0])) / 2;
    const double side = measure < 0 ? -1 : 1;
    area += side * measure;
    mean +=
        side / 2 *
        sum.dot((n[2] - n[1]).cross(x[0]) + (n[0] - n[2]).cross(x[1]) + (n[1] - n[0]).cross(x[2]));
    gaussian += side / 2 * n[0].dot(n[1].cross(n[2]));
    normal += sum;
  }
  return {vectorOf(normal.normalized()), mean / (2 * area), gaussian / area};
}

/** Unit gradient, at a place, of the algebraic sphere fitted to points and normals about it. */
Point sphereNormal(const Neighborhood& near, const Point& at, double& value) {
  double w_sum = 0, pn = 0, pp = 0;
  Point p_sum = Point::Zero(), n_sum = Point::Zero();
  for (std::size_t i = 0; i < near.points.size(); ++i) {
    const Point p = pointOf(near.points[i]) - at, n = pointOf(near.normals[i]);
    const double w = weightAt(p, near.radius);
    w_sum += w;
    p_sum += w * p;
    n_sum += w * n;
    pn += w * p.dot(n);
    pp += w * p.squaredNorm();
  }
  const double quadratic = (pn - p_sum.dot(n_sum) / w_sum) / (pp - p_sum.squaredNorm() / w_sum) / 2;
  const Point linear = (n_sum - 2 * quadratic * p_sum) / w_sum;
  value = -(linear.dot(p_sum) + quadratic * pp) / w_sum / linear.norm();
  return linear.normalized();
}

Differential algebraicShape(const Neighborhood& near) {
  constexpr int kProjections = 5;
  constexpr double kStep = 0.02;  // [radii]
  Point at = pointOf(near.points[0]);
  double value = 0, unused = 0;
  for (int i = 0; i < kProjections; ++i) {
    const Point n = sphereNormal(near, at, value);
    at -= value * n;
  }
  const Point n = sphereNormal(near, at, value);
  const Point axes[2] = {n.unitOrthogonal(), n.cross(n.unitOrthogonal())};
  Eigen::Matrix2d shape;
  const double h = kStep * near.radius;
  for (int k = 0; k < 2; ++k) {
    const Point slope = (sphereNormal(near, at + h * axes[k], unused) -
                         sphereNormal(near, at - h * axes[k], unused)) /
                        (2 * h);
    shape(0, k) = slope.dot(axes[0]);
    shape(1, k) = slope.dot(axes[1]);
  }
  return {vectorOf(n), shape.trace() / 2, shape.determinant()};
}

}  // namespace

Vector3 pcaNormal(const std::vector<Vector3>& points, double radius) {
  return vectorOf(pcaFrame(points, radius).col(2));
}

std::vector<Estimator> allEstimators() {
  std::vector<Estimator> all = {{"quadric", false, quadric}};
  if (rivals::hasJets()) {
    all.push_back(jets(2));
    all.push_back(jets(4));
  }
  all.push_back({"shape operator", true, normalSlopes});
  all.push_back({"CNC", true, correctedCurrents});
  all.push_back({"ASO", true, algebraicShape});
  return all;
}

}  // namespace pcl_slim::curvature
