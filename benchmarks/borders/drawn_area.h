// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::borders {

/** \brief A scan's points on its surface: where data are. */
struct Feet {
  PointStore store;                          ///< of the feet, in units of their own
  std::vector<float> spacing;                ///< about each stored foot, the store's units
  std::vector<std::array<float, 3>> normal;  ///< of the surface at each stored foot
};

/** \brief The feet of a store's points, and .627 times their distances to the 8th neighbour. */
Feet feetOf(const PointStore& points, const SLIMSurface& surface, int threads);

/** \brief A store's points themselves in place of their feet, without normals. */
Feet pointsOf(const PointStore& points, int threads);

/** \brief Whether places are near data: within a multiple of the spacing about a foot. */
class FootSearch {
 public:
  /** \brief Keeps a reference to the feet. \param[in] extra added to the spacings, scan's units */
  explicit FootSearch(const Feet& feet, double spacings = 1.5, double extra = 0.0);

  /** \brief Median of the feet's spacings, the scan's units. */
  double usualSpacing() const { return usual_spacing_; }

  /** \param[in] world a place in the scan's units. \param[in,out] blocks scratch. */
  bool isNear(const std::array<double, 3>& world, std::vector<std::uint32_t>& blocks) const;

 private:
  bool nearBlock(const std::array<double, 3>& place, std::uint32_t block) const;

  const Feet& feet_;
  double spacings_, extra_;  ///< the store's units
  double usual_spacing_;
  float reach_ = 0.0f;                 ///< what is near where points are at least as dense as usual
  std::vector<std::uint32_t> sparse_;  ///< blocks with a foot that is near to more than that
};

/** \brief Pixels that show a surface where no points are, as connected pieces of six pictures. */
struct Floating {
  std::size_t pieces = 0;  ///< of four pixels and more
  std::size_t pixels = 0;  ///< in all pieces, however small
  double widest = 0.0;     ///< side of the largest piece's box, scan's units
};

/** \brief Drawn area, and the part of it that is far from data. */
struct DrawnArea {
  double total = 0.0, far = 0.0;  ///< any unit
  double seconds = 0.0;           ///< of drawing, without measuring
  Floating floating;
};

/** \brief How drawn area is measured. */
struct AreaViews {
  int size = 1000;         ///< pixels a side
  bool reference = false;  ///< draw with the reference rasteriser
};

/** \brief Sums up, over six views in parallel projection along the axes, the area that pixels show:
 * all of it, and the part that is farther than 1.5 spacings from every foot; and the pieces that
 * float.
 * \param[in] floats what is near no point of this search floats; evaluated where every foot is far
 */
DrawnArea drawnArea(const SLIMSurface& surface, const FootSearch& feet, const FootSearch& floats,
                    const RenderParams& params, const AreaViews& views);

/** \brief Adds the connected pieces of marked pixels, corners included.
 * \param[in,out] marks one a pixel, row after row; cleared. \param[in] pixel its width */
void addPieces(std::vector<std::uint8_t>& marks, int width, double pixel, Floating& floating);

/** \brief The share of points within half a spacing of which nothing is drawn: neither at the foot
 * nor at 8 places around it. */
double lostShare(const SLIMSurface& surface, const Feet& feet, const RenderParams& params);

}  // namespace pcl_slim::borders
