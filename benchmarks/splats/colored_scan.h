// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/splat/splat_sampling.h"
#include "scan/cloud_file.h"

namespace pcl_slim::measure {

/** \brief A coloured scan with normals: its own, or estimated once, so that every method that is
 * compared has the same ones. */
struct ColoredScan {
  CloudFile file;
  ColorView colors;
  bool give_normals = true;  ///< false: the sampler estimates its own

  CloudView view() const { return file.view(); }
  std::size_t size() const { return file.size() - file.num_non_finite; }
};

/** \brief Loads a scan and estimates its normals where it has none (16 neighbours, as the sampler
 * does). \return an error for a file without points or colours. */
Result<ColoredScan> loadColoredScan(const std::string& path);

/** \brief Splats of a scan; stops the program with a message where that fails. */
SplatSet splatsOf(const ColoredScan& scan, const SplatParams& params);

}  // namespace pcl_slim::measure
