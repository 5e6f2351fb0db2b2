// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "pcl_slim/filters/io/point_file.h"
#include "support/temporary_folder.h"

namespace pcl_slim_test {

/** A point's value of a named field; not a number where there is none. */
inline double value(const pcl_slim::PointFile& file, const char* name, std::size_t point) {
  const int field = pcl_slim::findField(file.cloud, name);
  EXPECT_GE(field, 0) << name;
  return field < 0 ? NAN
                   : pcl_slim::fieldValue(file.cloud, point,
                                          file.cloud.fields[static_cast<std::size_t>(field)]);
}

/** A file of a text, read; the format is that of its name. */
inline pcl_slim::Result<pcl_slim::PointFile> loadText(const std::string& name,
                                                      const std::string& text) {
  const TemporaryFolder folder;
  writeText(folder / name, text);
  return pcl_slim::loadPointFile(folder / name);
}

}  // namespace pcl_slim_test
