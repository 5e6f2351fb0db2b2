#pragma once
#include <functional>
#include "mesh/measures.h"
namespace pcl_slim::mesh_bench {
void
ours(const Pair& pair, const std::string& options,
     const std::function<void(const std::string&, const std::string&, const Measures&, double)>&
         print);
}
