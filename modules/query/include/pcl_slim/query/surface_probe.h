// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/query/standard_errors.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

namespace detail {
struct BlendRules;
struct BlockPoints;
}  // namespace detail

/** \brief What a ProbeIndex is built for. */
enum class ProbeUse : std::uint8_t {
  kSamples,     ///< positions, normals and curvatures
  kExtraction,  ///< distances() as well, and borders: ProbeSample::outside is set
  kSharp,  ///< as kExtraction, of a fit with sharp features: normals of one side agree within 60 degrees
};

/** \brief A surface's leaves, arranged so that those around a place are found fast.
 *
 * Built once in O(M log M), about 150 bytes a leaf; any number of SurfaceProbe objects share it. */
class PCL_SLIM_EXPORT ProbeIndex {
 public:
  /** \brief The surface must outlive this object. \param[in] errors whether requests for standard
   * errors are possible \param[in] threads that prepare them; never changes the result */
  explicit ProbeIndex(const SLIMSurface& surface, ProbeUse use = ProbeUse::kSamples,
                      bool errors = false, int threads = 1);
  ~ProbeIndex();
  ProbeIndex(const ProbeIndex&) = delete;
  ProbeIndex& operator=(const ProbeIndex&) = delete;

  const SLIMSurface& surface() const { return surface_; }
  std::size_t memoryBytes() const;

 private:
  friend class SurfaceProbe;
  struct Leaves;
  const SLIMSurface& surface_;
  std::unique_ptr<Leaves> leaves_;
};

/** \brief The blended surface next to a place, in the surface's local units. */
struct ProbeSample {
  bool supported = false;  ///< false: no leaf covers the place, and nothing else here is valid
  Vector3 position{};      ///< on the surface
  Vector3 normal{};        ///< unit
  PrincipalFrame frame;    ///< k1 and k2; directions and extremalities if requested
  StandardErrors errors;   ///< if requested, local units
  double outside = 0;      ///< blended outsideShare() of the trim maps: the surface ends at 1/2
};

/** \brief Signed distance from a place to the sheet of surface nearest to it. */
struct SheetDistance {
  bool known = false;    ///< false: no leaf's ball contains the foot of the place
  float distance = 0;    ///< local units, positive on the side of normal
  float normal[3] = {};  ///< unit, blended
};

/** \brief How far leaves reach and how many points are behind them at a place, both blended with
 * the leaves' weights, and how well they cover it; 0 where there is none. */
struct ProbeScale {
  double radius = 0;            ///< local units
  double effective_count = 0;   ///< effective number of points
  double equivalent_count = 0;  ///< equivalentCount()
  double filled = 0;            ///< over that of balls without the holes that their trim maps have
  double coverage = 0;  ///< sum of G(d / alpha r): a fit's points have cover_threshold or more
};

/** \brief What to evaluate. */
struct ProbeRequest {
  const Vector3* positions = nullptr;  ///< local units, near the surface
  std::size_t count = 0;               ///< at most SurfaceProbe::kMost
  std::size_t with_directions = 0;     ///< number of the first positions that get directions
  bool extremality = false;            ///< and their extremalities too
  bool curvature = true;               ///< false: positions and normals only
  bool errors = false;                 ///< and standard errors; needs a ProbeIndex with errors
  Vector3 side{};                  ///< leaves that face away from it do not count; zero: all count
  const Vector3* sides = nullptr;  ///< one for each position, in place of side
};

/** \brief Evaluates a surface at any places, as projectPoints() does at stored points: equations
 * (6) to (8) of Ohtake, Belyaev, Alexa 2005 with the same guards, up to sixteen places at a time.
 *
 * Places in one request should be close together, because the leaves of all are evaluated: about 2
 * us for sixteen places within a ball's radius. Leaves found for one request are used for the next
 * ones nearby. One object per thread. The last digits of a result depend on the requests since
 * restart(). Residual gates are never narrower than a tenth of a ball's radius, as places between
 * samples of a clean fit would fall through those that projectPoints() needs for points.
 */
class PCL_SLIM_EXPORT SurfaceProbe {
 public:
  static constexpr std::size_t kMost = 16;

  explicit SurfaceProbe(const ProbeIndex& index);
  ~SurfaceProbe();

  /** \brief Forgets the leaves found, so that results depend on what follows alone.
   * \param[in] margin how far around a request leaves are looked for ahead, local units. */
  void restart(double margin);

  /** \brief \param[out] samples one for each position. Cost: O(leaves near the places). */
  void evaluate(const ProbeRequest& request, ProbeSample* samples);

  /** \brief Distances from up to kMost places to the sheets of surface nearest to them; needs an
   * index for ProbeUse::kExtraction.
   *
   * The nearest leaf, by weight over squared distance, chooses the sheet; leaves on its side and at
   * about its distance are blended, with their weights at the places' feet. The zero set is that of
   * the blended surface but for terms of second order in the distance. Unoriented surfaces give the
   * sign of the nearest leaf. O(leaves near the places). \param[out] distances one for each place.
   */
  void distances(const Vector3* places, std::size_t count, SheetDistance* distances);

  /** \brief Colours of a surface that has any, blended with the leaves' weights at places on it.
   * \param[in] sides normals at the places: where the surface is oriented, leaves that face away
   * from them do not count. A place on no leaf's sheet gets the colours of all balls that contain
   * it, or none. O(leaves near the places). \param[out] colors red, green, blue, 0..255, for each
   * of up to kMost places; below 0 where there is none. \param[in] widths over which textures are
   * averaged, local units: those of the pixels; null: they are not */
  void colors(const Vector3* places, const Vector3* sides, std::size_t count,
              std::array<float, 3>* colors, const float* widths = nullptr);

  /** \brief Blended radius and number of points at a place. O(leaves near it). */
  ProbeScale scaleAt(const Vector3& position, const Vector3& side);

  std::uint64_t numRequests() const { return num_requests_; }

 private:
  struct Scratch;
  void cover(const Vector3& low, const Vector3& high);
  void load(const Vector3* positions, std::size_t count);
  bool loadSides(const ProbeRequest& request);
  void addErrors(const detail::BlockPoints& points, const detail::BlendRules& rules,
                 const ProbeRequest& request, ProbeSample* samples);
  void finish(const ProbeRequest& request, std::size_t i, ProbeSample& sample) const;
  void finishThird(std::size_t i, ProbeSample& sample) const;

  const ProbeIndex& index_;
  double margin_ = 0;
  std::uint64_t num_requests_ = 0;
  std::unique_ptr<Scratch> scratch_;
};

/** \brief Colours of a coloured surface at places on it: red, green and blue.
 *
 * Each is the mean of the leaves' colours, with the weights that blend the surface. \param[in]
 * positions world coordinates; places of one neighbourhood should follow one another \param[in]
 * normals unit, one for each \return one colour for each, white where the place is in no leaf's
 * ball; none if the surface has no colours. O(surfels log surfels + leaves near the places); the
 * same for any number of threads. */
PCL_SLIM_EXPORT std::vector<std::array<std::uint8_t, 3>> surfaceColors(
    const SLIMSurface& surface, const std::vector<Vector3>& positions,
    const std::vector<std::array<float, 3>>& normals, int threads = 0);

/** \brief Standard errors of a surface at places on it, world units; zero where no leaf supports a
 * place.
 *
 * \param[in] positions world coordinates; places of one neighbourhood should follow one another
 * \param[in] normals unit, one for each: where the surface is oriented, leaves that face away from
 * them do not count. O(surfels log surfels + leaves near the places); the same for any number of
 * threads. */
PCL_SLIM_EXPORT std::vector<StandardErrors> surfaceErrors(
    const SLIMSurface& surface, const std::vector<Vector3>& positions,
    const std::vector<std::array<float, 3>>& normals, int threads = 0);

}  // namespace pcl_slim
