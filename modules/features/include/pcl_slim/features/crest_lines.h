// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/query/line_significance.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Kind of a crest line: where the surface bends most to the outer side or to the inner one.
 */
enum class CrestType : std::uint8_t { kRidge = 0, kRavine = 1 };

/** \brief Which lines to trace and keep. */
struct PCL_SLIM_EXPORT CrestParams {
  bool ridges = true;
  bool ravines = true;
  /** Lines are kept where their prominence is this many deviations of the noise ... */
  double significance = LineSignificance().everywhere;
  /** ... and somewhere along that stretch, as a mean of seven vertices, this many; at least
   * significance. Noise alone makes an RMS of 1 to 2. */
  double peak_significance = LineSignificance().somewhere;
  double min_strength =
      0.0;                  ///< integral of |k| ds of a line, no unit; selects the important lines
  double min_length = 0.3;  ///< of a line, in mean radii of the leaves along it
  double step = 0.15;       ///< distance of vertices in radii of the leaves, in [.02, .5]
  int threads = 0;          ///< 0: all cores; never changes the result

  /** \brief Names the first value out of range. */
  Error validate() const;
};

/** \brief Polylines in world coordinates; columns per vertex and per line.
 *
 * Line i has the vertices line_begin[i] ... line_begin[i + 1] - 1. A closed one does not repeat its
 * first vertex. Strongest lines come first; equal ones in order of their first vertex. Curvatures
 * are positive where the surface bends away from the normal.
 */
struct PCL_SLIM_EXPORT CrestLines {
  std::vector<std::array<double, 3>> position;
  std::vector<std::array<float, 3>> normal;   ///< unit, the surface's
  std::vector<std::array<float, 3>> tangent;  ///< unit, along the line
  std::vector<float> k1, k2;                  ///< principal curvatures, 1/length; k1 >= k2
  std::vector<float> prominence;              ///< |k| less its mean half a radius aside, 1/length
  std::vector<float> significance;            ///< prominence in deviations of the noise's
  std::vector<float> radius;                  ///< blended radius of the leaves

  std::vector<std::uint32_t> line_begin = {0};  ///< numLines() + 1 offsets
  std::vector<CrestType> type;
  std::vector<std::uint8_t> closed;
  std::vector<double> length;    ///< of the polyline
  std::vector<double> strength;  ///< integral of |k| ds
  std::vector<float> mean_significance;

  std::size_t numLines() const { return type.size(); }
  std::size_t numVertices() const { return position.size(); }

  /** \brief Names a column of another length than its vertices or lines, or offsets that do not
   * ascend from 0 to the number of vertices. O(lines). */
  Error validate() const;
};

/** \brief What tracing did, and what it left out. */
struct CrestStatistics {
  std::uint64_t seeds = 0;                ///< changes of sign between neighbouring points
  std::uint64_t seeds_on_lines = 0;       ///< left out: a line, or a seed refused, is there already
  std::uint64_t seeds_insignificant = 0;  ///< left out: below the required significance
  std::uint64_t seeds_failed = 0;         ///< left out: no line found there
  std::uint64_t traced = 0;               ///< lines followed, before any is dropped
  std::uint64_t joined = 0;               ///< ends at another line
  std::uint64_t ended = 0;          ///< ends where the line stops being one, or the surface ends
  std::uint64_t faded = 0;          ///< ends where it is no longer significant
  std::uint64_t insignificant = 0;  ///< lines left out: nowhere significant enough
  std::uint64_t short_lines = 0;    ///< stretches left out: shorter than min_length
  std::uint64_t weak_lines = 0;     ///< stretches left out: below min_strength
  std::uint64_t requests = 0;       ///< requests to SurfaceProbe
  double seconds_seeds = 0, seconds_trace = 0;
};

/** \brief Traces ridges and ravines of a surface: curves along which a principal curvature is
 * largest across its own direction.
 *
 * A ridge is where k1 has a maximum along its direction t1 and k1 > |k2|; a ravine the same of -k2
 * along t2. Lines are followed on the blended surface itself, without a mesh, by predictor and
 * corrector: a step along the line, then the root of dk/dt across it. Under noise dk/dt is taken
 * from differences of k over a tenth of the leaves' radius or somewhat more; on clean data from
 * third derivatives. Lines that noise of the surface's lambda explains are left out. Which of the
 * two kinds a line is depends on the side the normals face.
 *
 * \param[in] projection of the store's points onto the surface, with extremality.
 * \param[out] lines cleared first; empty on an error. \param[out] statistics may be null.
 * \return an error for parameters out of range, a projection of other points or without
 * extremality, or cancellation. A surface without lines is none. O(N) for seeds, then a few
 * SurfaceProbe requests a vertex. The same for any number of threads, of which tracing uses two.
 */
PCL_SLIM_EXPORT Error traceCrestLines(const PointStore& store, const Projection& projection,
                                      const SLIMSurface& surface, const CrestParams& params,
                                      CrestLines& lines, CrestStatistics* statistics = nullptr,
                                      Progress* progress = nullptr);

}  // namespace pcl_slim
