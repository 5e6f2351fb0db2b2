// SPDX-License-Identifier: BSD-3-Clause
// Smooths lines of "x y z" without PCL: the modules alone.
#include <pcl_slim/scan/scan.h>

#include <array>
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

  // A view of points owned by somebody else.
  pcl_slim::CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = pcl_slim::CloudView::Scalar::kDouble;
  view.size = xyz.size() / 3;
  pcl_slim::FittedScan fitted;
  if (const pcl_slim::Error error = pcl_slim::fitScan({view, {}}, {}, fitted)) {
    std::cerr << error.message << "\n";
    return 1;
  }
  const auto projection = pcl_slim::projectScan(
      view, fitted.surface, pcl_slim::SurfaceOrigin::kFitted, {}, {}, nullptr, &fitted.store);
  if (!projection) {
    std::cerr << projection.error().message << "\n";
    return 1;
  }

  // Points that no surfel supports keep their place.
  std::vector<double> smooth = xyz;
  for (std::size_t i = 0; i < view.size; ++i) {
    if (!projection->isSupported(i)) continue;
    const std::array<double, 3> place = projection->point(i).position;
    for (std::size_t axis = 0; axis < 3; ++axis) smooth[3 * i + axis] = place[axis];
  }
  std::ofstream output(argv[2]);
  output.precision(9);
  for (std::size_t i = 0; i < view.size; ++i)
    output << smooth[3 * i] << ' ' << smooth[3 * i + 1] << ' ' << smooth[3 * i + 2] << '\n';
  return output.flush() ? 0 : 1;
}
