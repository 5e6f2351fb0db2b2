// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief How densely a surface is sampled; one of the two. */
struct PCL_SLIM_EXPORT SurfaceSampleParams {
  double spacing = 0.0;     ///< > 0: least distance of two samples, world units
  std::uint64_t count = 0;  ///< > 0: number of samples; the spacing follows
  std::uint64_t seed = 1;   ///< of the order in which places are tried
  int threads = 0;          ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief Points of a surface, in world coordinates. */
struct SurfaceSamples {
  std::vector<std::array<double, 3>> position;
  std::vector<std::array<float, 3>> normal;        ///< unit
  std::vector<std::array<float, 2>> curvature;     ///< mean, 1/length, and Gaussian, 1/length^2
  std::vector<std::array<std::uint8_t, 3>> color;  ///< red, green, blue; none of a surface without
  double spacing = 0.0;                            ///< least distance that was kept
  std::uint64_t candidates = 0;                    ///< places that were tried

  std::size_t size() const { return position.size(); }
};

/** \brief Spreads points over a surface, inside its borders, as a maximal Poisson-disc set: no two
 * are nearer than the spacing, and none could be added (Cook, Stochastic sampling in computer
 * graphics, TOG 1986).
 *
 * Candidates are the nodes of a grid of half the spacing on every leaf, in a random order. One that
 * no sample is nearer to than the spacing is projected onto the blended surface and is a sample if
 * this is so there, too. Points of two sheets that face apart do not hinder each other. For a count,
 * the spacing is sought at which up to 3 % more fit, or as few more as in twelve trials; those
 * nearest to another are left out.
 * O(candidates), 25 to 40 per sample, of which 2 are projected; the same for any number of threads.
 * \return an error for bad parameters, a surface without leaves, or cancellation. */
PCL_SLIM_EXPORT Error sampleSurface(const SLIMSurface& surface, const SurfaceSampleParams& params,
                                    SurfaceSamples& samples, Progress* progress = nullptr);

}  // namespace pcl_slim
