// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pcl_slim/compare/triangle_index.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Places to compare with a reference: borrowed columns, world coordinates. */
struct DeviationPlaces {
  const Vector3* positions = nullptr;
  std::size_t count = 0;
  /// one a place, or null; one that is zero or not finite is unknown
  const std::array<float, 3>* normals = nullptr;
  bool oriented = false;  ///< the normals point to one side consistently, as the reference's do
  /// standard errors along the normal, world units, one a place, or null: 0. One that is not finite
  /// or negative counts as 0
  const float* sigma = nullptr;
};

/** \brief The place of a reference that corresponds to a place, or the reason why there is none. */
enum class FootState : std::uint8_t {
  kFound,
  kBorder,     ///< the nearest place is on or beyond the reference's border
  kTooFar,     ///< nothing is within the largest distance
  kFacesAway,  ///< everything within the largest distance faces away from the place's normal
  kHidden,     ///< another side of a wall of the reference is between the two
  kNotFinite,  ///< the place is not finite
};

/** \brief Such a place, in world coordinates. */
struct ReferenceFoot {
  FootState state = FootState::kTooFar;
  double distance = 0;  ///< signed along the reference's normal; valid if found or on a border
  Vector3 position{};
  Vector3 normal{};  ///< unit, of the reference
  double sigma = 0;  ///< standard error of position along the normal
};

/** \brief How feet are found. */
struct PCL_SLIM_EXPORT FootParams {
  double max_distance = 0;  ///< world units; 0: no limit
  bool sides = true;        ///< use normals, where both are oriented; false: nearest place alone
  int threads = 0;          ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

namespace detail {

/** \brief What is done with feet, without its type. */
struct FootVisitor {
  const void* body;
  void (*prepare)(const void* body);
  void (*take)(const void* body, std::size_t i, const ReferenceFoot& foot);
};

}  // namespace detail

/** \brief What places are compared with: a SLIM surface or a triangle mesh, arranged so that nearest
 * places are found fast, however far away they are.
 *
 * Of a surface, the foot is on the blended zero set (equations 6 to 8 of Ohtake, Belyaev, Alexa
 * 2005): leaves are found by a tree of boxes, their polynomials give a start, and Newton steps with
 * SurfaceProbe::evaluate() continue until what remains is along the normal. The surface ends where
 * its trim maps end. Of a mesh, the foot is exact (TriangleIndex).
 *
 * Where the places' normals and the reference's are both oriented, a place corresponds only to
 * places of the reference whose normal is less than 90 degrees from its own, so that each side of a
 * thin part is compared with the same side. A foot is hidden if the nearest place of all faces the
 * other way (cosine below -1/2) and has the place on its other side: then one of the two is in the
 * material and the other in the air, or a wall is between them. */
class PCL_SLIM_EXPORT DeviationReference {
 public:
  /** \brief A surface, which must outlive this object. \return an error for one without leaves.
   * O(leaves log leaves). */
  static Result<DeviationReference> make(const SLIMSurface& surface, int threads = 0);
  /** \brief A mesh, which is copied. \param[in] vertex_sigma the standard error of each vertex along
   * the normal, world units; empty: exact. \return an error for a mesh without triangles, or an
   * invalid one. O(T log T). */
  static Result<DeviationReference> make(const TriangleMesh& mesh,
                                         std::vector<float> vertex_sigma = {}, int threads = 0);
  DeviationReference(DeviationReference&&) noexcept;
  DeviationReference& operator=(DeviationReference&&) noexcept;
  ~DeviationReference();

  /** \brief Whether normals point to one side consistently: SurfaceInfo::oriented without
   * sides_in_doubt, or no edge of the mesh whose triangles disagree. */
  bool oriented() const;
  /** \brief A box that contains the reference, world coordinates. */
  Bounds bounds() const;
  /** \brief What was found in the mesh; null of a surface. */
  const TriangleIndexStatistics* meshStatistics() const;
  std::size_t memoryBytes() const;

  /** \brief The feet of some places. \param[out] feet one for each place. \return an error for bad
   * parameters or cancellation. Same bytes for any number of threads. Memory: 20 bytes a
   * place while they are sorted, then 4 besides the feet. */
  Error find(const DeviationPlaces& places, const FootParams& params,
             std::vector<ReferenceFoot>& feet, Progress* progress = nullptr) const;

  /** \brief As find(), for feet that need not be kept all at once. \param[in] take called once a
   * place with its number and its foot, from several threads at a time. */
  template <typename Take>
  Error forEach(const DeviationPlaces& places, const FootParams& params, const Take& take,
                Progress* progress = nullptr) const {
    return forEach(
        places, params, [] {}, take, progress);
  }

  /** \brief As above. \param[in] prepare called once before the first foot, when the working memory
   * is no longer at its peak: to allocate what take() writes to. */
  template <typename Prepare, typename Take>
  Error forEach(const DeviationPlaces& places, const FootParams& params, const Prepare& prepare,
                const Take& take, Progress* progress) const {
    struct Body {
      const Prepare& prepare;
      const Take& take;
    } body{prepare, take};
    const detail::FootVisitor visitor = {
        &body, [](const void* own) { static_cast<const Body*>(own)->prepare(); },
        [](const void* own, std::size_t i, const ReferenceFoot& foot) {
          static_cast<const Body*>(own)->take(i, foot);
        }};
    return visit(places, params, visitor, progress);
  }

 private:
  struct Data;
  struct Run;

  explicit DeviationReference(std::unique_ptr<Data> data);
  Error visit(const DeviationPlaces& places, const FootParams& params,
              const detail::FootVisitor& visitor, Progress* progress) const;

  std::unique_ptr<Data> data_;
};

/** \brief Share of places whose normal is less than 90 degrees from that of their nearest place of the
 * reference, borders left out; NaN where there is nothing to compare. Below 1/2 the places' normals
 * as a whole point to the other side, as those of two open scans may that were turned each by
 * itself: turn them round before sides are used. Of 2,000 places at most, evenly along their Morton
 * order. \return an error for bad parameters or cancellation. */
PCL_SLIM_EXPORT Result<double> facingShare(const DeviationReference& reference,
                                           const DeviationPlaces& places, const FootParams& params,
                                           Progress* progress = nullptr);

/** \brief What a deviation means. */
enum class DeviationClass : std::uint8_t {
  kSame,           ///< within the level of detection
  kSignificant,    ///< beyond it
  kNoCounterpart,  ///< the reference has no place that corresponds; Deviations::state says why
};

/** \brief How deviations are measured and judged. */
struct PCL_SLIM_EXPORT DeviationParams {
  FootParams feet;
  double registration_error = 0;  ///< standard error of the alignment of both, world units
  bool keep_feet = true;          ///< fill Deviations::offset and normal

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief Signed distances of places from a reference and what can be detected: columns with one
 * entry for each place, 37 bytes in all, 13 without feet. NaN and zeros where there is no
 * counterpart. World units. */
struct PCL_SLIM_EXPORT Deviations {
  std::vector<float> distance;         ///< positive on the side of the reference's normal
  std::vector<float> sigma_reference;  ///< standard error of the reference at the foot
  std::vector<float> detection;        ///< 95 % level of detection
  std::vector<FootState> state;
  std::vector<std::array<float, 3>> offset;  ///< foot minus place, if kept
  std::vector<std::array<float, 3>> normal;  ///< unit, the reference's at the foot, if kept

  std::size_t size() const { return distance.size(); }
  /** \brief Whether |distance| exceeds the level of detection. */
  DeviationClass classOf(std::size_t i) const;
  /** \brief The foot of place i, if feet are kept. */
  Vector3 foot(const DeviationPlaces& places, std::size_t i) const;
};

/** \brief 95 % level of detection of a difference: 1.96 (sqrt(a^2 + b^2) + registration_error)
 * (Lague, Brodu, Leroux, Accurate 3D comparison of complex topography with terrestrial laser
 * scanner, ISPRS Journal 82, 2013, eq. 1, for standard errors a and b). */
PCL_SLIM_EXPORT double levelOfDetection(double sigma_place, double sigma_reference,
                                        double registration_error);

/** \brief Measures how far places are from a reference. \param[out] deviations cleared first; empty
 * on an error. \return an error for bad parameters or cancellation. As DeviationReference::find() in
 * time; 20 bytes a place
 * while they are sorted, then 4 besides the result. Same bytes for any number of threads. */
PCL_SLIM_EXPORT Error measureDeviations(const DeviationReference& reference,
                                        const DeviationPlaces& places,
                                        const DeviationParams& params, Deviations& deviations,
                                        Progress* progress = nullptr);

}  // namespace pcl_slim
