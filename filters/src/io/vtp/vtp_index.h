// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/vtp/vtp_file.h"

namespace pcl_slim {

/** Writes points in pieces as VTK's parallel XML PolyData: NAME.pvtp, and NAME_0.vtp ... in the folder NAME. */
class VtpIndex {
 public:
  explicit VtpIndex(const std::string& path);

  /** Writes a piece. */
  Error add(const PointFile& piece);
  /** Writes the index: the arrays that all pieces have. */
  Error finish();

 private:
  std::string path_, name_, folder_;
  std::size_t pieces_ = 0;
  std::vector<VtpColumn> columns_;
};

/** The files that an index names, in their order; an error where it names none. */
Result<std::vector<std::string>>
vtpPieces(const std::string& path);

}  // namespace pcl_slim
