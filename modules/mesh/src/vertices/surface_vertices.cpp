// SPDX-License-Identifier: BSD-3-Clause
#include "vertices/surface_vertices.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kMostMove =
    1.0;  ///< widths of a cell that a vertex may move from where its edges cross

/** Stores the probe's result for one vertex. */
void accept(const ProbeSample& sample, std::uint32_t v, SurfaceVertices& vertices) {
  const bool turned = dot(sample.normal, vertices.normal[v]) < 0;
  vertices.position[v] = sample.position;
  vertices.normal[v] = turned ? scaled(sample.normal, -1) : sample.normal;
  vertices.k1[v] = turned ? -sample.frame.k2 : sample.frame.k1;
  vertices.k2[v] = turned ? -sample.frame.k1 : sample.frame.k2;
  vertices.outside[v] = static_cast<float>(sample.outside);
  vertices.supported[v] = 1;
}

/** Evaluates the surface next to some vertices, from the places given. */
void putBlock(SurfaceProbe& probe, const std::uint32_t* which, std::size_t count,
              const Vector3* from, SurfaceVertices& vertices) {
  Vector3 places[SurfaceProbe::kMost], sides[SurfaceProbe::kMost];
  ProbeSample samples[SurfaceProbe::kMost];
  for (std::size_t i = 0; i < count; ++i) {
    places[i] = from[i];
    sides[i] = vertices.normal[which[i]];
  }
  ProbeRequest request;
  request.positions = places;
  request.sides = sides;
  request.count = count;
  for (int step = 0; step < 2; ++step) {
    probe.evaluate(request, samples);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t v = which[i];
      const double most = kMostMove * vertices.size[v];
      if (!samples[i].supported || length(subtract(samples[i].position, from[i])) > most) continue;
      accept(samples[i], v, vertices);
      places[i] = vertices.position[v];
    }
  }
}

/** Which vertices are connected. */
struct Neighbours {
  std::vector<std::uint32_t> begin, triangles;
  std::vector<std::uint8_t> border;

  Neighbours(const std::vector<Triangle>& all, std::size_t count)
      : begin(count + 1, 0), triangles(3 * all.size()), border(count, 0) {
    for (const Triangle& t : all) {
      for (const std::uint32_t v : t) ++begin[v + 1];
    }
    for (std::size_t v = 0; v < count; ++v) begin[v + 1] += begin[v];
    std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
    for (std::uint32_t f = 0; f < all.size(); ++f) {
      for (const std::uint32_t v : all[f]) triangles[at[v]++] = f;
    }
    // Around an inner vertex each neighbour is met twice, once by each triangle at the edge.
    std::vector<std::uint32_t> met;
    for (std::uint32_t v = 0; v < count; ++v) {
      met.clear();
      for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
        for (const std::uint32_t o : all[triangles[i]]) {
          if (o != v) met.push_back(o);
        }
      }
      std::sort(met.begin(), met.end());
      for (std::size_t i = 0; i < met.size(); i += 2) {
        border[v] |= static_cast<std::uint8_t>(i + 1 == met.size() || met[i] != met[i + 1]);
      }
    }
  }
};

/** Where the middle of a vertex's neighbours is, brought into its tangent plane. */
Vector3 middleOf(const std::vector<Triangle>& triangles, const Neighbours& around, std::uint32_t v,
                 const SurfaceVertices& vertices) {
  Vector3 sum{};
  for (std::uint32_t i = around.begin[v]; i < around.begin[v + 1]; ++i) {
    for (const std::uint32_t o : triangles[around.triangles[i]]) {
      if (o != v) sum = along(sum, 1, subtract(vertices.position[o], vertices.position[v]));
    }
  }
  const std::uint32_t degree = around.begin[v + 1] - around.begin[v];
  const Vector3 step = scaled(sum, 0.5 / std::max(degree, 1u));
  const Vector3& n = vertices.normal[v];
  return along(vertices.position[v], 1, along(step, -dot(step, n), n));
}

/** Whether a triangle at v faces away from v's normal, while it did not before. */
bool turnsOver(const std::vector<Triangle>& triangles, const Neighbours& around, std::uint32_t v,
               const std::vector<Vector3>& before, const SurfaceVertices& vertices) {
  for (std::uint32_t i = around.begin[v]; i < around.begin[v + 1]; ++i) {
    const Triangle& t = triangles[around.triangles[i]];
    const auto facing = [&](const std::vector<Vector3>& p) {
      const Vector3 area = cross(subtract(p[t[1]], p[t[0]]), subtract(p[t[2]], p[t[0]]));
      return dot(area, vertices.normal[v]);
    };
    const double old = facing(before);
    if (old > 0 && facing(vertices.position) < 0.1 * old) return true;
  }
  return false;
}

}  // namespace

void SurfaceVertices::resize(std::size_t count) {
  position.resize(count);
  normal.resize(count);
  k1.resize(count, 0);
  k2.resize(count, 0);
  outside.resize(count, 0);
  size.resize(count, 0);
  on_border.resize(count, 0);
  supported.resize(count, 0);
}

void putOnSurface(const ProbeField& field, std::vector<std::uint32_t> which,
                  SurfaceVertices& vertices) {
  forProbeBlocks(field, which.size(), [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
    Vector3 from[SurfaceProbe::kMost];
    for (std::size_t i = 0; i < n; ++i) from[i] = vertices.position[which[first + i]];
    putBlock(probe, which.data() + first, n, from, vertices);
  });
}

void relax(const ProbeField& field, const std::vector<Triangle>& triangles, int rounds,
           SurfaceVertices& vertices) {
  if (rounds == 0) return;
  const Neighbours around(triangles, vertices.count());
  std::vector<std::uint32_t> moving;
  for (std::uint32_t v = 0; v < vertices.count(); ++v) {
    if (vertices.supported[v] != 0 && around.border[v] == 0) moving.push_back(v);
  }
  for (int round = 0; round < rounds; ++round) {
    const SurfaceVertices before = vertices;
    std::vector<Vector3> to(moving.size());
    parallelFor(moving.size(), field.threads, 1024, [&](std::size_t i, int) {
      to[i] = middleOf(triangles, around, moving[i], before);
    });
    forProbeBlocks(field, moving.size(),
                   [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
                     putBlock(probe, moving.data() + first, n, to.data() + first, vertices);
                   });
    // Back go those that turned a triangle over; once more for what that turned over in its turn.
    for (int again = 0; again < 3; ++again) {
      std::vector<std::uint8_t> back(moving.size(), 0);
      parallelFor(moving.size(), field.threads, 1024, [&](std::size_t i, int) {
        back[i] = turnsOver(triangles, around, moving[i], before.position, vertices) ? 1 : 0;
      });
      for (std::size_t i = 0; i < moving.size(); ++i) {
        if (back[i] == 0) continue;
        const std::uint32_t v = moving[i];
        vertices.position[v] = before.position[v];
        vertices.normal[v] = before.normal[v];
        vertices.k1[v] = before.k1[v];
        vertices.k2[v] = before.k2[v];
        vertices.outside[v] = before.outside[v];
      }
    }
  }
}

}  // namespace pcl_slim::detail
