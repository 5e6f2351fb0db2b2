// SPDX-License-Identifier: BSD-3-Clause
#include "orientation.h"

namespace pcl_slim {
void
orientSurface(const FitParams&, SLIMSurface&)
{
}
}  // namespace pcl_slim
