// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** SIMD inner loops of modules/splat, compiled per instruction set and chosen at run time. None
 * depends on the width of vectors: the same numbers everywhere. */
namespace splat_kernels {

/** Box of n points of three floats, stride >= 16 bytes apart, of which four floats are read each.
 * \return false where one is not finite; low and high mean nothing then. */
bool boxOfPoints(const unsigned char* first, std::size_t stride, std::size_t n, float low[3],
                 float high[3]);

/** Three floats of each point of a list, in any order, to columns. stride >= 16 bytes, four floats
 * are read of each point. n: a multiple of 4. */
void gatherVectors(const unsigned char* first, std::size_t stride, const std::uint32_t* points,
                   std::size_t n, float* x, float* y, float* z);

/** OctreeFrame::position in place. n: a multiple of 16, aligned as AlignedVector is. */
void toCells(const OctreeFrame& frame, float* x, float* y, float* z, std::size_t n);

/** Morton codes of positions in root cells, halved depth times; as many as up to the next multiple
 * of 8 are read and written. */
void mortonKeys(const float* x, const float* y, const float* z, std::size_t n, int depth,
                std::uint64_t* keys);

/** Brings vectors to unit length, and to zero what is not finite or has none; those that are unit
 * within 1e-3 of their square stay. Columns have room for whole vectors of 16. */
void normalize(float* x, float* y, float* z, std::size_t n);

/** Squared distance of the farthest of n points from a centre, and which is nearest to it, the
 * first of those that are. Three numbers behind the last are read, and not used. */
float farthestAndNearest(const float* x, const float* y, const float* z, std::size_t n,
                         const float center[3], std::size_t& nearest);

constexpr std::size_t kNumSums = 17;

/** Sums over n points: x y z, x² + y² + z², u v w, uu uv uw vv vw ww, l a b, l² + a² + b².
 * \param[in] columns x y z, normal u v w, Lab l a b; of any alignment; three numbers behind the
 * last are read, and not used. */
void sumPoints(const float* const columns[9], std::size_t n, double sums[kNumSums]);

constexpr std::size_t kCellNumbers = kNumSums + 1;

/** Common normals of n cells: the line n with most of the sum of n n^T, where it is near one line
 * and the normals' sum is along it; else the variance is -1.
 * \param[in] cells rows of how many points there are and then the sums of sumPoints.
 * \param[in] widest variance up to which normals have one axis.
 * \param[out] normals rows of x y z on the side of the sum, and 1 - the line's share. */
void commonNormals(const double* cells, std::size_t n, double widest, double* normals);

}  // namespace splat_kernels
}  // namespace pcl_slim::detail
