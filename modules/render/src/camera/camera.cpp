// SPDX-License-Identifier: BSD-3-Clause
// Cameras that frame an object: its bulk without strays, perspective and parallel fits, and turns
// about an axis.
#include "pcl_slim/render/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "camera/camera_rays.h"
#include "camera/sphere_cloud.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/turning.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr int kCells = 64;            ///< along the longest extent
constexpr double kLeastPiece = 0.01;  ///< share of the points
constexpr double kRim = 0.05;         ///< share of the points beyond either end of the bulk ...
constexpr double kSlack = 0.5;        ///< [extent of the bulk] added at either end

using Interval = std::array<double, 2>;

double pointsOf(const std::vector<BoundingSphere>& spheres) {
  double points = 0.0;
  for (const BoundingSphere& sphere : spheres) points += sphere.points;
  return points;
}

/** \brief Per axis, the interval of centres that counts. */
std::array<Interval, 3> framedExtent(const std::vector<BoundingSphere>& spheres) {
  std::array<Interval, 3> extent;
  std::vector<std::pair<float, float>> values(spheres.size());  // coordinate, points
  const double rim = kRim * pointsOf(spheres);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < spheres.size(); ++i)
      values[i] = {spheres[i].center[a], spheres[i].points};
    std::sort(values.begin(), values.end());
    const auto inner = [rim](auto at) {
      for (double beyond = at->second; beyond < rim; beyond += at->second) ++at;
      return static_cast<double>(at->first);
    };
    const double low = inner(values.begin()), high = inner(values.rbegin());
    const double slack = kSlack * (high - low) + 1e-3;
    extent[a] = {low - slack, high + slack};
  }
  return extent;
}

std::vector<BoundingSphere> withinExtent(const std::vector<BoundingSphere>& spheres) {
  std::vector<BoundingSphere> inside;
  const auto extent = framedExtent(spheres);
  std::copy_if(spheres.begin(), spheres.end(), std::back_inserter(inside), [&](const auto& sphere) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (sphere.center[a] < extent[a][0] || sphere.center[a] > extent[a][1]) return false;
    }
    return true;
  });
  return inside;
}

/** \brief A grid over the centres, for the connected components of spheres. */
class PieceGrid {
 public:
  explicit PieceGrid(const std::vector<BoundingSphere>& spheres);

  /** \brief Points of the piece that a sphere belongs to. */
  double pointsAround(const BoundingSphere& sphere) const {
    return points_[piece_[indexOf(cellsOf(sphere, 0.0f)[0])]];
  }

 private:
  using Cell = std::array<int, 3>;

  /** \brief Lowest and highest cell that a share of a sphere's box touches. */
  std::array<Cell, 2> cellsOf(const BoundingSphere& sphere, float share) const;
  static std::size_t indexOf(const Cell& c) {
    return static_cast<std::size_t>((c[2] * kCells + c[1]) * kCells + c[0]);
  }
  template <typename Visit>
  static void forCells(const Cell& low, const Cell& high, const Visit& visit);
  void setPlace(const std::vector<BoundingSphere>& spheres);
  void fill(std::size_t start);

  std::array<float, 3> low_{};
  float cell_ = 1.0f;
  std::vector<std::uint32_t> piece_;  ///< of each cell; 0: nothing, 1: not yet numbered
  std::vector<double> points_;        ///< of each piece
};

PieceGrid::PieceGrid(const std::vector<BoundingSphere>& spheres)
    : piece_(std::size_t{kCells} * kCells * kCells, 0), points_(2, 0.0) {
  setPlace(spheres);
  for (const BoundingSphere& sphere : spheres) {
    const auto [low, high] = cellsOf(sphere, 0.5f);
    forCells(low, high, [this](std::size_t cell) { piece_[cell] = 1; });
  }
  for (std::size_t cell = 0; cell < piece_.size(); ++cell) {
    if (piece_[cell] == 1) fill(cell);
  }
  for (const BoundingSphere& sphere : spheres) {
    points_[piece_[indexOf(cellsOf(sphere, 0.0f)[0])]] += sphere.points;
  }
}

/** \brief Places the grid over all centres. */
void PieceGrid::setPlace(const std::vector<BoundingSphere>& spheres) {
  float longest = 0.0f;
  for (std::size_t a = 0; a < 3; ++a) {
    float high = low_[a] = spheres.front().center[a];
    for (const BoundingSphere& sphere : spheres) {
      low_[a] = std::min(low_[a], sphere.center[a]);
      high = std::max(high, sphere.center[a]);
    }
    longest = std::max(longest, high - low_[a]);
  }
  if (longest > 0.0f) cell_ = longest / (kCells - 1);
}

std::array<PieceGrid::Cell, 2> PieceGrid::cellsOf(const BoundingSphere& sphere, float share) const {
  std::array<Cell, 2> cells{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float center = sphere.center[a] - low_[a], reach = share * sphere.radius;
    const auto cellAt = [this](float x) {
      return static_cast<int>(std::clamp(x / cell_, 0.0f, kCells - 1.0f));
    };
    cells[0][a] = cellAt(center - reach);
    cells[1][a] = cellAt(center + reach);
  }
  return cells;
}

template <typename Visit>
void PieceGrid::forCells(const Cell& low, const Cell& high, const Visit& visit) {
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) visit(indexOf({x, y, z}));
    }
  }
}

/** \brief Numbers a cell and all that touch it, at corners as well. */
void PieceGrid::fill(std::size_t start) {
  const auto number = static_cast<std::uint32_t>(points_.size());
  points_.push_back(0.0);
  std::vector<std::size_t> open{start};
  piece_[start] = number;
  while (!open.empty()) {
    const auto at = static_cast<int>(open.back());
    open.pop_back();
    const Cell c{at % kCells, at / kCells % kCells, at / kCells / kCells};
    Cell low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(0, c[a] - 1);
      high[a] = std::min(kCells - 1, c[a] + 1);
    }
    forCells(low, high, [&](std::size_t cell) {
      if (piece_[cell] != 1) return;
      piece_[cell] = number;
      open.push_back(cell);
    });
  }
}

/** \brief The spheres a view of the whole object has to show, without strays.
 *
 * Left out are centres beyond a whole extent past the 1st and 99th percentile, then pieces that
 * have less than 1 % of the area (by r^2) and are apart: by at least a 64th of the longest extent.
 * O(n). */
std::vector<BoundingSphere> bulkOf(const std::vector<BoundingSphere>& spheres) {
  if (spheres.empty()) return {};
  std::vector<BoundingSphere> inside = withinExtent(spheres);
  if (inside.empty()) return inside;
  const double total = pointsOf(inside);
  const PieceGrid grid(inside);
  std::vector<BoundingSphere> bulk;
  std::copy_if(inside.begin(), inside.end(), std::back_inserter(bulk), [&](const auto& sphere) {
    return grid.pointsAround(sphere) >= kLeastPiece * total;
  });
  return bulk.empty() ? inside : bulk;
}

}  // namespace

std::vector<BoundingSphere> detail::framedSpheres(const BoundingSpheres& object) {
  return object.no_strays ? object.spheres : bulkOf(object.spheres);
}

namespace {

constexpr int kMaxSide = 32768;
constexpr double kFarOrigin = 0x1p40;  ///< beyond it doubles hardly resolve a unit

/** \brief The free area of the picture on the plane at depth 1: its extent to either side. */
struct Opening {
  double left, right, vertical;

  /** \brief A share of the whole, which is as wide as width to height; right_margin is left out. */
  Opening(double half_height, const ImageSize& size, double margin, double right_margin) {
    const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
    vertical = half_height * free;
    left = vertical * size.width / size.height;
    right = left * (1.0 - 2.0 * std::clamp(right_margin, 0.0, 0.4));
  }
};

/** \brief Balls in a frustum with the given openings at depth 1: bounds of x - right z,
 * -x - left z, y - vertical z, -y - vertical z and of z in camera axes. */
struct FrustumFit {
  double max_right = -HUGE_VAL, max_left = -HUGE_VAL, max_up = -HUGE_VAL, max_down = -HUGE_VAL;
  double min_depth = HUGE_VAL;

  /** \param[in] reach share of each radius that is to be seen */
  FrustumFit(const std::vector<BoundingSphere>& spheres, double reach, const CameraAxes& axes,
             const Opening& open) {
    const auto sloped = [reach](double slope) { return reach * std::sqrt(1.0 + slope * slope); };
    const double reach_left = sloped(open.left), reach_right = sloped(open.right),
                 reach_y = sloped(open.vertical);
    for (const BoundingSphere& sphere : spheres) {
      const Vector3 c{sphere.center[0], sphere.center[1], sphere.center[2]};
      const double x = dot(c, axes.right), y = dot(c, axes.up), z = dot(c, axes.forward);
      const double r = sphere.radius;
      max_right = std::max(max_right, x - open.right * z + reach_right * r);
      max_left = std::max(max_left, -x - open.left * z + reach_left * r);
      max_up = std::max(max_up, y - open.vertical * z + reach_y * r);
      max_down = std::max(max_down, -y - open.vertical * z + reach_y * r);
      min_depth = std::min(min_depth, z - r);
    }
  }
};

/** \brief A camera that looks the right way from one world unit off the object's origin. */
Camera startingCamera(const BoundingSpheres& object, const ViewDirection& direction,
                      const ImageSize& size) {
  Camera camera;
  camera.size = size;
  camera.up = direction.up;
  camera.look_at = object.origin;
  double farthest = 0;
  for (const double o : object.origin) farthest = std::max(farthest, std::abs(o));
  const double off = farthest < kFarOrigin ? 1.0 : farthest;  // a unit would be lost out there
  camera.position = along(object.origin, off, normalized(direction.towards_viewer));
  return camera;
}

/** \brief Puts the camera at depth z (local), centred on what fit measured but for a shift to the
 * right. */
void placeCamera(const BoundingSpheres& object, const CameraAxes& axes, const FrustumFit& fit,
                 double z, double shift, Camera& camera) {
  const double x = 0.5 * (fit.max_right - fit.max_left + shift),
               y = 0.5 * (fit.max_up - fit.max_down);
  const Vector3 eye = along(along(scaled(axes.right, x), y, axes.up), z, axes.forward);
  camera.position = along(object.origin, object.scale, eye);
  camera.look_at = along(camera.position, object.scale, axes.forward);
}

}  // namespace

Error Camera::validate() const {
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadArgument, what}; };
  if (size.width < 1 || size.height < 1 || size.width > kMaxSide || size.height > kMaxSide) {
    return bad("the picture's width and height must be 1 to 32768 pixels");
  }
  if (!isFinite(position) || !isFinite(look_at) || !isFinite(up)) {
    return bad("the camera's position, target and up vector must be finite numbers");
  }
  const Vector3 view = subtract(look_at, position);
  if (!(length(view) > 0.0)) return bad("the camera's position and target must differ");
  if (!(length(cross(normalized(view), normalized(up))) > 1e-6)) {
    return bad("the camera's up vector must not be zero or point along the viewing direction");
  }
  if (projection == Projection::kPerspective && !(fov > 0.0 && fov < 180.0)) {
    return bad("the camera's field of view must be between 0 and 180 degrees");
  }
  if (projection == Projection::kOrthographic &&
      !(view_height > 0.0 && std::isfinite(view_height))) {
    return bad("the orthographic view height must be positive");
  }
  return {};
}

bool mayBeSeen(const Camera& camera, const std::array<std::array<double, 3>, 2>& box) {
  constexpr double kFrameShift = 2.0;  // pixels: frames of -aa are shifted
  const CameraAxes axes(camera);
  const bool perspective = camera.projection == Camera::Projection::kPerspective;
  const double half = perspective ? std::tan(camera.fov * M_PI / 360.0) : 0.5 * camera.view_height;
  const double up = half * (1.0 + 2.0 * kFrameShift / camera.size.height);
  const double right = half * (camera.size.width + 2.0 * kFrameShift) / camera.size.height;
  int beyond[5] = {};  // corners behind the eye, and beyond each side of the picture
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Vector3 p{box[corner & 1][0], box[corner >> 1 & 1][1], box[corner >> 2 & 1][2]};
    const Vector3 seen = subtract(p, camera.position);
    const double x = dot(seen, axes.right), y = dot(seen, axes.up), z = dot(seen, axes.forward);
    const double reach = perspective ? z : 1.0;
    const bool out[5] = {z<0.0, x> right * reach, -x > right * reach, y > up * reach,
                         -y > up * reach};
    for (std::size_t k = 0; k < 5; ++k) beyond[k] += out[k];
  }
  return *std::max_element(beyond, beyond + 5) < 8;
}

Camera fitCamera(const BoundingSpheres& object, const ViewDirection& direction,
                 const ImageSize& size, double fov, double margin, double right_margin) {
  Camera camera = startingCamera(object, direction, size);
  camera.fov = fov;
  const std::vector<BoundingSphere> framed = framedSpheres(object);
  if (framed.empty()) return camera;

  const CameraAxes axes(camera);
  const Opening open(std::tan(fov * M_PI / 360.0), size, margin, right_margin);
  const FrustumFit fit(framed, object.seen_radius, axes, open);
  const double z = std::min(-(fit.max_right + fit.max_left) / (open.left + open.right),
                            -0.5 * (fit.max_up + fit.max_down) / open.vertical);
  placeCamera(object, axes, fit, z, (open.right - open.left) * z, camera);
  return camera;
}

Camera fitOrthographicCamera(const BoundingSpheres& object, const ViewDirection& direction,
                             const ImageSize& size, double margin, double right_margin) {
  Camera camera = startingCamera(object, direction, size);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = object.scale;
  const std::vector<BoundingSphere> framed = framedSpheres(object);
  if (framed.empty()) return camera;

  const CameraAxes axes(camera);
  const Opening open(1.0, size, margin, right_margin);
  const FrustumFit fit(framed, object.seen_radius, axes, {0.0, size, margin, right_margin});
  const double width = fit.max_right + fit.max_left, height = fit.max_up + fit.max_down;
  const double half = std::max(0.5 * height / open.vertical, width / (open.left + open.right));
  camera.view_height = std::max(2.0 * half, 1e-9) * object.scale;
  placeCamera(object, axes, fit, fit.min_depth - 2.0 * half, (open.left - open.right) * half,
              camera);
  return camera;
}

namespace {

constexpr double kFullCircle = 2 * M_PI;
constexpr int kLayers = 128;  ///< of the object, along the axis
constexpr int kSides = 32;  ///< spheres on a ring; between two a half percent of its radius is lost

/** \brief An axis and two directions across it, orthonormal. */
struct AxisFrame {
  Vector3 up, right, back;

  explicit AxisFrame(const Vector3& axis) : up(normalized(axis)) {
    const Vector3 other = std::abs(up[0]) < 0.7 ? Vector3{1.0, 0.0, 0.0} : Vector3{0.0, 1.0, 0.0};
    right = normalized(cross(other, up));
    back = cross(up, right);
  }

  /** \brief Coordinates along right, back and up. */
  Vector3 of(const std::array<float, 3>& c) const {
    const Vector3 at{c[0], c[1], c[2]};
    return {dot(at, right), dot(at, back), dot(at, up)};
  }
  Vector3 point(const Vector3& c) const {
    return along(along(scaled(right, c[0]), c[1], back), c[2], up);
  }
};

/** \brief Corners of the centres' box, in the axis' coordinates. */
struct FrameBox {
  Vector3 low, high;

  FrameBox(const std::vector<BoundingSphere>& spheres, const AxisFrame& frame) {
    low = high = frame.of(spheres.front().center);
    for (const BoundingSphere& sphere : spheres) {
      const Vector3 c = frame.of(sphere.center);
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], c[a]);
        high[a] = std::max(high[a], c[a]);
      }
    }
  }
  Vector3 middle() const { return scaled(along(low, 1.0, high), 0.5); }
};

/** \brief The ring that a sphere passes through. */
struct Ring {
  double distance = -1.0;  ///< of the sphere's centre from the axis; below 0: no ring
  double height = 0.0;
  float radius = 0.0f;
};

/** \brief Of each layer across the axis, the ring that reaches farthest out. */
std::vector<Ring> outermostRings(const std::vector<BoundingSphere>& spheres, const AxisFrame& frame,
                                 const FrameBox& box) {
  std::vector<Ring> rings(kLayers);
  const Vector3 middle = box.middle();
  const double extent = std::max(box.high[2] - box.low[2], std::numeric_limits<double>::min());
  for (const BoundingSphere& sphere : spheres) {
    const Vector3 c = subtract(frame.of(sphere.center), middle);
    const double share = (c[2] + middle[2] - box.low[2]) / extent;
    Ring& ring = rings[static_cast<std::size_t>(std::min(kLayers - 1.0, share * kLayers))];
    const double distance = std::hypot(c[0], c[1]);
    if (distance + double{sphere.radius} <= ring.distance + double{ring.radius}) continue;
    ring = {distance, c[2], sphere.radius};
  }
  return rings;
}

void appendRing(const Ring& ring, const AxisFrame& frame, std::vector<BoundingSphere>& spheres) {
  for (int k = 0; k < kSides; ++k) {
    const double angle = kFullCircle * k / kSides;
    const Vector3 outwards = frame.point({std::cos(angle), std::sin(angle), 0.0});
    const Vector3 c = along(scaled(outwards, ring.distance), ring.height, frame.up);
    BoundingSphere sphere{{}, ring.radius, {}};
    for (std::size_t a = 0; a < 3; ++a) {
      sphere.center[a] = static_cast<float>(c[a]);
      sphere.normal[a] = static_cast<float>(outwards[a]);
    }
    spheres.push_back(sphere);
  }
}

/** \brief v turned about a unit axis (Rodrigues). */
Vector3 turned(const Vector3& v, const Vector3& axis, double angle) {
  const Vector3 straight = scaled(axis, dot(axis, v) * (1.0 - std::cos(angle)));
  return along(along(straight, std::cos(angle), v), std::sin(angle), cross(axis, v));
}

}  // namespace

BoundingSpheres sweptAbout(const BoundingSpheres& object, const std::array<double, 3>& axis) {
  const std::vector<BoundingSphere> bulk = bulkOf(object.spheres);
  BoundingSpheres swept = object;
  if (bulk.empty()) return swept;
  const AxisFrame frame(axis);
  const FrameBox box(bulk, frame);
  swept.origin = along(object.origin, object.scale, frame.point(box.middle()));
  swept.no_strays = true;
  swept.spheres.clear();
  for (const Ring& ring : outermostRings(bulk, frame, box)) {
    if (ring.distance >= 0.0) appendRing(ring, frame, swept.spheres);
  }
  return swept;
}

Camera turnedCamera(const Camera& camera, const std::array<double, 3>& pivot,
                    const std::array<double, 3>& axis, int turn, int count) {
  if (turn == 0) return camera;
  const double angle = kFullCircle * turn / count;
  const Vector3 unit = normalized(axis);
  const Vector3 view = turned(subtract(camera.look_at, camera.position), unit, angle);
  Camera moved = camera;
  moved.position = along(pivot, 1.0, turned(subtract(camera.position, pivot), unit, angle));
  moved.look_at = along(moved.position, 1.0, view);
  moved.up = turned(camera.up, unit, angle);
  return moved;
}

}  // namespace pcl_slim
