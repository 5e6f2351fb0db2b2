// SPDX-License-Identifier: BSD-3-Clause
// Zeros of a field over the pixels as lines: geometry of a frame, links joined into chains,
// marching squares.
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "lines/lines.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/leaf_noise.h"

namespace pcl_slim::detail {

namespace {

constexpr double kDepthStep = 0.03;  ///< [L]
constexpr float kStep = 2.0f;        ///< pixels over which k is differenced, at least
constexpr float kRadiusStep = 0.1f;  ///< of the leaf's radius, at least

std::array<float, 3> toFloat(const Vector3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

PixelGeometry::PixelGeometry(const GBuffer& buffer, const Camera& camera,
                             const SLIMSurface& surface)
    : buffer_(buffer),
      surface_(surface),
      rays_(camera, surface.info.origin, surface.info.scale),
      perspective_(camera.projection == Camera::Projection::kPerspective),
      diagonal_(surface.info.diagonal),
      noise_(surface.info),
      step_(static_cast<float>(kDepthStep * diagonal_)) {
  const CameraAxes axes(camera);
  right_ = toFloat(axes.right);
  up_ = toFloat(axes.up);
  forward_ = toFloat(axes.forward);
}

PictureRow PixelGeometry::row(int y) const {
  const std::size_t first = buffer_.index(0, y);
  const auto [left, height] = rays_.inPlane(0, y);
  return {buffer_.depth.data() + first,
          buffer_.normal[first].data(),
          buffer_.gradient[first].data(),
          buffer_.hessian[first].data(),
          buffer_.width,
          static_cast<float>(left),
          static_cast<float>(height),
          static_cast<float>(rays_.pixel()),
          perspective_,
          right_,
          up_,
          forward_};
}

bool PixelGeometry::rowIsEmpty(int y) const {
  const std::uint32_t* const begin = buffer_.surfel.data() + buffer_.index(0, y);
  return std::all_of(begin, begin + buffer_.width,
                     [](std::uint32_t surfel) { return surfel == GBuffer::kNothing; });
}

float PixelGeometry::pixelLength(std::size_t pixel, int x, int y) const {
  const Ray ray = rays_.ray(x, y);
  return static_cast<float>(
      rays_.pixelLength(along(ray.origin, buffer_.depth[pixel], ray.direction)));
}

float PixelGeometry::depthOfPlane(std::size_t pixel, int x, int y, int other_x, int other_y) const {
  const Ray own = rays_.ray(x, y), ray = rays_.ray(other_x, other_y);
  const auto& n = buffer_.normal[pixel];
  const Vector3 normal = {n[0], n[1], n[2]};
  const Vector3 point = along(own.origin, buffer_.depth[pixel], own.direction);
  const double slope = dot(normal, ray.direction);
  const double height = dot(normal, subtract(point, ray.origin));
  const double depth = slope != 0 ? height / slope : -1.0;
  return depth > 0 ? static_cast<float>(depth) : -std::numeric_limits<float>::infinity();
}

float PixelGeometry::differenceStep(std::size_t pixel, const Pixel2& screen) const {
  const float pixels = std::sqrt(screen[0] * screen[0] + screen[1] * screen[1]);
  const float step = std::max(kStep, kRadiusStep * buffer_.radius[pixel] * pixels);
  return step / pixels;
}

float PixelGeometry::significance(float difference, std::size_t pixel) const {
  const std::uint32_t leaf = buffer_.surfel[pixel];
  return static_cast<float>(
      noise_.significance(difference, surface_.radius[leaf], equivalentCount(surface_, leaf)));
}

Vector3 PixelGeometry::position(float x, float y, float depth) const {
  const auto [left, top] = rays_.inPlane(0, 0);
  const Vector3 plane = {left + double{x} * rays_.pixel(), top - double{y} * rays_.pixel(), 1.0};
  if (!perspective_) return {plane[0], plane[1], depth};
  return scaled(plane, depth / pcl_slim::length(plane));
}

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

class Joiner {
 public:
  Joiner(const std::vector<Link>& links, std::size_t num_joints)
      : links_(links), meetings_(num_joints), used_(links.size(), 0) {
    for (std::uint32_t i = 0; i < links.size(); ++i) {
      for (const std::uint32_t joint : links[i].joint) {
        Meeting& meeting = meetings_[joint];
        if (meeting.count < 2) meeting.link[meeting.count] = i;
        ++meeting.count;
      }
    }
  }

  std::vector<Chain> join() {
    std::vector<Chain> chains;
    // First the lines that have ends, then what is left: rings.
    for (const bool rings : {false, true}) {
      for (std::uint32_t i = 0; i < links_.size(); ++i) {
        for (const std::uint32_t joint : links_[i].joint) {
          if (used_[i] || (!rings && meetings_[joint].count == 2)) continue;
          chains.push_back(follow(i, joint));
          if (!rings) continue;
          chains.back().closed = true;
          chains.back().joints.pop_back();
        }
      }
    }
    return chains;
  }

 private:
  struct Meeting {
    std::array<std::uint32_t, 2> link{kNone, kNone};
    std::uint32_t count = 0;
  };

  Chain follow(std::uint32_t link, std::uint32_t joint) {
    Chain chain;
    chain.joints.push_back(joint);
    while (!used_[link]) {
      used_[link] = 1;
      const auto& ends = links_[link].joint;
      joint = ends[0] == joint ? ends[1] : ends[0];
      chain.joints.push_back(joint);
      const Meeting& meeting = meetings_[joint];
      if (meeting.count != 2) break;
      link = meeting.link[0] == link ? meeting.link[1] : meeting.link[0];
    }
    return chain;
  }

  const std::vector<Link>& links_;
  std::vector<Meeting> meetings_;
  std::vector<std::uint8_t> used_;
};

/** Sets of chains that meet at their ends. */
class Meetings {
 public:
  Meetings(const std::vector<Chain>& chains, std::size_t num_joints)
      : first_(num_joints, kNone), parent_(chains.size()), length_(chains.size()) {
    for (std::uint32_t i = 0; i < chains.size(); ++i) {
      parent_[i] = i;
      length_[i] = chains[i].joints.size();
    }
    for (std::uint32_t i = 0; i < chains.size(); ++i) {
      if (chains[i].closed) continue;
      for (const std::uint32_t joint : {chains[i].joints.front(), chains[i].joints.back()}) {
        std::uint32_t& other = first_[joint];
        if (other == kNone) {
          other = i;
        } else {
          join(i, other);
          shared_.insert(joint);
        }
      }
    }
  }

  bool isShared(std::uint32_t joint) const { return shared_.count(joint) != 0; }
  std::size_t lengthAround(std::uint32_t chain) { return length_[rootOf(chain)]; }

 private:
  std::uint32_t rootOf(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = rootOf(a);
    b = rootOf(b);
    if (a == b) return;
    parent_[a] = b;
    length_[b] += length_[a];
  }

  std::vector<std::uint32_t> first_, parent_;
  std::vector<std::size_t> length_;
  std::unordered_set<std::uint32_t> shared_;
};

}  // namespace

std::vector<std::uint8_t> longEnough(const std::vector<Chain>& chains, std::size_t num_joints,
                                     double least_length) {
  Meetings meetings(chains, num_joints);
  std::vector<std::uint8_t> keep(chains.size());
  for (std::uint32_t i = 0; i < chains.size(); ++i) {
    const Chain& chain = chains[i];
    keep[i] = static_cast<double>(chain.joints.size()) >= least_length;
    if (keep[i] || chain.closed) continue;
    keep[i] = meetings.isShared(chain.joints.front()) && meetings.isShared(chain.joints.back()) &&
              static_cast<double>(meetings.lengthAround(i)) >= least_length;
  }
  return keep;
}

std::vector<Chain> joinLinks(const std::vector<Link>& links, std::size_t num_joints) {
  return Joiner(links, num_joints).join();
}

namespace {

constexpr std::size_t kBandRows = 16;
constexpr double kLongestLink = 1.4143;  ///< pixels: across a cell
constexpr float kNowhere = -1.0f;

/** Where a field crosses zero between two neighbours, as a share of the way; kNowhere: nowhere. */
float crossingBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb) {
  if (a.kind[xa] == 0 || a.kind[xa] != b.kind[xb]) return kNowhere;
  const auto &da = a.frames.direction, &db = b.frames.direction;
  const float along = da[0][xa] * db[0][xb] + da[1][xa] * db[1][xb] + da[2][xa] * db[2][xb];
  const float at_a = a.value[xa], at_b = along >= 0 ? b.value[xb] : -b.value[xb];
  return (at_a < 0) == (at_b < 0) ? kNowhere : at_a / (at_a - at_b);
}

}  // namespace

FieldRow::FieldRow(int width)
    : frames(width),
      value(static_cast<std::size_t>(width)),
      kind(static_cast<std::size_t>(width)) {}

/** Iterates over some rows and stores two of them at a time. */
class ZeroTracer::BandScan {
 public:
  BandScan(const ZeroField& field, Band& found)
      : field_(field),
        found_(found),
        width_(static_cast<std::size_t>(field.geometry().buffer().width)),
        upper_(static_cast<int>(width_)),
        lower_(upper_),
        across_(width_, kNowhere),
        next_across_(width_, kNowhere),
        down_(width_, kNowhere) {}

  /** \param[in] end row behind the last; height of the picture */
  void scan(std::size_t begin, std::size_t end, std::size_t height) {
    load(begin, lower_, next_across_);
    for (std::size_t y = begin; y < end; ++y) {
      std::swap(upper_, lower_);
      std::swap(across_, next_across_);
      const bool last = y + 1 == height;
      if (!last) load(y + 1, lower_, next_across_);
      for (std::size_t x = 0; x < width_; ++x) {
        down_[x] = last ? kNowhere : crossingBetween(upper_, x, lower_, x);
      }
      collect(y * width_);
      if (!last) link(y * width_);
    }
  }

 private:
  void load(std::size_t y, FieldRow& row, std::vector<float>& across) const {
    field_.fill(static_cast<int>(y), row);
    for (std::size_t x = 0; x + 1 < width_; ++x) across[x] = crossingBetween(row, x, row, x + 1);
  }

  /** Crossings to the right of the upper row's pixels and below them. */
  void collect(std::size_t first) {
    for (std::size_t x = 0; x < width_; ++x) {
      if (across_[x] >= 0) add(2 * (first + x), across_[x], x, upper_, x + 1);
      if (down_[x] >= 0) add(2 * (first + x) + 1, down_[x], x, lower_, x);
    }
  }

  void add(std::size_t edge, float share, std::size_t xa, const FieldRow& other, std::size_t xb) {
    const float most = field_.mostBetween(upper_, xa, other, xb, share, edge % 2);
    const auto& screen = share < 0.5f ? upper_.frames.screen : other.frames.screen;
    const std::size_t x = share < 0.5f ? xa : xb;
    found_[upper_.kind[xa] - 1].crossings.push_back(
        {static_cast<std::uint32_t>(edge), share, most, {screen[0][x], screen[1][x]}});
  }

  /** The piece of a line through each cell below and right of an upper pixel, if there is one. */
  void link(std::size_t first) {
    for (std::size_t x = 0; x + 1 < width_; ++x) {
      const float shares[] = {across_[x], down_[x], down_[x + 1], next_across_[x]};
      const int count = (shares[0] >= 0) + (shares[1] >= 0) + (shares[2] >= 0) + (shares[3] >= 0);
      const int kind = count == 2 ? kindOfCell(x) : 0;
      if (kind == 0) continue;
      const std::size_t top = 2 * (first + x);
      const std::size_t edges[] = {top, top + 1, top + 3, top + 2 * width_};
      Link link;
      std::size_t joints = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        if (shares[i] >= 0) link.joint[joints++] = static_cast<std::uint32_t>(edges[i]);
      }
      found_[static_cast<std::size_t>(kind) - 1].links.push_back(link);
    }
  }

  /** The kind of at least three of a cell's corners, 0 where there is none. */
  int kindOfCell(std::size_t x) const {
    const std::uint8_t corners[] = {upper_.kind[x], upper_.kind[x + 1], lower_.kind[x],
                                    lower_.kind[x + 1]};
    const bool first = corners[0] == corners[1] || corners[0] == corners[2];
    const std::uint8_t kind = first ? corners[0] : corners[1];
    return std::count(corners, corners + 4, kind) >= 3 ? kind : 0;
  }

  const ZeroField& field_;
  Band& found_;
  std::size_t width_;
  FieldRow upper_, lower_;
  std::vector<float> across_, next_across_, down_;  ///< crossings to the right and below
};

ZeroTracer::ZeroTracer(const ZeroField& field, int threads) : field_(field) {
  const auto height = static_cast<std::size_t>(field.geometry().buffer().height);
  bands_.resize((height + kBandRows - 1) / kBandRows);
  parallelFor(bands_.size(), threads, 1, [&](std::size_t i, int) {
    BandScan scan(field, bands_[i]);
    scan.scan(i * kBandRows, std::min(height, (i + 1) * kBandRows), height);
  });
}

void ZeroTracer::addVertex(const ZeroCrossing& at, int kind, ZeroLine& line) const {
  const auto width = static_cast<std::uint32_t>(field_.geometry().buffer().width);
  const std::uint32_t a = at.edge / 2;
  const bool down = at.edge % 2 != 0;
  const std::uint32_t row = a / width;
  const auto x = static_cast<float>(a % width), y = static_cast<float>(row);
  const std::uint32_t b = a + (down ? width : 1), nearer = at.share < 0.5f ? a : b;
  const PixelGeometry& geometry = field_.geometry();
  const std::vector<float>& depth = geometry.buffer().depth;
  LineVertex& vertex = line.vertices.emplace_back();
  vertex.x = down ? x : x + at.share;
  vertex.y = down ? y + at.share : y;
  vertex.radius = geometry.buffer().radius[nearer];
  vertex.position =
      geometry.position(vertex.x, vertex.y, depth[a] + at.share * (depth[b] - depth[a]));
  if (at.most >= 1.0f) field_.measure(at, nearer, kind, vertex);
}

std::vector<ZeroLine> ZeroTracer::lines(int kind, double least_length, int threads) const {
  std::vector<ZeroCrossing> crossings;
  std::vector<Link> links;
  for (const Band& band : bands_) {
    const Found& found = band[static_cast<std::size_t>(kind) - 1];
    crossings.insert(crossings.end(), found.crossings.begin(), found.crossings.end());
    links.insert(links.end(), found.links.begin(), found.links.end());
  }
  NumberedSet edges(2 * field_.geometry().buffer().numPixels());
  for (const ZeroCrossing& crossing : crossings) edges.add(crossing.edge);
  edges.count();
  for (Link& link : links) {
    for (std::uint32_t& joint : link.joint) joint = edges.numberOf(joint);
  }
  const std::vector<Chain> chains = joinLinks(links, crossings.size());
  std::vector<ZeroLine> lines(chains.size());
  parallelFor(chains.size(), threads, 8, [&](std::size_t i, int) {
    const auto& joints = chains[i].joints;
    if (kLongestLink * static_cast<double>(joints.size() - 1) < least_length) return;
    const bool reaches = std::any_of(joints.begin(), joints.end(), [&](std::uint32_t joint) {
      return crossings[joint].most >= kReachedSize;
    });
    if (!reaches) return;
    lines[i].closed = chains[i].closed;
    for (const std::uint32_t joint : joints) addVertex(crossings[joint], kind, lines[i]);
  });
  return lines;
}

}  // namespace pcl_slim::detail
