// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/line_significance.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief A row of a picture as kernels read it; columns as in GBuffer. */
struct PictureRow {
  const float *depth, *normal, *gradient, *hessian;  ///< of its first pixel
  int width;
  float left, height, pixel;  ///< first pixel in the plane at depth 1, and a pixel's length there
  bool perspective;           ///< false: a pixel has that length at every depth
  std::array<float, 3> right, up, forward;
};

/** \brief The surface's curvature from a row's blends; columns per pixel, padded to sixteen. */
struct FrameRow {
  AlignedVector<float> k;                         ///< a curvature, 1/local length
  std::array<AlignedVector<float>, 3> direction;  ///< its unit tangent; the sign is arbitrary
  std::array<AlignedVector<float>, 2>
      screen;  ///< the tangent in the picture, pixels per local length

  explicit FrameRow(int width);
};

namespace kernels {

/** \brief The larger principal curvature of each pixel: k1 where the surface is convex, as for
 * ridges, and k2 < 0 where it is more concave. 0 where nothing is seen; where the surface is seen
 * at a grazing angle screen is 0. */
void crestFrames(const PictureRow& row, FrameRow& frames);

/** \brief Radial curvature of each pixel, along the projected way to the viewer. Facing contours
 * and straight ahead, where it is undefined, screen is 0. */
void radialFrames(const PictureRow& row, FrameRow& frames);

}  // namespace kernels

using Pixel2 = std::array<float, 2>;

/** \brief Geometry that all kinds of lines need; nothing is stored per pixel. */
class PixelGeometry {
 public:
  PixelGeometry(const GBuffer& buffer, const Camera& camera, const SLIMSurface& surface);

  const GBuffer& buffer() const { return buffer_; }
  double diagonal() const { return diagonal_; }

  /** \brief A row for the kernels; of a buffer with gradients and Hessians. */
  PictureRow row(int y) const;
  /** \brief Whether a row shows the surface anywhere. */
  bool rowIsEmpty(int y) const;

  /** \brief Length of a pixel at its surface point, local units. */
  float pixelLength(std::size_t pixel, int x, int y) const;
  /** \brief Depth at which another pixel's ray meets a pixel's tangent plane; -infinity where it
   * meets it behind the camera or never. */
  float depthOfPlane(std::size_t pixel, int x, int y, int other_x, int other_y) const;

  /** \brief Local position of a place between pixels, up to a shift of all. */
  Vector3 position(float x, float y, float depth) const;

  /** \brief A value of the four pixels about a place, by bilinear interpolation; false where one
   * shows no surface or is another sheet's.
   * \param[in] depth, distance of a place on the sheet, and how far it is along the surface: depths
   * differ by no more than that, and a step
   * \param[in] read gives a pixel's value; it is called for pixels that show the surface only */
  template <typename Read>
  bool sample(float x, float y, float depth, float distance, const Read& read, float& value) const {
    if (!(x >= 0 && x < static_cast<float>(buffer_.width - 1))) return false;
    if (!(y >= 0 && y < static_cast<float>(buffer_.height - 1))) return false;
    const auto x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const std::size_t first = buffer_.index(x0, y0);
    const std::size_t below = first + static_cast<std::size_t>(buffer_.width);
    const float most = step_ + std::abs(distance);
    // Where nothing is seen the depth is infinite.
    const float* const d = buffer_.depth.data();
    // Counted without a branch each.
    const auto near = [&](std::size_t i) {
      return static_cast<int>(std::abs(d[i] - depth) <= most);
    };
    if (near(first) + near(first + 1) + near(below) + near(below + 1) < 4) return false;
    const float top_left = read(first), bottom_left = read(below);
    const float top = top_left + fx * (read(first + 1) - top_left);
    const float bottom = bottom_left + fx * (read(below + 1) - bottom_left);
    value = top + fy * (bottom - top);
    return true;
  }

  /** \brief The same at a local distance from a pixel along a tangent, given as its image in the
   * picture. */
  template <typename Read>
  bool sampleAside(std::size_t pixel, const Pixel2& screen, float distance, const Read& read,
                   float& value) const {
    const auto width = static_cast<std::size_t>(buffer_.width);
    const std::size_t row = pixel / width;
    const auto x = static_cast<float>(pixel % width), y = static_cast<float>(row);
    return sample(x + distance * screen[0], y + distance * screen[1], buffer_.depth[pixel],
                  distance, read, value);
  }

  /** \brief The same before and behind a pixel. */
  template <typename Read>
  bool sampleBothWays(std::size_t pixel, const Pixel2& screen, float distance, const Read& read,
                      float& before, float& behind) const {
    return sampleAside(pixel, screen, distance, read, before) &&
           sampleAside(pixel, screen, -distance, read, behind);
  }

  /** \brief Local distance over which differences of curvature along a tangent are steady, in the
   * pixels of this view. */
  float differenceStep(std::size_t pixel, const Pixel2& screen) const;

  /** \brief A difference of curvatures half a leaf's radius apart [1/local length] in deviations
   * of the noise at a pixel. */
  float significance(float difference, std::size_t pixel) const;
  /** \brief How well a pixel's leaf fits its points, in (0, 1]: 1 down to the noise. */
  float fit(std::size_t pixel) const {
    return std::min(1.0f, std::sqrt(2.0f * surface_.varianceWeight(buffer_.surfel[pixel])));
  }

 private:
  const GBuffer& buffer_;
  const SLIMSurface& surface_;
  CameraRays rays_;
  bool perspective_;
  double diagonal_;
  CurvatureNoise noise_;
  float step_;  ///< of depth
  std::array<float, 3> right_, up_, forward_;
};

/** \brief Some of many integers, numbered in ascending order: a bit for each of the many, so that
 * what is kept about the few takes no more room than they. */
class NumberedSet {
 public:
  /** \param[in] limit integers are below it */
  explicit NumberedSet(std::size_t limit) : bits_(limit / 64 + 1), before_(limit / 64 + 1) {}

  void add(std::uint32_t i) { bits_[i / 64] |= std::uint64_t{1} << i % 64; }

  /** \brief To be called once, after the last add(). \return how many there are */
  std::size_t count() {
    std::uint32_t sum = 0;
    for (std::size_t word = 0; word < bits_.size(); ++word) {
      before_[word] = sum;
      sum += ones(bits_[word]);
    }
    return sum;
  }

  /** \brief Number of a member, from 0. */
  std::uint32_t numberOf(std::uint32_t i) const {
    const std::uint64_t lower = (std::uint64_t{1} << i % 64) - 1;
    return before_[i / 64] + ones(bits_[i / 64] & lower);
  }

 private:
  static std::uint32_t ones(std::uint64_t word) {
    return static_cast<std::uint32_t>(__builtin_popcountll(word));
  }

  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;  ///< members in the words before
};

/** \brief A piece of a line between two joints, which are named by numbers. */
struct Link {
  std::array<std::uint32_t, 2> joint{};
};

/** \brief Joints in the order in which a line passes them. */
struct Chain {
  std::vector<std::uint32_t> joints;
  bool closed = false;
};

/** \brief Joins links that share a joint into chains; joints of more than two links end chains.
 * O(links + joints).
 * \param[in] num_joints joints are below it */
std::vector<Chain> joinLinks(const std::vector<Link>& links, std::size_t num_joints);

/** \brief Which chains are long enough, a flag each: those of least_length joints, and shorter ones
 * between two joints of others if their connected component is as long. A short chain with a free
 * end is a burr. O(chains + joints). */
std::vector<std::uint8_t> longEnough(const std::vector<Chain>& chains, std::size_t num_joints,
                                     double least_length);

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
  float most = 0;          ///< the vertex's size is not above it
  Pixel2 screen{};         ///< the tangent's image at the nearer pixel
};

/** \brief A vertex of a line before the line is kept or not. */
struct LineVertex {
  float x = 0, y = 0;
  float size = 0;  ///< what the line is measured by, in units of the least; below 1 it is not kept
  float significance = 0;  ///< deviations of the noise
  float sharpness = 0;     ///< whose integral along a line is its strength [1/local length]
  float radius = 0;        ///< of the leaf, local units
  Vector3 position{};      ///< local units, up to a shift of all
};

/** \brief A field over the pixels whose zeros are lines. Values along tangents of arbitrary sign
 * turn theirs with the tangents; those of a field without a sign have tangents of zero length. */
class ZeroField {
 public:
  explicit ZeroField(const PixelGeometry& geometry) : geometry_(geometry) {}
  virtual ~ZeroField() = default;

  const PixelGeometry& geometry() const { return geometry_; }
  /** \brief A row's values; frames of pixels without one are not read. */
  virtual void fill(int y, FieldRow& row) const = 0;
  /** \brief The most that a vertex's size can be between two neighbours, from their rows alone.
   * \param[in] axis of the picture in which they are neighbours, from a to b */
  virtual float mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                            float share, std::size_t axis) const = 0;
  /** \brief Sets a vertex's size, significance and sharpness at a crossing. */
  virtual void measure(const ZeroCrossing& at, std::size_t nearer, int kind,
                       LineVertex& vertex) const = 0;

 protected:
  const PixelGeometry& geometry_;
};

constexpr float kReachedSize = 2.0f;  ///< size that a line has somewhere

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

/** \brief Which stretches of lines are kept. */
struct LineRule {
  double least_length = 0;    ///< pixels
  double least_strength = 0;  ///< integral of the sharpness along it
};

/** \brief Appends the stretches of size 1 and more that are significant, reach size 2 and are as
 * long and strong as the rule has it. O(vertices). */
void keepStrong(const std::vector<ZeroLine>& zeros, PictureLineKind kind, const LineRule& rule,
                std::vector<PictureLine>& lines);

}  // namespace pcl_slim::detail
