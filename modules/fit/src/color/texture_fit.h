// SPDX-License-Identifier: BSD-3-Clause
// Textures of surfels (docs/theory.md, "Colours").
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"
#include "trim/trim.h"

namespace pcl_slim::detail {

/** \brief Red, green and blue of all stored points, padding included. */
using ColorColumns = std::array<AlignedVector<std::uint8_t>, 3>;

/** \brief When a surfel's colours need a texture, and how fine it is. */
struct TextureConstants {
  double tolerance = 1.0;     ///< [Delta E] RMS deviation in a cell that is not divided
  double deviations = 3.0;    ///< of the noise's mean square in a cell, added to it
  float least_points = 2;     ///< of a cell that is divided
  double finest = 1.0;        ///< [spacing of the points] width of the texels
  int internal_side = 16;     ///< most texels a side of surfels that are no leaves: seen from afar
  int sharpenings = 2;        ///< corrections by what interpolation leaves at the points ...
  float relaxation = 1.5f;    ///< ... and how much of that each takes
  float least_share = 0.03f;  ///< of the greatest weight at a point: it counts in a leaf
};

/** \brief The greatest weight that any leaf's colour has at each stored point, as the bits of a float:
 * their order is that of the numbers. */
using LeadingWeights = std::vector<std::atomic<std::uint32_t>>;

/** \brief Raises the weights at the points of a leaf to its own. */
void raiseWeights(const SheetPoints& points, float variance_weight, LeadingWeights& weights);

/** \brief Variance of the points' colours [Delta E^2] where they vary least: noise. O(blocks). */
double colorNoise(const PointStore& store, const ColorColumns& colors, const LabTable& lab);

/** \brief Paints the texture of one surfel after another. One per thread: it keeps its memory.
 *
 * The criterion of colour octrees (Kim, Pajarola, Lee) on a quadtree over the surfel's plane: cells
 * are divided while the colours of their points deviate by more than the tolerance and the noise,
 * down to the spacing of the points. A divided cell's children have what the polynomial
 * leaves of their points' colours on average; the others are interpolated, so that noise is averaged
 * where nothing varies.
 */
class TextureFitter {
 public:
  TextureFitter(const ColorColumns& colors, const LabTable& lab, double noise,
                const LeadingWeights& weights)
      : colors_(colors), lab_(lab), noise_(noise), weights_(weights) {}

  /** \brief Appends the texels of a surfel's texture if it needs one. \param[in] points of its
   * sheet \param[in] color its polynomial, encoded \param[in] variance_weight a leaf's; 0: it is
   * none. \return the texture's side, 0: none. O(points + texels). */
  int fit(const SheetPoints& points, const std::uint8_t* color, float variance_weight,
          std::vector<std::uint8_t>& texels);

 private:
  /** Colours whose squared distance is Delta E^2 about the surfel's mean colour. */
  using Even = std::array<float, 3>;
  /** Points of a cell: sums of their colours and of the squares. */
  struct Cell {
    Even sum{};
    float square = 0, count = 0;
    bool divided = false;
  };
  struct Level {
    int side = 0;
    std::vector<Cell> cells;
    std::vector<Even> colors;  ///< of the cells
  };
  struct Metric;

  std::size_t takePoints(const SheetPoints& points, const ColorPolynomial& polynomial,
                         float variance_weight);
  bool deviates(float count, double square) const;
  void sumUp(int side);
  void divide();
  void fillGaps();
  void sharpen();
  void write(const ColorPolynomial& polynomial, const Metric& metric,
             std::vector<std::uint8_t>& texels) const;

  const ColorColumns& colors_;
  const LabTable& lab_;
  double noise_;
  const LeadingWeights& weights_;
  std::vector<std::array<float, 2>> places_;  ///< of the points [reach]
  std::vector<Even> values_;                  ///< of the points
  std::array<float, 3> mean_{};
  std::vector<Level> levels_;  ///< the finest first
  int num_levels_ = 0;
  std::vector<std::array<float, 2>> middles_;  ///< of texels: sums of their points' places
  std::vector<std::array<float, 4>> sums_;     ///< of texels: corrections, and their weight
};

}  // namespace pcl_slim::detail
