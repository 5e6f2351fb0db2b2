// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What a .slim file may change of a surface. */
struct SlimRounding {
  double share =
      0.0;  ///< RMS distance that leaves may move [RMS residual of all]; 0: floats are kept
  int color_error = 0;  ///< greatest change of a texture's channel, 0 ... 32 of 255

  SlimRounding() = default;
  /** \brief Of a share alone: textures are kept. */
  SlimRounding(double of_leaves, int of_colors = 0) : share(of_leaves), color_error(of_colors) {}
};

/** \brief Writes the compact binary form: header, version, checksum, and 7, 12, 16 or 21 floats a
 * surfel of degree 1 to 4.
 *
 * The floats are those the paper counts: centre 3, radius 1, normal 2 and the 1, 6, 10 or 15
 * coefficients of the surfel's own degree. A plane needs only its offset where the surfel's normal
 * is its own, as every fit makes it; a linear surfel with another normal keeps three and so has 9.
 * They are followed by degree, level and flags (a byte each), error and confidence (a float each);
 * links are rebuilt on load. Open surfels have their trim map: a byte, and a bit a node; files with
 * such maps are of version 2, others of version 1. Coloured surfaces have kColorBytes more a
 * surfel, in version 4. Little-endian. Normals that snapNormal made are kept exactly, others to
 * 6.2e-7 rad. The file appears under its name only when complete.
 *
 * Rounded files, of version 5, are about a sixth as large: coefficients are those of polynomials
 * that are orthonormal under the blend's weight, in steps that move the surface alike, and all
 * numbers are entropy coded relative to those of the nearest surfel before.
 * A share of .1 adds about 1 % to the residual. A surface with numbers out of all proportion is
 * stored as floats. Surfaces with textures are of version 6: these are predicted from texel to texel
 * and entropy coded.
 */
PCL_SLIM_EXPORT Error saveSlim(const std::string& path, const SLIMSurface& surface,
                               const SlimRounding& rounding = {});

/** \brief Reads what saveSlim wrote, or SlimBlockWriter; saving the result of the former again
 * gives the same bytes if nothing is rounded.
 *
 * A missing, truncated, foreign, corrupted or newer file gives an error that names the defect.
 */
PCL_SLIM_EXPORT Result<SLIMSurface> loadSlim(const std::string& path);

/** \brief The bytes of saveSlim, for tests and for sending elsewhere. The surface must pass
 * validate(); one with a degree out of range gives no bytes. */
PCL_SLIM_EXPORT std::vector<unsigned char> encodeSlim(const SLIMSurface& surface,
                                                      const SlimRounding& rounding = {});

/** \brief Whether bytes begin as those of a .slim file do. */
PCL_SLIM_EXPORT bool isSlim(const unsigned char* bytes, std::size_t size);

/** \brief Inverse of encodeSlim. */
PCL_SLIM_EXPORT Result<SLIMSurface> decodeSlim(const unsigned char* bytes, std::size_t size);

}  // namespace pcl_slim
