// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "feet/patches.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief A place on the blended surface, local units. */
struct SurfaceFoot {
  bool found = false;   ///< false: no leaf is within the largest distance
  bool border = false;  ///< on or beyond the border; position and normal are about there
  Vector3 position{};
  Vector3 normal{};     ///< unit
  double distance = 0;  ///< signed along the normal
  double sigma = 0;     ///< standard error of the position along the normal
};

/** \brief The nearest place of a surface, and the nearest that faces as a side does. */
struct SidedFeet {
  SurfaceFoot foot;   ///< of the side, if there is one
  bool faces = true;  ///< whether the nearest place of all faces the side; then it is the foot
  PatchFoot nearest;  ///< the nearest place of all, if it does not
};

/** \brief What to search feet of: up to 16 places near each other, local units. */
struct FeetRequest {
  static constexpr std::size_t kMost = SurfaceProbe::kMost;

  std::size_t count = 0;
  std::array<Vector3, kMost> places;
  std::array<Vector3, kMost> sides;  ///< zero: the place has none
  double max_distance = Bounds::kInfinity;
};

/** \brief A surface whose feet are searched: patches to find the nearest one, and leaves to blend. */
struct FootIndex {
  FootIndex(const SLIMSurface& surface, int threads)
      : patches(surface, threads), probe(surface, ProbeUse::kExtraction, true, threads) {}

  PatchIndex patches;
  ProbeIndex probe;
};

/** \brief Finds feet; one object a thread. The nearest patch gives the start; the foot on the blended
 * surface is where what remains to the place is along the normal: Newton steps in the tangent plane,
 * with the curvature of the surface, shortened where the distance would grow. A
 * foot does not count where no leaf covers it, as where a polynomial leaves its points beside a sharp
 * edge, nor where it faces away from the side: the search is repeated without the patch that led to
 * it. */
class FootFinder {
 public:
  explicit FootFinder(const FootIndex& index) : index_(index), probe_(index.probe) {}

  /** \brief Forgets what earlier requests found, so that results depend on those that follow alone.
   */
  void restart();
  /** \brief \param[out] feet one a place. O(log leaves) a place near the surface. */
  void find(const FeetRequest& request, std::array<SidedFeet, FeetRequest::kMost>& feet);

 private:
  /** A place on its way to its foot. */
  struct Walk {
    std::size_t place;
    std::uint32_t patch;  ///< where it began
    Vector3 at, side;
    double radius;   ///< of the leaf where it began
    bool stands;     ///< last is valid
    bool at_end;     ///< the last step left the leaves
    bool converged;  ///< what remains to the place is along the normal
    bool done;
    ProbeSample last;  ///< nearest so far
    double distance_sq;
    Vector3 step;  ///< from last to at
  };
  struct Start {
    std::uint32_t patch;
    PatchFoot foot;
  };

  /** What is to be found for a place, and the patches from which it was not. */
  struct Search {
    static constexpr std::size_t kMost = 2;

    bool pending, sided;
    std::array<std::uint32_t, kMost> excluded;
    std::size_t num_excluded;
  };

  Start nearest(const Vector3& place, const Vector3* side, double most, std::uint32_t hint,
                const Search& search) const;
  bool start(const FeetRequest& request, std::size_t i, SidedFeet& found);
  bool accept(const FeetRequest& request, const Walk& walk, const SurfaceFoot& foot);
  void walk(const FeetRequest& request);
  void evaluate(const FeetRequest& request, Walk* const* group, std::size_t count, bool curved);
  void advance(const Vector3& place, const ProbeSample& sample, bool curved, Walk& walk) const;
  static SurfaceFoot footOf(const Vector3& place, const Walk& walk);

  const FootIndex& index_;
  SurfaceProbe probe_;
  std::uint32_t hint_ = 0, side_hint_ = 0;  ///< patches of the feet before
  std::array<Search, FeetRequest::kMost> searches_;
  std::array<Walk, FeetRequest::kMost> walks_;
  std::size_t num_walks_ = 0;
};

}  // namespace pcl_slim::detail
