// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/registration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/core/order_statistics.h"
#include "place_order.h"
#include "rigid_motion.h"

namespace pcl_slim {

using namespace detail;

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kLeastPlaces = 6;
constexpr double kHuberLimit = 1.345,
                 kTukeyLimit = 4.685;       // [deviations] 95 % efficient for normal errors
constexpr double kMadToDeviation = 1.4826;  // of a normal distribution
/** Of the standard error of a mode: a step so short ends the iteration. */
constexpr double kConverged = 0.02;

enum class Loss { kHuber, kTukey };

double weightOf(Loss loss, double deviations) {
  const double a = std::abs(deviations);
  if (loss == Loss::kHuber) return a <= kHuberLimit ? 1 : kHuberLimit / a;
  const double t = a / kTukeyLimit;
  return t < 1 ? (1 - t * t) * (1 - t * t) : 0;
}

/** Derivative of the influence deviations * weight. */
double slopeOf(Loss loss, double deviations) {
  const double a = std::abs(deviations);
  if (loss == Loss::kHuber) return a <= kHuberLimit ? 1 : 0;
  const double t = a / kTukeyLimit;
  return t < 1 ? (1 - t * t) * (1 - 5 * t * t) : 0;
}

/** Places that are moved, and what their feet say of the motion that remains. */
struct Moved {
  std::vector<Vector3> start;  ///< as given
  std::vector<std::array<float, 3>> start_normals;
  std::vector<Vector3> positions;  ///< moved
  std::vector<std::array<float, 3>> normals;
  std::vector<ReferenceFoot> feet;
  Vector3 centroid{};   ///< of start
  double gyration = 1;  ///< RMS distance from it
  bool oriented = false;

  DeviationPlaces places() const;
  void move(const RigidMotion& motion);
  Vector6 row(std::size_t i, const Vector3& center) const;
};

DeviationPlaces Moved::places() const {
  DeviationPlaces made;
  made.positions = positions.data();
  made.count = positions.size();
  made.normals = normals.empty() ? nullptr : normals.data();
  made.oriented = oriented;
  return made;
}

void Moved::move(const RigidMotion& motion) {
  for (std::size_t i = 0; i < start.size(); ++i) positions[i] = motion.place(start[i]);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const auto& n = start_normals[i];
    const Vector3 turned = motion.direction({n[0], n[1], n[2]});
    for (std::size_t a = 0; a < 3; ++a) normals[i][a] = static_cast<float>(turned[a]);
  }
}

/** Derivatives of a place's distance by the six numbers; rotations count in lengths moved at the
 * radius of gyration. */
Vector6 Moved::row(std::size_t i, const Vector3& center) const {
  const Vector3& n = feet[i].normal;
  const Vector3 arm = scaled(cross(subtract(positions[i], center), n), 1 / gyration);
  Vector6 x;
  x << n[0], n[1], n[2], arm[0], arm[1], arm[2];
  return x;
}

/** An even choice of the finite places. */
Moved chosenPlaces(const DeviationPlaces& places, std::size_t most, int threads) {
  Moved moved;
  moved.oriented = places.oriented;
  Bounds box;
  for (const std::uint32_t i : evenChoice(places.positions, places.count, most, threads)) {
    moved.start.push_back(places.positions[i]);
    box.add(places.positions[i]);
    if (places.normals) moved.start_normals.push_back(places.normals[i]);
  }
  const std::size_t count = moved.start.size();
  moved.positions = moved.start;
  moved.normals = moved.start_normals;
  if (count == 0) return moved;
  Vector3 sum{};
  for (const Vector3& p : moved.start) sum = along(sum, 1, subtract(p, box.low));
  moved.centroid = along(box.low, 1.0 / static_cast<double>(count), sum);
  double square = 0;
  for (const Vector3& p : moved.start) {
    const Vector3 off = subtract(p, moved.centroid);
    square += dot(off, off);
  }
  moved.gyration = std::sqrt(square / static_cast<double>(count));
  if (!(moved.gyration > 0)) moved.gyration = 1;
  return moved;
}

/** Robust normal equations of all places with a counterpart. */
struct Equations {
  Matrix6 information = Matrix6::Zero();  ///< sum w x x'
  Matrix6 design = Matrix6::Zero();       ///< mean x x' of inliers
  Vector6 right = Vector6::Zero();        ///< sum w x residual
  std::size_t places = 0, inliers = 0;
  double deviation = 0;  ///< 1.4826 MAD of the residuals
  double influence = 0;  ///< mean squared influence over the squared mean slope, in deviation^2
  double weight = 0;     ///< sum w
  double square = 0;     ///< sum w residual^2
};

Equations equationsOf(const Moved& moved, const Vector3& center, Loss loss) {
  Equations e;
  std::vector<double> sizes;
  for (const ReferenceFoot& foot : moved.feet) {
    if (foot.state == FootState::kFound) sizes.push_back(std::abs(foot.distance));
  }
  e.places = sizes.size();
  if (sizes.size() < kLeastPlaces) return e;
  e.deviation = kMadToDeviation * median(std::move(sizes));
  // Exact data: any positive scale makes all weights 1.
  const double scale = e.deviation > 0 ? e.deviation : 1e-12 * moved.gyration;
  double squares = 0, slopes = 0;
  for (std::size_t i = 0; i < moved.feet.size(); ++i) {
    const ReferenceFoot& foot = moved.feet[i];
    if (foot.state != FootState::kFound) continue;
    const double deviations = foot.distance / scale, w = weightOf(loss, deviations);
    squares += deviations * w * deviations * w;
    slopes += slopeOf(loss, deviations);
    if (!(w > 0)) continue;
    const Vector6 x = moved.row(i, center);
    e.information += w * x * x.transpose();
    e.right += w * foot.distance * x;
    e.weight += w;
    e.square += w * foot.distance * foot.distance;
    if (w <= 0.5) continue;
    ++e.inliers;
    e.design += x * x.transpose();
  }
  const auto n = static_cast<double>(e.places);
  if (e.inliers > 0) e.design /= static_cast<double>(e.inliers);
  const double slope = std::max(slopes / n, 1e-3);
  e.influence = scale * scale * (squares / std::max(n - 6, 1.0)) / (slope * slope);
  return e;
}

/** The motions that the equations determine, independent of each other, best first. */
struct Modes {
  Matrix6 axes;                   ///< columns
  std::array<double, 6> slope{};  ///< RMS change of distance of inliers
  int rank = 0;
};

Modes modesOf(const Equations& e, double least_slope) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(e.design);
  Modes modes;
  for (int k = 0; k < 6; ++k) {
    modes.axes.col(k) = solver.eigenvectors().col(5 - k);
    const auto at = static_cast<std::size_t>(k);
    modes.slope[at] = std::sqrt(std::max(0.0, solver.eigenvalues()[5 - k]));
    if (modes.slope[at] > least_slope) ++modes.rank;
  }
  return modes;
}

/** The step that reduces the residuals, in the determined modes. */
Vector6 stepOf(const Equations& e, const Modes& modes) {
  const auto axes = modes.axes.leftCols(modes.rank);
  const Eigen::MatrixXd reduced = axes.transpose() * e.information * axes;
  return -(axes * reduced.ldlt().solve(axes.transpose() * e.right));
}

RigidMotion motionOf(const Vector6& step, const Vector3& center, double gyration) {
  return rigidMotion({step[0], step[1], step[2]},
                     {step[3] / gyration, step[4] / gyration, step[5] / gyration}, center);
}

/** Fills in the covariance of the determined modes, the errors of the six numbers and the modes. */
void setErrors(const Equations& e, const Modes& modes, double gyration, double per_independent,
               Registration& made) {
  Vector6 numbers;
  numbers << made.translation[0], made.translation[1], made.translation[2],
      gyration * made.rotation[0], gyration * made.rotation[1], gyration * made.rotation[2];
  Matrix6 covariance = Matrix6::Zero();
  const double factor = e.influence * per_independent / static_cast<double>(e.places);
  for (int k = 0; k < modes.rank; ++k) {
    const double slope = modes.slope[static_cast<std::size_t>(k)];
    const Vector6 axis = modes.axes.col(k);
    covariance += factor / (slope * slope) * axis * axis.transpose();
  }
  const Vector6 units = (Vector6() << 1, 1, 1, 1 / gyration, 1 / gyration, 1 / gyration).finished();
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) {
      made.covariance[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] =
          covariance(a, b) * units[a] * units[b];
    }
    // The share of this number's direction that nothing determines.
    const double open = modes.axes.row(a).rightCols(6 - modes.rank).norm();
    constexpr double kLeastOpen = 0.02;
    const double error =
        open > kLeastOpen ? Bounds::kInfinity : std::sqrt(covariance(a, a)) * units[a];
    (a < 3 ? made.translation_error : made.rotation_error)[static_cast<std::size_t>(a % 3)] = error;
  }
  made.rank = modes.rank;
  for (int k = 0; k < 6; ++k) {
    const Vector6 axis = modes.axes.col(k);
    RegistrationMode& mode = made.modes[static_cast<std::size_t>(k)];
    mode.translation = {axis[0], axis[1], axis[2]};
    mode.rotation = {axis[3] / gyration, axis[4] / gyration, axis[5] / gyration};
    mode.slope = modes.slope[static_cast<std::size_t>(k)];
    mode.determined = k < modes.rank;
    mode.value = mode.determined ? axis.dot(numbers) : 0;
    mode.error = mode.determined ? std::sqrt(axis.dot(covariance * axis)) : Bounds::kInfinity;
  }
}

/** Weighted RMS distance from the reference. */
double rmsOf(const Equations& e) {
  return e.weight > 0 ? std::sqrt(e.square / e.weight) : 0;
}

}  // namespace

Error RegistrationParams::validate() const {
  if (Error error = feet.validate()) return error;
  if (most_places < kLeastPlaces) {
    return {ErrorCode::kBadArgument, "a registration needs 6 places at least: raise most_places"};
  }
  if (most_iterations < 1) {
    return {ErrorCode::kBadArgument, "there is no iteration: set most_iterations to 1 or more"};
  }
  if (!(effective_count >= 0) || !(least_slope >= 0 && least_slope < 1)) {
    return {ErrorCode::kBadArgument,
            "effective_count is negative or least_slope is outside [0, 1): correct them"};
  }
  return {};
}

Result<Registration> registerPlaces(const DeviationReference& reference,
                                    const DeviationPlaces& places, const RegistrationParams& params,
                                    Progress* progress) {
  if (Error error = params.validate()) return error;
  Moved moved = chosenPlaces(places, params.most_places, params.feet.threads);
  Registration made;
  RigidMotion motion;
  motion.center = moved.centroid;
  Loss loss = Loss::kHuber;
  Equations equations;
  Modes modes;
  for (int iteration = 0;; ++iteration) {
    if (Error error = reference.find(moved.places(), params.feet, moved.feet, progress)) {
      return error;
    }
    const Vector3 center = along(moved.centroid, 1, motion.translation);
    equations = equationsOf(moved, center, loss);
    if (equations.places < kLeastPlaces) {
      return badInput("only " + std::to_string(equations.places) +
                      " places have a counterpart on the reference, too few to align them: bring "
                      "both into the same coordinates first, or raise the largest distance");
    }
    if (iteration == 0) made.rms_before = rmsOf(equations);
    modes = modesOf(equations, params.least_slope);
    if (made.converged || iteration >= params.most_iterations || modes.rank == 0) break;
    const Vector6 step = stepOf(equations, modes);
    motion = composed(motionOf(step, center, moved.gyration), motion);
    moved.move(motion);
    ++made.iterations;
    const double error = std::sqrt(equations.influence / static_cast<double>(equations.places));
    const bool small = step.norm() <= kConverged * error + 1e-12 * moved.gyration;
    if (!small) continue;
    if (loss == Loss::kTukey) made.converged = true;
    loss = Loss::kTukey;
  }
  made.motion = motion;
  made.translation = motion.translation;
  made.rotation = rotationVector(motion);
  made.places = equations.places;
  made.inliers = equations.inliers;
  made.noise = equations.deviation;
  made.rms_after = rmsOf(equations);
  const double per_independent =
      params.effective_count > 0
          ? std::max(1.0, static_cast<double>(places.count) / params.effective_count)
          : 1.0;
  setErrors(equations, modes, moved.gyration, per_independent, made);
  return made;
}

double Registration::errorAt(const Vector3& place, const Vector3& direction) const {
  const Vector3 arm = cross(subtract(place, motion.center), direction);
  const std::array<double, 6> x = {direction[0], direction[1], direction[2],
                                   arm[0],       arm[1],       arm[2]};
  double variance = 0;
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = 0; b < 6; ++b) variance += x[a] * covariance[a][b] * x[b];
  }
  return std::sqrt(std::max(0.0, variance));
}

}  // namespace pcl_slim
