// SPDX-License-Identifier: BSD-3-Clause
#include "lines/contours.h"

#include <algorithm>
#include <cmath>

#include "lines/chains.h"
#include "lines/numbered_set.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

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
        least_(static_cast<float>(kShareBehind * geometry.diagonal()))
  {
  }

  /** Edges above and left of a row's pixels; corners are numbered row by row from the upper left. */
  std::vector<Link> row(int y) const
  {
    std::vector<Link> links;
    for (int x = 0; x < buffer_.width; ++x) {
      if (x > 0 && parted(x - 1, y, x, y)) links.push_back({{corner(x, y), corner(x, y + 1)}});
      if (y > 0 && parted(x, y - 1, x, y)) links.push_back({{corner(x, y), corner(x + 1, y)}});
    }
    return links;
  }

  std::array<float, 2> place(std::uint32_t corner) const
  {
    const auto across = static_cast<std::uint32_t>(buffer_.width + 1);
    const std::uint32_t x = corner % across, y = corner / across;
    return {static_cast<float>(x) - 0.5f, static_cast<float>(y) - 0.5f};
  }

 private:
  std::uint32_t corner(int x, int y) const
  {
    return static_cast<std::uint32_t>(y * (buffer_.width + 1) + x);
  }

  bool parted(int xa, int ya, int xb, int yb) const
  {
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
  bool hides(std::size_t near, int xn, int yn, std::size_t far, int xf, int yf) const
  {
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
void
smooth(PictureLine& line)
{
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
std::vector<std::uint32_t>
numberJoints(const GBuffer& buffer, std::vector<Link>& links)
{
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

}  // namespace

void
traceContours(const PixelGeometry& geometry, double least_length, int threads,
              std::vector<PictureLine>& lines)
{
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

}  // namespace pcl_slim::detail
