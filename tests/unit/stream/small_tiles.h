// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/stream/stream_fit.h"

namespace pcl_slim_test {

/** Tiles so small that a test's cloud has several. */
inline pcl_slim::StreamParams smallTiles(int threads = 1) {
  pcl_slim::StreamParams params;
  params.tile_points = 20000;
  params.fit.threads = threads;
  return params;
}

}  // namespace pcl_slim_test
