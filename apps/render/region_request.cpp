// SPDX-License-Identifier: BSD-3-Clause
#include "render/region_request.h"

#include <algorithm>
#include <cmath>

#include "common/options.h"

namespace pcl_slim {
namespace {

using Corner = std::array<double, 3>;

Corner
placeOf(const BoundingSpheres& object, const BoundingSphere& sphere)
{
  Corner place;
  for (std::size_t a = 0; a < 3; ++a) {
    place[a] = object.origin[a] + object.scale * double{sphere.center[a]};
  }
  return place;
}

bool
holds(const std::vector<HalfSpace>& sides, const Corner& place)
{
  return std::all_of(sides.begin(), sides.end(), [&](const HalfSpace& side) {
    return side.normal[0] * place[0] + side.normal[1] * place[1] + side.normal[2] * place[2] >=
           side.offset;
  });
}

/** \brief x0, x1, y0, y1, z0, z1 of an object's centres. */
std::array<double, 6>
boundsOf(const BoundingSpheres& object)
{
  std::array<double, 6> bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    bounds[2 * a] = HUGE_VAL;
    bounds[2 * a + 1] = -HUGE_VAL;
  }
  for (const BoundingSphere& sphere : object.spheres) {
    const Corner place = placeOf(object, sphere);
    for (std::size_t a = 0; a < 3; ++a) {
      bounds[2 * a] = std::min(bounds[2 * a], place[a]);
      bounds[2 * a + 1] = std::max(bounds[2 * a + 1], place[a]);
    }
  }
  return bounds;
}

}  // namespace

void
RegionRequest::declare(OptionTable& table)
{
  table.text("region", &text, "all|X0,Y0,Z0,X1,Y1,Z1",
             "draw only what lies between two corners, world coordinates");
}

Error
RegionRequest::parse()
{
  if (text == "all") return {};
  std::vector<double> values;
  const bool read = parseNumberList(text, values) && values.size() == 6;
  for (std::size_t a = 0; read && a < 3; ++a) {
    Corner axis{};
    axis[a] = 1.0;
    sides.push_back({axis, values[a]});
    axis[a] = -1.0;
    sides.push_back({axis, -values[a + 3]});
  }
  const auto below = [&](std::size_t a) { return values[a] < values[a + 3]; };
  if (read && below(0) && below(1) && below(2)) return {};
  return {ErrorCode::kBadArgument,
          "-region takes the lowest and the highest corner of a box, X0,Y0,Z0,X1,Y1,Z1 with X0 < "
          "X1, Y0 < Y1 and Z0 < Z1, not '" +
              text + "'"};
}

std::array<double, 6>
RegionRequest::bounds(const BoundingSpheres& object) const
{
  if (sides.empty()) return boundsOf(object);
  std::array<double, 6> bounds;
  for (std::size_t k = 0; k < 6; ++k) bounds[k] = k % 2 == 0 ? sides[k].offset : -sides[k].offset;
  return bounds;
}

WorldBox
RegionRequest::box() const
{
  WorldBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box[0][a] = sides[2 * a].offset;
    box[1][a] = -sides[2 * a + 1].offset;
  }
  return box;
}

Result<BoundingSpheres>
RegionRequest::within(const BoundingSpheres& object, const WorldBox* whole) const
{
  if (sides.empty()) return object;
  BoundingSpheres part = object;
  part.spheres.clear();
  for (const BoundingSphere& sphere : object.spheres) {
    if (holds(sides, placeOf(object, sphere))) part.spheres.push_back(sphere);
  }
  if (!part.spheres.empty()) return part;
  std::array<double, 6> b = boundsOf(object);
  for (std::size_t a = 0; a < 3 && whole != nullptr; ++a) {
    b[2 * a] = (*whole)[0][a];
    b[2 * a + 1] = (*whole)[1][a];
  }
  std::string corners;
  for (const std::size_t k : {0u, 2u, 4u, 1u, 3u, 5u}) {
    corners += (corners.empty() ? "" : ",") + numberText(b[k], 9);
  }
  return Error{ErrorCode::kBadArgument,
               "nothing lies in -region " + text + "; give a part of " + corners};
}

}  // namespace pcl_slim
