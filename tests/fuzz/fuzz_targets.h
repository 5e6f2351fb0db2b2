// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

/** What is fed with any bytes and must neither crash nor hang nor hand out what it would refuse
 * itself. Each returns 0; whatever else is wrong ends the process. */
namespace pcl_slim_test {

/** decodeSlim(), and what it accepts written and read again. */
int fuzzSlim(const std::uint8_t* bytes, std::size_t size);

/** A small cloud of any floats through fit, projection, splats and both rasterisers. */
int fuzzClouds(const std::uint8_t* bytes, std::size_t size);

/** Files by those names: points, then surfaces and splats made of them. */
int fuzzPcd(const std::uint8_t* bytes, std::size_t size);
int fuzzPly(const std::uint8_t* bytes, std::size_t size);
int fuzzLas(const std::uint8_t* bytes, std::size_t size);
int fuzzText(const std::uint8_t* bytes, std::size_t size);
int fuzzMesh(const std::uint8_t* bytes, std::size_t size);
int fuzzVtp(const std::uint8_t* bytes, std::size_t size);

/** A camera file, and what it accepts written and read again. */
int fuzzCamera(const std::uint8_t* bytes, std::size_t size);

}  // namespace pcl_slim_test
