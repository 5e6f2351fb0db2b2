// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lines/chains.h"
#include "lines/frame_rows.h"
#include "lines/pixel_geometry.h"
#include "pcl_slim/render/picture_lines.h"

namespace pcl_slim::detail {

/** \brief One row of a field over the pixels. */
struct FieldRow {
  FrameRow frames;
  std::vector<float> value;        ///< its zeros are lines
  std::vector<std::uint8_t> kind;  ///< 0: no value, 1 or 2; lines stay among pixels of one kind

  explicit FieldRow(int width);
};

/** \brief Where a field crosses zero between two neighbouring pixels. */
struct ZeroCrossing {
  std::uint32_t edge = 0;  ///< 2 i from pixel i to the right, 2 i + 1 down
  float share = 0;         ///< of the way
  float most = 0;          ///< the line's strength there is not above it
  Pixel2 screen{};         ///< the tangent's image at the nearer pixel
};

/** \brief A field over the pixels whose zeros are lines. Values along tangents of arbitrary sign turn
 * theirs with the tangents; those of a field without a sign have tangents of zero length. */
class ZeroField {
 public:
  explicit ZeroField(const PixelGeometry& geometry) : geometry_(geometry) {}
  virtual ~ZeroField() = default;

  const PixelGeometry& geometry() const { return geometry_; }
  /** \brief A row's values; frames of pixels without one are not read. */
  virtual void fill(int y, FieldRow& row) const = 0;
  /** \brief The most that strength() can be between two neighbours, from their rows alone.
   * \param[in] axis of the picture in which they are neighbours, from a to b */
  virtual float mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                            float share, std::size_t axis) const = 0;
  /** \brief Strength of the line at a crossing, in units of the least that is drawn; 0: none. */
  virtual float strength(const ZeroCrossing& at, std::size_t nearer, int kind) const = 0;

 protected:
  const PixelGeometry& geometry_;
};

/** \brief A line's vertex before it is kept or not; strength is in units of the least drawn. */
struct LineVertex {
  float x = 0, y = 0, strength = 0;
};

/** \brief Zeros of one kind: a line as a chain of sub-pixel vertices. */
struct ZeroLine {
  std::vector<LineVertex> vertices;
  bool closed = false;
};

/** \brief Follows a field's zeros through the grid of the pixels' centres, by marching squares. */
class ZeroTracer {
 public:
  static constexpr int kMostKinds = 2;

  /** \brief Finds all crossings and links them cell by cell. O(pixels); rows in parallel. */
  ZeroTracer(const ZeroField& field, int threads);

  /** \brief Lines of a kind that may be as long as this, pixels. O(crossings). */
  std::vector<ZeroLine> lines(int kind, double least_length, int threads) const;

 private:
  struct Found {
    std::vector<ZeroCrossing> crossings;  ///< by their edges, ascending
    std::vector<Link> links;              ///< between edges
  };
  using Band = std::array<Found, kMostKinds>;  ///< of some rows, by kind
  class BandScan;

  void addVertex(const ZeroCrossing& at, int kind, ZeroLine& line) const;

  const ZeroField& field_;
  std::vector<Band> bands_;
};

/** \brief Stretches of strength 1 and more that reach 2 and the least length, appended to lines. */
void
keepStrong(std::vector<ZeroLine> zeros, PictureLineKind kind, double least_length,
           std::vector<PictureLine>& lines);

}  // namespace pcl_slim::detail
