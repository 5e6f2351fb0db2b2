// SPDX-License-Identifier: BSD-3-Clause
// Borders and levels of detail by the graphics card against those of the CPU.
#include <cmath>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "visualization/card_window.h"

namespace pcl_slim::test {
namespace {

/** \brief A wavy dome of 8000 points, open below and with a hole at its top, fitted. */
std::shared_ptr<SLIMSurface> openDome(int degree) {
  constexpr int kCount = 8000;
  std::vector<double> points;
  std::vector<float> normals;
  for (int i = 0; i < kCount; ++i) {
    const double z = (i + 0.5) / kCount, rho = std::sqrt(1.0 - z * z), angle = 2.39996323 * i;
    if (z > 0.97) continue;
    const double radius = 0.25 * (1.0 + 0.02 * std::sin(6.0 * angle) * rho);
    for (const double n : {rho * std::cos(angle), rho * std::sin(angle), z}) {
      points.push_back(radius * n);
      normals.push_back(static_cast<float>(n));
    }
  }
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size() / 3;
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  auto store = PointStore::build(view, 1);
  EXPECT_TRUE(store);
  FitParams params;
  params.degree = degree;
  auto surface = std::make_shared<SLIMSurface>();
  const Error error = fitSurface(*store, params, *surface);
  EXPECT_FALSE(error) << error.message;
  return surface;
}

/** \brief Trim maps, of leaves and internal surfels alike, that end a surface below a height (local
 * units). */
void trimBelow(double height, SLIMSurface& surface) {
  constexpr int kSide = 33;
  std::vector<std::uint8_t> sides(surface.size(), kSide), bits;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
    std::vector<std::uint8_t> map(TrimMap::numBytes(kSide));
    for (int k = 0; k < kSide * kSide; ++k) {
      const double u = 2.0 * (k % kSide) / (kSide - 1) - 1.0;
      const double v = 2.0 * (k / kSide) / (kSide - 1) - 1.0;
      const double h = evaluateJet(surface.degree[i], surface.coefficientsOf(i), u, v).h;
      const double up = u * frame.u[2] + v * frame.v[2] + h * frame.w[2];
      const bool inside = surface.cz[i] + surface.radius[i] * up > height;
      map[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(inside << (k & 7));
    }
    bits.insert(bits.end(), map.begin(), map.end());
  }
  surface.setTrimMaps(sides, bits);
}

class CardSurfels : public CardTest, public ::testing::WithParamInterface<int> {
 protected:
  CardSurfels() {
    surface = openDome(GetParam());
    // What is left of it ends well above its rim.
    const double low = *std::min_element(surface->cz.begin(), surface->cz.end());
    const double high = *std::max_element(surface->cz.begin(), surface->cz.end());
    trimBelow(low + 0.3 * (high - low), *surface);
    mapper->setSurface(surface);
    mapper->setMode(DisplayMode::kNormal);
    renderer->GetActiveCamera()->SetPosition(0.3, -1.1, 0.4);
    renderer->ResetCameraClippingRange();
  }

  std::shared_ptr<SLIMSurface> surface;
};

TEST_P(CardSurfels, SurfacesEndWhereTheirTrimMapsEnd) {
  ASSERT_TRUE(surface->hasTrimMaps());
  EXPECT_LE(difference(), 2.0 * kFewPixels);
  const Image trimmed = pictureBy(RayBackend::kOpenGL);
  mapper->setTrimming(false);
  EXPECT_LE(difference(), 2.0 * kFewPixels);
  // What reaches beyond the data is drawn now.
  const Image whole = pictureBy(RayBackend::kOpenGL);
  EXPECT_GT(shareDrawn(whole), shareDrawn(trimmed));
  EXPECT_GT(shareDifferent(whole, trimmed, 2), 0.02);
}

TEST_P(CardSurfels, CoarserSurfelsStandForTheirDescendants) {
  const Image fine = pictureBy(RayBackend::kOpenGL);
  for (const double pixels : {8.0, 20.0, 40.0}) {
    mapper->setLevelOfDetail(pixels);
    EXPECT_LE(difference(), kFewPixels) << pixels;
  }
  const Image coarse = pictureBy(RayBackend::kOpenGL);
  EXPECT_GT(shareDifferent(fine, coarse, 2), 0.005);
  // Coarse surfels end where its leaves do.
  mapper->setTrimming(false);
  const double whole = shareDrawn(pictureBy(RayBackend::kCPU));
  mapper->setTrimming(true);
  EXPECT_LT(shareDrawn(coarse) - shareDrawn(fine), 0.2 * (whole - shareDrawn(fine)));
  // Back at every leaf, and with the internal surfels on the card, nothing has changed.
  mapper->setLevelOfDetail(0.0);
  EXPECT_EQ(shareDifferent(fine, pictureBy(RayBackend::kOpenGL), 0), 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, CardSurfels, ::testing::Values(2, 4));

TEST_F(CardTest, CoarserSurfelsHaveTheirOwnSizes) {
  const auto surface = openDome(2);
  surface->dropTrimMaps();  // so that a coarse surfel's level of detail goes by its error
  mapper->setSurface(surface);
  mapper->setMode(DisplayMode::kSize);
  mapper->setLevelOfDetail(20.0);
  EXPECT_LE(difference(), kFewPixels);
}

TEST_F(CardTest, ANewLevelOfDetailIsANewFrame) {
  mapper->setSurface(openDome(2));
  for (const RayBackend backend : {RayBackend::kCPU, RayBackend::kOpenGL}) {
    pictureBy(backend);
    const std::uint64_t before = mapper->getStatistics().rasterized;
    mapper->setLevelOfDetail(30.0);
    picture();
    picture();
    EXPECT_EQ(mapper->getStatistics().rasterized, before + 1);
    mapper->setLevelOfDetail(std::nan(""));
    EXPECT_EQ(mapper->getLevelOfDetail(), 0.0);
  }
}

}  // namespace
}  // namespace pcl_slim::test
