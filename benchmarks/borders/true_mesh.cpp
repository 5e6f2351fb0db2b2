// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <utility>

#include "borders/reconstructions.h"

namespace pcl_slim::borders {
namespace {

/** \brief The squares of a sheet's chart whose middles it contains, as triangles. */
class SheetSquares {
 public:
  SheetSquares(const OpenScene& scene, const Sheet& sheet, TriangleMesh& mesh)
      : scene_(scene), sheet_(sheet), mesh_(mesh) {
    for (std::size_t a = 0; a < 2; ++a) {
      count_[a] = static_cast<int>(std::ceil((sheet.high[a] - sheet.low[a]) / kSquare));
      step_[a] = (sheet.high[a] - sheet.low[a]) / count_[a];
    }
  }

  void add() {
    for (int row = 0; row < count_[1]; ++row) {
      for (int column = 0; column < count_[0]; ++column) {
        if (!sheet_.contains(at(column + 0.5, row + 0.5))) continue;
        const std::uint32_t corners[4] = {vertex(column, row), vertex(column + 1, row),
                                          vertex(column + 1, row + 1), vertex(column, row + 1)};
        addTriangle({corners[0], corners[1], corners[2]});
        addTriangle({corners[0], corners[2], corners[3]});
      }
    }
  }

 private:
  static constexpr double kSquare = 0.4;  ///< spacings

  Flat at(double column, double row) const {
    return {sheet_.low[0] + column * step_[0], sheet_.low[1] + row * step_[1]};
  }

  std::uint32_t vertex(int column, int row) {
    const bool pole = sheet_.whole && (row == 0 || row == count_[1]);
    const std::pair<int, int> key{pole ? 0 : sheet_.isBand() ? column % count_[0] : column, row};
    const auto [found, fresh] = numbers_.emplace(key, mesh_.vertices.size());
    if (fresh) mesh_.vertices.push_back(scene_.fromCharts(sheet_.chart->place(at(column, row))));
    return static_cast<std::uint32_t>(found->second);
  }

  void addTriangle(const std::array<std::uint32_t, 3>& t) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh_.triangles.push_back(t);
  }

  const OpenScene& scene_;
  const Sheet& sheet_;
  TriangleMesh& mesh_;
  int count_[2] = {};
  double step_[2] = {};
  std::map<std::pair<int, int>, std::size_t> numbers_;
};

}  // namespace

void trueMesh(const OpenScene& scene, TriangleMesh& mesh) {
  mesh.clear();
  for (const Sheet& sheet : scene.sheets) SheetSquares(scene, sheet, mesh).add();
  mesh.normals.assign(mesh.vertices.size(), {0.0f, 0.0f, 1.0f});
}

}  // namespace pcl_slim::borders
