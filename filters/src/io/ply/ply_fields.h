// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <vector>

#include "io/ply/ply_header.h"

namespace pcl_slim {

/** Gives PLY's properties PCL's names, and packs red green blue (alpha) bytes into rgb (rgba). */
void
adoptPclFields(pcl::PCLPointCloud2& cloud);

/** PLY's columns for a cloud's fields: the inverse of adoptPclFields. */
Error
plyColumns(const pcl::PCLPointCloud2& cloud, std::vector<PlyColumn>& columns);

}  // namespace pcl_slim
