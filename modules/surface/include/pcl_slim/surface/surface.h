// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surfel_texture.h"
#include "pcl_slim/surface/trim_map.h"
#include "pcl_slim/surface/weight_kernel.h"

namespace pcl_slim {

/** \brief What a surfel is; bits of SLIMSurface::flags. */
enum SurfelFlag : std::uint8_t {
  kSurfelLeaf = 1,  ///< blended into the surface; otherwise an internal node of the hierarchy
  kSurfelSupportLimited = 2,  ///< ended by minimum support, not by a minimum of the energy
  kSurfelOpen = 4,            ///< data end, or leave a hole, inside its ball: it has a trim map
};

/** \brief The textures of a surface's leaves. */
struct TextureStatistics {
  std::uint64_t leaves = 0;   ///< that have one
  std::uint64_t texels = 0;   ///< of these
  std::uint64_t limited = 0;  ///< as fine as a texture can be: their points may be denser
  double finest = 0;          ///< width of the smallest texels, world units; 0: there are none
};

/** \brief How a surface was made, and the units it is stored in. */
struct PCL_SLIM_EXPORT SurfaceInfo {
  int degree = 4;  ///< highest polynomial degree, 1..4
  WeightKernel fit_kernel = WeightKernel::kPower4;
  WeightKernel blend_kernel = WeightKernel::kPower4;
  bool oriented = false;            ///< normals point to one side consistently
  bool sides_in_doubt = false;      ///< oriented by sides of thin parts of which many may be wrong
  bool paper_mode = false;          ///< fitted with the choices of Ohtake et al. 2005
  std::array<double, 3> origin{};   ///< world = origin + scale * local
  double scale = 1.0;               ///< world units per local unit, a power of two: exact both ways
  double diagonal = 1.0;            ///< main diagonal L of the input's bounding box, local units
  double lambda = 0.0;              ///< noise variance [L^2]
  double correlation = 1.0;         ///< tau: points that share an error; 1: independent errors
  double penalty = 3.0;             ///< kappa of the penalty kappa lambda P / n_eff (0: unused)
  double t_mdl = 0.0;               ///< T_MDL of the paper's penalty (0: unused)
  double cover_radius = 2.0 / 3.0;  ///< alpha: leaves cover within alpha * r
  double cover_threshold = 0.1;     ///< gamma: a point is covered at this sum of weights
  std::uint64_t num_points = 0;     ///< points the surface was fitted to

  /** \brief Whether all leaves that face away are behind others, so that pictures do without them.
   */
  bool hasFront() const { return oriented && !sides_in_doubt; }

  /** \brief Checks all numbers: finite, and in ranges where computations neither overflow nor
   * vanish.
   */
  Error validate() const;
};

/** \brief A SLIM surface: surfels (ball, normal, polynomial) of several levels and their links.
 *
 * Structure of arrays in local units, where the input's bounding-box diagonal L is in (.49, 1);
 * centres are on a grid coarse enough that world = origin + scale * local is exact in float
 * unless the origin is beyond 256 L. Surfel i
 * is the set f_i(x) = 0 inside the ball |x - c| < r with, in the frame of its normal,
 *
 *     f(x) = r (w' - h(u', v')),   (u', v', w') = ((x - c).u, (x - c).v, (x - c).w) / r,
 *
 * so coefficients carry no unit (Ohtake, Belyaev, Alexa 2005, eqs 1-2). The normal and grad f
 * point to the outer side if SurfaceInfo::oriented is true.
 */
class PCL_SLIM_EXPORT SLIMSurface {
 public:
  SurfaceInfo info;

  std::vector<float> cx, cy, cz;       ///< centres
  std::vector<float> radius;           ///< support radii
  std::vector<float> nx, ny, nz;       ///< unit normals: the w axes
  std::vector<float> coefficients;     ///< stride() per surfel, unused ones 0
  std::vector<float> error;            ///< weighted RMS residual of the fit, in local units
  std::vector<float> effective_count;  ///< effective number of points behind the fit, n_eff
  std::vector<std::uint8_t> degree;    ///< degree of each surfel, at most info.degree
  std::vector<std::uint8_t> level;     ///< k of the paper's sliding interval, 1 = coarsest
  std::vector<std::uint8_t> flags;     ///< SurfelFlag bits

  std::vector<std::uint32_t> trim_begin;  ///< size() + 1 offsets into trim_maps; empty: all closed
  std::vector<std::uint8_t> trim_maps;    ///< of open surfels: side in a byte, then the bits

  std::vector<std::uint8_t> colors;  ///< kColorBytes per surfel (surfel_color.h); empty: none
  std::vector<std::uint32_t> texture_begin;  ///< size() + 1 offsets into textures; empty: none
  std::vector<std::uint8_t> textures;        ///< side in a byte, then the texels

  std::vector<std::uint32_t> child_begin;  ///< size() + 1 offsets into children (may be empty)
  std::vector<std::uint32_t> children;     ///< surfels one level finer whose centre is inside
  std::vector<std::uint32_t> roots;        ///< children of the enclosing root ball
  std::array<float, 4> root_ball{};        ///< centre and radius of a ball that contains all balls

  /** \brief Number of surfels of all levels. */
  std::size_t size() const { return cx.size(); }
  bool empty() const { return cx.empty(); }
  /** \brief Coefficients stored for each surfel. */
  int stride() const { return numCoefficients(info.degree); }
  /** \brief Whether surfel i is part of the surface, not only of the hierarchy. */
  bool isLeaf(std::size_t i) const { return (flags[i] & kSurfelLeaf) != 0; }
  /** \brief Number of leaves. O(surfels). */
  std::size_t numLeaves() const;
  /** \brief The leaves, ascending. */
  std::vector<std::uint32_t> leaves() const;
  /** \brief Number of levels of the hierarchy. O(surfels). */
  std::size_t numLevels() const;
  /** \brief The stride() coefficients of surfel i, in the order of polynomial.h. */
  const float* coefficientsOf(std::size_t i) const { return coefficients.data() + i * stride(); }

  /** \brief Whether surfel i has a trim map. */
  bool isOpen(std::size_t i) const { return (flags[i] & kSurfelOpen) != 0; }
  /** \brief Whether any surfel has a trim map. */
  bool hasTrimMaps() const { return !trim_begin.empty(); }
  /** \brief Where surfel i's ball contains data; a closed map if it does everywhere. */
  TrimMap trimMap(std::size_t i) const {
    if (!isOpen(i)) return {};
    const std::uint8_t* map = trim_maps.data() + trim_begin[i];
    return {map[0], map + 1};
  }

  /** \brief Inverse-variance weight of surfel i in a blend: v / (v + e^2) with v = lambda L^2 + (r
   * / 1000)^2, in (0, 1]. A leaf that contains an edge or two sheets counts little compared with
   * one that fits; leaves that fit down to the noise count alike. */
  float varianceWeight(std::size_t i) const;

  /** \brief Whether the surfels have colours, as those of a coloured cloud do. */
  bool hasColors() const { return !colors.empty(); }
  /** \brief Whether any surfel has a texture. */
  bool hasTextures() const { return !texture_begin.empty(); }
  /** \brief The colours of surfel i where its polynomial does not follow them; empty elsewhere. */
  SurfelTexture texture(std::size_t i) const {
    if (texture_begin.empty() || texture_begin[i] == texture_begin[i + 1]) return {};
    const std::uint8_t* map = textures.data() + texture_begin[i];
    return {map[0], map + 1};
  }

  /** \brief Counts the textures. O(surfels). */
  TextureStatistics textureStatistics() const;

  /** \brief Removes every surfel and link; keeps info. */
  void clear();
  /** \brief Sets the number of surfels; none has a trim map, a colour or a texture then. */
  void resize(std::size_t count);

  /** \brief Appends the surfels of another surface of the same units and degree, as a tile of the
   * same cloud is; links are dropped, for buildLinks(). An empty surface takes over the other's
   * info. Colours and textures are kept where both surfaces have colours. */
  void append(const SLIMSurface& more);
  /** \brief The surfels from begin on, to before end, without links. */
  SLIMSurface slice(std::size_t begin, std::size_t end) const;

  /** \brief Turns surfel i's normal round; its zero set and its border stay the same. */
  void flip(std::size_t i);

  /** \brief Gives the surfels trim maps in place of those they have, and sets their flags.
   * \param[in] sides size() values, 0 for closed surfels \param[in] bits the maps of the others,
   * one after another, TrimMap::numBytes(side) each */
  void setTrimMaps(const std::vector<std::uint8_t>& sides, const std::vector<std::uint8_t>& bits);
  /** \brief Closes the holes of the trim maps that are narrower than a number of spacings of the
   * points, as a fit with this hole size does; bounded by what one ball spans. Holes that a fit has
   * closed stay closed. O(nodes of the maps times hole); the same for any number of threads. */
  void closeHoles(double hole, int threads = 1);
  /** \brief Makes every surfel closed. */
  void dropTrimMaps();

  /** \brief Gives the surfels textures in place of those they have. \param[in] sides size() values,
   * 0 for surfels without one \param[in] texels those of the others, one after another; of more than
   * 4 GiB in all, none is kept */
  void setTextures(const std::vector<std::uint8_t>& sides, const std::vector<std::uint8_t>& texels);
  /** \brief Leaves the surfels their polynomials. */
  void dropTextures();

  /** \brief Rebuilds links and the root from centres, radii and levels (section 2, Fig. 6).
   * O(M log M) for M surfels; the same for any number of threads. */
  void buildLinks(int threads = 1);

  /** \brief Checks sizes, and that every number is finite and in a range in which single-precision
   * squares neither overflow nor vanish; names the first defect. Radii and centres are at most 2^20
   * local units, radii at least 2^-40, coefficients at most 2^30, origin and scale at most 2^1000
   * and the scale at least 2^-1000. O(surfels). */
  Error validate() const;

  /** \brief Names a surface most of whose leaves have more than 2,000 others over their middles, as
   * no fit makes them: a picture of it would take hours. Looks at 16 leaves. O(surfels). */
  Error checkOverlap() const;
};

}  // namespace pcl_slim
