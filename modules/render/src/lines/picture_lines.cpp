// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/picture_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "lines/lines.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

Error PictureLineParams::validate() const {
  if (!(crest_curvature >= 0) || !std::isfinite(crest_curvature))
    return {ErrorCode::kBadArgument,
            "the least curvature of a crest line must be above 0, or 0 for the automatic one"};
  if (!(suggestive_derivative >= 0) || !std::isfinite(suggestive_derivative))
    return {ErrorCode::kBadArgument,
            "the least derivative of a suggestive contour must be above 0, or 0 for the automatic "
            "one"};
  if (!(min_length >= 0)) return {ErrorCode::kBadArgument, "the least length must be 0 or more"};
  return {};
}

unsigned pictureLineColumns(const PictureLineParams& params) {
  return params.crest || params.suggestive ? kGradientColumn | kHessianColumn | kLeafColumns : 0u;
}

namespace {

constexpr float kPixelsBehind = 6.0f;
constexpr double kShareBehind = 0.003;  ///< [L]
constexpr int kSmoothings = 4;          ///< rounds that take the stairs out of pixel edges
constexpr float kStrength = 4.0f;       ///< a contour is drawn in full width

class ContourEdges {
 public:
  explicit ContourEdges(const PixelGeometry& geometry)
      : geometry_(geometry),
        buffer_(geometry.buffer()),
        least_(static_cast<float>(kShareBehind * geometry.diagonal())) {}

  /** Edges above and left of a row's pixels; corners are numbered row by row from the upper left.
   */
  std::vector<Link> row(int y) const {
    std::vector<Link> links;
    for (int x = 0; x < buffer_.width; ++x) {
      if (x > 0 && parted(x - 1, y, x, y)) links.push_back({{corner(x, y), corner(x, y + 1)}});
      if (y > 0 && parted(x, y - 1, x, y)) links.push_back({{corner(x, y), corner(x + 1, y)}});
    }
    return links;
  }

  std::array<float, 2> place(std::uint32_t corner) const {
    const auto across = static_cast<std::uint32_t>(buffer_.width + 1);
    const std::uint32_t x = corner % across, y = corner / across;
    return {static_cast<float>(x) - 0.5f, static_cast<float>(y) - 0.5f};
  }

 private:
  std::uint32_t corner(int x, int y) const {
    return static_cast<std::uint32_t>(y * (buffer_.width + 1) + x);
  }

  bool parted(int xa, int ya, int xb, int yb) const {
    const std::size_t a = buffer_.index(xa, ya), b = buffer_.index(xb, yb);
    // Most neighbours differ by less than any margin; where nothing is seen depth is infinite.
    const float step = std::abs(buffer_.depth[a] - buffer_.depth[b]);
    if (!(step >= least_)) return false;
    if (buffer_.covered(a) != buffer_.covered(b)) return true;
    return buffer_.depth[a] < buffer_.depth[b] ? hides(a, xa, ya, b, xb, yb)
                                               : hides(b, xb, yb, a, xa, ya);
  }

  /** Whether the nearer pixel's tangent plane passes well before the farther pixel's surface. A
   * plane seen from its edge passes nowhere. */
  bool hides(std::size_t near, int xn, int yn, std::size_t far, int xf, int yf) const {
    const float pixel = geometry_.pixelLength(near, xn, yn);
    const float margin = std::max(kPixelsBehind * pixel, least_);
    if (buffer_.depth[far] - buffer_.depth[near] < margin) return false;
    const float planar = geometry_.depthOfPlane(near, xn, yn, xf, yf);
    return !(buffer_.depth[far] - planar <= margin);
  }

  const PixelGeometry& geometry_;
  const GBuffer& buffer_;
  float least_;  ///< step of depth, local units
};

/** Vertices drawn to the middle of their neighbours'; the ends of open lines stay. */
void smooth(PictureLine& line) {
  const std::size_t n = line.points.size();
  for (int round = 0; round < kSmoothings; ++round) {
    const auto old = line.points;
    for (std::size_t i = 0; i < n; ++i) {
      if (!line.closed && (i == 0 || i + 1 == n)) continue;
      const auto &a = old[(i + n - 1) % n], &b = old[(i + 1) % n];
      for (std::size_t k = 0; k < 2; ++k)
        line.points[i][k] = 0.25f * (a[k] + 2.0f * old[i][k] + b[k]);
    }
  }
}

/** Names the links' corners by numbers without gaps. \return the corners by number */
std::vector<std::uint32_t> numberJoints(const GBuffer& buffer, std::vector<Link>& links) {
  NumberedSet set(static_cast<std::size_t>(buffer.width + 1) *
                  static_cast<std::size_t>(buffer.height + 1));
  for (const Link& link : links) {
    for (const std::uint32_t corner : link.joint) set.add(corner);
  }
  std::vector<std::uint32_t> corners(set.count());
  for (Link& link : links) {
    for (std::uint32_t& joint : link.joint) {
      const std::uint32_t number = set.numberOf(joint);
      corners[number] = joint;
      joint = number;
    }
  }
  return corners;
}

/** \brief Lines between pixels where the surface ends or hides what is behind it: the nearer
 * pixel's tangent plane passes the farther one by more than six pixels and .3 % of L. The pixels'
 * edges are smoothed; lines shorter than the least length are left out. */
void traceContours(const PixelGeometry& geometry, double least_length, int threads,
                   std::vector<PictureLine>& lines) {
  const ContourEdges edges(geometry);
  std::vector<std::vector<Link>> rows(static_cast<std::size_t>(geometry.buffer().height));
  parallelFor(rows.size(), threads, 8,
              [&](std::size_t y, int) { rows[y] = edges.row(static_cast<int>(y)); });
  std::vector<Link> links;
  for (const auto& row : rows) links.insert(links.end(), row.begin(), row.end());
  const std::vector<std::uint32_t> corners = numberJoints(geometry.buffer(), links);
  const std::vector<Chain> chains = joinLinks(links, corners.size());
  const std::vector<std::uint8_t> keep = longEnough(chains, corners.size(), least_length);
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (!keep[i]) continue;
    const Chain& chain = chains[i];
    PictureLine line;
    line.kind = PictureLineKind::kContour;
    line.closed = chain.closed;
    for (const std::uint32_t joint : chain.joints)
      line.points.push_back(edges.place(corners[joint]));
    line.strength.assign(line.points.size(), kStrength);
    smooth(line);
    lines.push_back(std::move(line));
  }
}

/** \brief A curvature of every pixel that shows the surface; undefined at other pixels. */
class CurvatureMap {
 public:
  using Kernel = void (*)(const PictureRow&, FrameRow&);

  /** O(pixels), rows in parallel. */
  CurvatureMap(const PixelGeometry& geometry, Kernel kernel, int threads);
  float operator[](std::size_t pixel) const { return values_[pixel]; }

 private:
  std::unique_ptr<float[]> values_;  ///< rows that show nothing take no memory
};

/** \brief The derivative of the greatest curvature along its direction, whose zeros are crest lines
 * where it falls. */
class CrestField : public ZeroField {
 public:
  static constexpr int kRidge = 1, kRavine = 2;  ///< kinds

  /** \param[in] least_curvature 1/local length */
  CrestField(const PixelGeometry& geometry, float least_curvature, int threads);
  void fill(int y, FieldRow& row) const override;
  float mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                    float share, std::size_t axis) const override;
  void measure(const ZeroCrossing& at, std::size_t nearer, int kind,
               LineVertex& vertex) const override;

 private:
  CurvatureMap map_;
  float least_curvature_;
};

/** \brief The radial curvature, whose zeros are suggestive contours where it grows towards the
 * viewer. Its values are all of kind 1. */
class RadialField : public ZeroField {
 public:
  /** \param[in] least_derivative 1/local length squared */
  RadialField(const PixelGeometry& geometry, float least_derivative, int threads);
  void fill(int y, FieldRow& row) const override;
  float mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                    float share, std::size_t axis) const override;
  void measure(const ZeroCrossing& at, std::size_t nearer, int kind,
               LineVertex& vertex) const override;

 private:
  CurvatureMap map_;
  float least_derivative_;
};

/** Curvature with the sign of one kind of line: of the surface, or of the reversed surface; 0 where
 * the other is the larger. */
struct Side {
  const CurvatureMap& map;
  float sign;

  float operator()(std::size_t pixel) const { return std::max(0.0f, sign * map[pixel]); }
};

CurvatureMap::CurvatureMap(const PixelGeometry& geometry, Kernel kernel, int threads)
    : values_(new float[geometry.buffer().numPixels()]) {
  const GBuffer& buffer = geometry.buffer();
  constexpr std::size_t kRows = 8;
  const auto height = static_cast<std::size_t>(buffer.height);
  parallelFor((height + kRows - 1) / kRows, threads, 1, [&](std::size_t slice, int) {
    FrameRow frames(buffer.width);
    for (std::size_t y = slice * kRows; y < std::min(height, (slice + 1) * kRows); ++y) {
      if (geometry.rowIsEmpty(static_cast<int>(y))) continue;
      kernel(geometry.row(static_cast<int>(y)), frames);
      std::copy_n(frames.k.begin(), buffer.width,
                  values_.get() + buffer.index(0, static_cast<int>(y)));
    }
  });
}

CrestField::CrestField(const PixelGeometry& geometry, float least_curvature, int threads)
    : ZeroField(geometry),
      map_(geometry, kernels::crestFrames, threads),
      least_curvature_(least_curvature) {}

void CrestField::fill(int y, FieldRow& row) const {
  std::fill(row.kind.begin(), row.kind.end(), std::uint8_t{0});
  if (geometry_.rowIsEmpty(y)) return;
  kernels::crestFrames(geometry_.row(y), row.frames);
  const std::size_t first = geometry_.buffer().index(0, y);
  for (std::size_t x = 0; x < row.kind.size(); ++x) {
    const float k = row.frames.k[x];
    const Pixel2 screen = {row.frames.screen[0][x], row.frames.screen[1][x]};
    if (std::abs(k) < least_curvature_ || (screen[0] == 0 && screen[1] == 0)) continue;
    const float step = geometry_.differenceStep(first + x, screen);
    const Side side{map_, k > 0 ? 1.0f : -1.0f};
    float before, behind;
    if (!geometry_.sampleBothWays(first + x, screen, step, side, before, behind)) continue;
    row.value[x] = (before - behind) / (2.0f * step);
    row.kind[x] = k > 0 ? kRidge : kRavine;
  }
}

/** The curvature; 0 where k is least between the two, not greatest. */
float CrestField::mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                              float share, std::size_t axis) const {
  const bool grows = a.value[xa] < 0;
  const bool ahead = a.frames.screen[axis][xa] > 0;
  if (grows == ahead) return 0;
  const float k = a.frames.k[xa] + share * (b.frames.k[xb] - a.frames.k[xa]);
  return std::abs(k) / least_curvature_;
}

constexpr float kNearer = 0.5f;  ///< of the way aside, where the rest of it is hidden

/** Curvature aside of a pixel. What is hidden or beyond a border is not known: it counts as equal to
 * the pixel's, and what is seen on the other side counts half.
 * \param[in] way 1 or -1 along the tangent */
float curvatureAside(const PixelGeometry& geometry, std::size_t pixel, const Pixel2& screen,
                     float way, const Side& side) {
  const auto reach =
      static_cast<float>(LineSignificance::kAside) * way * geometry.buffer().radius[pixel];
  float k = 0;
  const bool known = geometry.sampleAside(pixel, screen, reach, side, k) ||
                     geometry.sampleAside(pixel, screen, kNearer * reach, side, k);
  return known ? k : side(pixel);
}

void CrestField::measure(const ZeroCrossing& at, std::size_t nearer, int kind,
                         LineVertex& vertex) const {
  const Side side{map_, kind == kRidge ? 1.0f : -1.0f};
  const float before = curvatureAside(geometry_, nearer, at.screen, 1.0f, side);
  const float behind = curvatureAside(geometry_, nearer, at.screen, -1.0f, side);
  vertex.size = at.most;
  vertex.sharpness = side(nearer);
  const double prominence = lineProminence(vertex.sharpness, before, behind);
  vertex.significance = geometry_.significance(static_cast<float>(prominence), nearer);
}

RadialField::RadialField(const PixelGeometry& geometry, float least_derivative, int threads)
    : ZeroField(geometry),
      map_(geometry, kernels::radialFrames, threads),
      least_derivative_(least_derivative) {}

void RadialField::fill(int y, FieldRow& row) const {
  std::fill(row.kind.begin(), row.kind.end(), std::uint8_t{0});
  if (geometry_.rowIsEmpty(y)) return;
  kernels::radialFrames(geometry_.row(y), row.frames);
  for (auto& column : row.frames.direction) std::fill(column.begin(), column.end(), 0.0f);
  std::copy_n(row.frames.k.begin(), row.value.size(), row.value.begin());
  for (std::size_t x = 0; x < row.kind.size(); ++x) {
    row.kind[x] = row.frames.screen[0][x] != 0 || row.frames.screen[1][x] != 0;
  }
}

float RadialField::mostBetween(const FieldRow&, std::size_t, const FieldRow&, std::size_t, float,
                               std::size_t) const {
  return std::numeric_limits<float>::infinity();
}

/** By the derivative of the curvature along the surface towards the viewer. Beside an edge that a
 * leaf cannot follow its radial curvature changes sign as well: the leaf counts less there. */
void RadialField::measure(const ZeroCrossing& at, std::size_t nearer, int,
                          LineVertex& vertex) const {
  const float step = geometry_.differenceStep(nearer, at.screen);
  const auto read = [&](std::size_t pixel) { return map_[pixel]; };
  float before, behind;
  if (!geometry_.sampleBothWays(nearer, at.screen, step, read, before, behind)) return;
  const float derivative = std::max(0.0f, (before - behind) / (2.0f * step));
  const float reach = LineSignificance::kAside * geometry_.buffer().radius[nearer];
  vertex.size = derivative / least_derivative_;
  vertex.significance = geometry_.significance(reach * derivative, nearer) * geometry_.fit(nearer);
  vertex.sharpness = std::sqrt(derivative);
}

constexpr double kLeastStrength = 1.25;    ///< of a line that is chosen automatically
constexpr double kLeastCurvature = 2.0;    ///< of it [1/L]: flatter is the shape, not a line on it
constexpr double kLeastDerivative = 15.0;  ///< of it [1/L^2]

Error checkBuffer(const GBuffer& buffer, const Camera& camera, const PictureLineParams& params) {
  if (buffer.width != camera.size.width || buffer.height != camera.size.height)
    return {
        ErrorCode::kBadArgument,
        "the G-buffer and the camera differ in size; find lines with the camera it was made by"};
  const std::size_t n = buffer.numPixels();
  const bool bent = buffer.hessian.size() == n && buffer.gradient.size() == n;
  if ((params.crest || params.suggestive) && !(bent && buffer.radius.size() == n))
    return {ErrorCode::kBadArgument,
            "the G-buffer lacks columns; render it with those of pictureLineColumns()"};
  return {};
}

}  // namespace

Result<std::vector<PictureLine>> findPictureLines(const GBuffer& buffer, const Camera& camera,
                                                  const SLIMSurface& surface,
                                                  const PictureLineParams& params) {
  if (Error error = params.validate()) return error;
  if (Error error = camera.validate()) return error;
  if (Error error = checkBuffer(buffer, camera, params)) return error;
  const int threads = resolveThreads(params.threads);
  const PixelGeometry geometry(buffer, camera, surface);
  const double unit = 1.0 / geometry.diagonal();
  std::vector<PictureLine> lines;
  const auto keep = [&](const ZeroTracer& tracer, int field_kind, PictureLineKind kind,
                        bool automatic) {
    LineRule rule;
    rule.least_length = params.min_length;
    rule.least_strength = automatic ? kLeastStrength : 0.0;
    keepStrong(tracer.lines(field_kind, params.min_length, threads), kind, rule, lines);
  };
  if (params.suggestive) {
    const bool automatic = params.suggestive_derivative == 0.0;
    const double least = automatic ? kLeastDerivative : params.suggestive_derivative;
    const RadialField field(geometry, static_cast<float>(least * unit * unit), threads);
    keep(ZeroTracer(field, threads), 1, PictureLineKind::kSuggestive, automatic);
  }
  if (params.crest) {
    const bool automatic = params.crest_curvature == 0.0;
    const double least = automatic ? kLeastCurvature : params.crest_curvature;
    const CrestField field(geometry, static_cast<float>(least * unit), threads);
    const ZeroTracer tracer(field, threads);
    keep(tracer, CrestField::kRavine, PictureLineKind::kRavine, automatic);
    keep(tracer, CrestField::kRidge, PictureLineKind::kRidge, automatic);
  }
  if (params.contour) traceContours(geometry, params.min_length, threads, lines);
  return lines;
}

}  // namespace pcl_slim
