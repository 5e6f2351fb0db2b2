// SPDX-License-Identifier: BSD-3-Clause
// A page's text; what browsers make of it is tested in tests/web.
#include "pcl_slim/web/page.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

std::string pageOf(const PageParams& params, const ShadingParams& shading = {},
                   RenderParams rendering = {}) {
  const SLIMSurface sphere = sphereSurface(2, kSphere, 200, 0.08);
  const auto page = encodePage(sphere, frontCamera(), rendering, shading, params);
  EXPECT_TRUE(page) << page.error().message;
  return page ? *page : std::string();
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST(Page, IsFilledAndAlone) {
  const std::string page = pageOf({});
  EXPECT_EQ(countOf(page, "<!--"), 1u);  // the licence: no place is left empty
  EXPECT_EQ(countOf(page, "http:") + countOf(page, "https:"), 0u);
  EXPECT_EQ(countOf(page, "default-src 'none'"), 1u);
  EXPECT_EQ(page, pageOf({}));
}

TEST(Page, TakesAnyTitle) {
  PageParams params;
  params.title = "</script><b>&amp;";
  const std::string page = pageOf(params);
  EXPECT_EQ(countOf(page, "<b>"), 0u);
  EXPECT_EQ(countOf(page, "&lt;/script>&lt;b>&amp;amp;"), 2u);
}

TEST(Page, OpensAsAsked) {
  ShadingParams shading;
  shading.mode = ShadingMode::kGaussian;
  shading.range = {-2.0, 5.0};
  shading.gradient_background = false;
  RenderParams rendering;
  rendering.lod = 3.0;
  const std::string page = pageOf({}, shading, rendering);
  for (const char* part :
       {"\"mode\":\"gauss\"", "\"range\":[-2,5]", "\"white\":true", "\"lod\":3"}) {
    EXPECT_EQ(countOf(page, part), 1u) << part;
  }
  const std::size_t mean = page.find("\"mean\":[");
  ASSERT_NE(mean, std::string::npos);  // of polynomials of degree 2
  EXPECT_NEAR(std::strtod(page.c_str() + mean + 8, nullptr), -1.0 / kSphere, 0.05);
}

TEST(Page, ExplainsTheColoursOfDeviations) {
  PageParams params;
  EXPECT_EQ(countOf(pageOf(params), "id=key"), 0u);
  params.deviations = DeviationScale{2.0, 0.25, "mm"};
  const std::string page = pageOf(params);
  EXPECT_EQ(countOf(page, "id=key>deviation, mm<"), 1u);
  EXPECT_EQ(countOf(page, "level of detection ±0.25 (median)"), 1u);
  EXPECT_EQ(countOf(page, "no counterpart"), 1u);
  // Grey between the level's both signs: 50 (1 ± .25 / 2) %.
  EXPECT_EQ(countOf(page, "#ccccc9 43.75%,#ccccc9 56.25%"), 1u);
  params.deviations->range = 0.0;
  const SLIMSurface sphere = sphereSurface(2, kSphere, 200, 0.08);
  EXPECT_EQ(encodePage(sphere, frontCamera(), RenderParams(), {}, params).error().code,
            ErrorCode::kBadArgument);
}

TEST(Page, RefusesCuts) {
  const SLIMSurface sphere = sphereSurface(2, kSphere, 200, 0.08);
  RenderParams rendering;
  rendering.cuts.push_back({{0.0, 0.0, 1.0}, 0.0});
  EXPECT_EQ(encodePage(sphere, frontCamera(), rendering, {}, {}).error().code,
            ErrorCode::kBadArgument);
}

}  // namespace
}  // namespace pcl_slim
