// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/parallel.h"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace pcl_slim {

int
resolveThreads(int requested)
{
  if (requested > 0) return requested;
#ifdef _OPENMP
  return omp_get_num_procs();
#else
  return 1;
#endif
}

}  // namespace pcl_slim
