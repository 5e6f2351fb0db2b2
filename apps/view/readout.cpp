// SPDX-License-Identifier: BSD-3-Clause
// The window's words: what is shown, and what is under the mouse.
#include "view/readout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "pcl_slim/core/decimals.h"
#include "pcl_slim/visualization/scalar_bar.h"
#include "pcl_slim/visualization/slim_mapper.h"
#include "pcl_slim/visualization/splat_mapper.h"
#include "view/scene.h"

namespace pcl_slim {
namespace {

template <typename... Values>
std::string print(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

/** \brief Writes lengths, places and curvatures of one object. */
class Writer {
 public:
  explicit Writer(const Scene& scene)
      : unit_(scene.unit()), decimals_(decimalsFor(scene.diagonal())) {}

  /** \brief A length, with two significant digits where the object's decimals leave fewer. */
  std::string length(double value) const {
    int decimals = decimals_;
    if (value > 0.0) {
      decimals = std::max(decimals, static_cast<int>(std::ceil(1.0 - std::log10(value))));
    }
    return fixedText(value, decimals) + after(unit_);
  }

  std::string place(const std::array<double, 3>& p) const {
    return "at " + fixedText(p[0], decimals_) + " " + fixedText(p[1], decimals_) + " " +
           fixedText(p[2], decimals_) + after(unit_);
  }

  /** \brief The unit of a curvature after its number; nothing for an unnamed unit of length. */
  std::string perLength(const char* power = "") const {
    return unit_.empty() ? "" : " 1/" + unit_ + power;
  }

 private:
  static std::string after(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

  std::string unit_;
  int decimals_;
};

std::string describeNormal(const std::array<double, 3>& n) {
  return print("   normal %.3f %.3f %.3f", n[0], n[1], n[2]);
}

std::string describePick(const Writer& writer, const SurfacePick& pick) {
  return print("leaf %u  level %d  degree %d  ball radius ", pick.surfel, pick.level, pick.degree) +
         writer.length(pick.radius) + "  error " + writer.length(pick.error) +
         print("  points %.0f\n", pick.effective_count) +
         print("mean %.4g  k_max %.4g  k_min %.4g", pick.mean, pick.k_max, pick.k_min) +
         writer.perLength() + print("   Gauss %.4g", pick.gauss) + writer.perLength("²") + "\n" +
         writer.place(pick.position) + describeNormal(pick.normal);
}

std::string describeSplat(const Writer& writer, const SplatSet& splats, std::size_t i) {
  const std::uint32_t rgb = splats.rgb[i];
  const std::array<double, 3> place{splats.origin[0] + double{splats.x[i]},
                                    splats.origin[1] + double{splats.y[i]},
                                    splats.origin[2] + double{splats.z[i]}};
  return print("splat %zu  radius ", i) + writer.length(splats.radius[i]) +
         print("  colour %u %u %u\n", (rgb >> 16) & 255, (rgb >> 8) & 255, rgb & 255) +
         writer.place(place) + describeNormal({splats.nx[i], splats.ny[i], splats.nz[i]});
}

}  // namespace

std::string describeScene(const Scene& scene) {
  GBufferMapper* mapper = scene.mapper();
  if (!mapper) return "h: help";
  std::string text;
  if (const SLIMMapper* surface = scene.surfaceMapper()) {
    text = std::to_string(surface->getSurface()->numLeaves()) + " leaves";
  } else {
    text = std::to_string(static_cast<SplatMapper*>(mapper)->getSplats()->size()) + " splats";
  }
  const DisplayMode mode = mapper->getMode();
  text += "   " + titleOf(mode);
  if (takesRange(mode)) {
    text += print(" within %.4g", mapper->getRange());
    const std::string unit = unitOf(mode, scene.unit());
    if (!scene.unit().empty()) text += " " + unit;
  }
  return text + "   h: help";
}

std::string describeUnder(const Scene& scene, vtkRenderer* renderer, int x, int y) {
  const Writer writer(scene);
  if (SLIMMapper* surface = scene.surfaceMapper()) {
    SurfacePick pick;
    const bool met = surface->pick(renderer, scene.model(), x, y, pick);
    return met ? describePick(writer, pick) : "";
  }
  GBuffer pixel;
  if (!scene.mapper() || !scene.mapper()->castRay(renderer, scene.model(), x, y, pixel)) return "";
  const SplatSet& splats = *static_cast<SplatMapper*>(scene.mapper())->getSplats();
  return describeSplat(writer, splats, pixel.surfel[0]);
}

}  // namespace pcl_slim
