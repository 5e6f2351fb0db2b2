// SPDX-License-Identifier: BSD-3-Clause
// Smooths lines of "x y z" without PCL: the modules alone.
#include <pcl_slim/cloud/point_store.h>
#include <pcl_slim/fit/fit.h>
#include <pcl_slim/query/projection.h>

#include <fstream>
#include <iostream>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "Syntax is: " << argv[0] << " scan.xyz smooth.xyz\n";
    return 2;
  }
  std::ifstream input(argv[1]);
  std::vector<double> xyz;
  for (double value; input >> value;) xyz.push_back(value);

  // A view of points owned by somebody else. The store is their copy in Morton order.
  pcl_slim::CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = pcl_slim::CloudView::Scalar::kDouble;
  view.size = xyz.size() / 3;
  const pcl_slim::Result<pcl_slim::PointStore> store = pcl_slim::PointStore::build(view);
  if (!store) {
    std::cerr << store.error().message << "\n";
    return 2;
  }

  pcl_slim::SLIMSurface surface;
  pcl_slim::Projection projection;
  pcl_slim::Error error = pcl_slim::fitSurface(*store, {}, surface);
  if (!error) error = pcl_slim::projectPoints(*store, surface, {}, projection);
  if (error) {
    std::cerr << error.message << "\n";
    return 1;
  }

  // The store has its own order and units. A power of two scales them, so this is exact.
  const std::vector<std::uint32_t> stored = store->storeOfInput();
  for (std::size_t i = 0; i < view.size; ++i) {
    if (stored[i] == pcl_slim::PointStore::kSkipped) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      xyz[3 * i + axis] =
          store->origin()[axis] + store->scale() * projection.position[stored[i]][axis];
  }
  std::ofstream output(argv[2]);
  output.precision(9);
  for (std::size_t i = 0; i < view.size; ++i)
    output << xyz[3 * i] << ' ' << xyz[3 * i + 1] << ' ' << xyz[3 * i + 2] << '\n';
  return output.flush() ? 0 : 1;
}
