// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "file/slim_file.h"
#include "fuzz/fuzz_targets.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/lab/reference/reference_renderer.h"

namespace pcl_slim_test {

namespace {

using namespace pcl_slim;

constexpr std::size_t kMostPoints = 400;  ///< a run is to take milliseconds

void require(bool condition) {
  if (!condition) std::abort();
}

void require(const Error& error) {
  require(!error);
}

/** Floats of the bytes behind the first two, which say what to do with them. */
struct FuzzCloud {
  std::vector<float> values;
  std::vector<std::uint8_t> bgr;
  CloudView view;

  FuzzCloud(const std::uint8_t* bytes, std::size_t size, bool normals) {
    const std::size_t row = normals ? 6 : 3;
    values.resize(std::min(size / (4 * row), kMostPoints) * row);
    if (!values.empty()) std::memcpy(values.data(), bytes, 4 * values.size());
    view.size = values.size() / row;
    bgr.assign(3 * view.size, std::uint8_t{90});
    view.xyz = values.data();
    view.xyz_stride = 4 * row;
    if (!normals || values.empty()) return;
    view.normal = values.data() + 3;
    view.normal_stride = 4 * row;
  }
};

std::uint64_t numberAt(const std::vector<unsigned char>& file, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t i = 8; i-- > 0;) number = number << 8 | file[at + i];
  return number;
}

void setNumberAt(std::vector<unsigned char>& file, std::size_t at, std::uint64_t number) {
  for (std::size_t i = 0; i < 8; ++i, number >>= 8)
    file[at + i] = static_cast<unsigned char>(number);
}

constexpr std::size_t kPayloadAt = 16, kChecksumAt = 24;     ///< in the header of a .slim file
constexpr std::size_t kEntryBytes = 64, kTrailerBytes = 16;  ///< of a directory of blocks

/** A .slim file with the size and the checksums that it should have. No chance finds these, and
 * nothing behind wrong ones is read. */
std::vector<unsigned char> sealed(std::vector<unsigned char> file) {
  const std::size_t size = file.size();
  if (size < detail::kSlimHeaderBytes + kTrailerBytes) return file;
  setNumberAt(file, kPayloadAt, size - detail::kSlimHeaderBytes);
  if (detail::slimVersionOf(file.data(), size) != detail::kSlimBlocksVersion) {
    detail::sealSlim(file);
    return file;
  }
  const std::uint64_t begin = numberAt(file, size - kTrailerBytes);
  if (begin < detail::kSlimHeaderBytes || begin > size - kTrailerBytes) return file;
  const auto first = static_cast<std::ptrdiff_t>(begin);
  for (std::size_t at = begin; at + kEntryBytes + kTrailerBytes <= size; at += kEntryBytes) {
    const std::uint64_t offset = numberAt(file, at), bytes = numberAt(file, at + 8);
    if (offset > begin || bytes > begin - offset) continue;
    const auto from = file.begin() + static_cast<std::ptrdiff_t>(offset);
    std::vector<unsigned char> block(from, from + static_cast<std::ptrdiff_t>(bytes));
    if (detail::slimVersionOf(block.data(), block.size()) == detail::kSlimBlocksVersion) continue;
    block = sealed(std::move(block));
    std::copy(block.begin(), block.end(), from);
  }
  std::vector<unsigned char> head(file.begin(), file.begin() + detail::kSlimHeaderBytes);
  head.insert(head.end(), file.begin() + first, file.end());
  setNumberAt(file, kChecksumAt, detail::slimChecksum(head.data(), head.size()));
  return file;
}

/** A camera: for one size of input in eight one as a person would choose, which takes longer than all
 * else, for the others one that looks down at the local units' unit cube. */
Camera cameraOf(const BoundingSpheres& spheres, std::size_t size) {
  constexpr ImageSize kImage{16, 12};
  if (size % 8 == 0) return cameraFor(chooseView(spheres), spheres, kImage);
  Camera camera;
  camera.size = kImage;
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = spheres.scale;
  camera.look_at = camera.position = spheres.origin;
  camera.position[2] += 2.0 * spheres.scale;
  return camera;
}

void renderSurfaceOf(const SLIMSurface& surface, std::size_t size) {
  const Camera camera = cameraOf(spheresOf(surface), size);
  if (camera.validate()) return;
  for (const bool reference : {false, true}) {
    const auto draw = reference ? lab::renderReference : renderSurface;
    RenderParams params;
    params.threads = 1;
    GBuffer buffer;
    require(draw(surface, camera, params, buffer, nullptr));
    for (const float depth : buffer.depth) require(!std::isnan(depth));
  }
}

void fitAndRender(const CloudView& view, int degree) {
  const Result<PointStore> store = PointStore::build(view, 1);
  if (!store) return;
  FitParams params;
  params.threads = 1;
  params.degree = degree;
  SLIMSurface surface;
  if (fitSurface(*store, params, surface)) return require(surface.empty());
  require(surface.validate());
  require(surface.numLeaves() > 0);
  ProjectionParams how;
  how.threads = 1;
  how.curvature = how.directions = true;
  Projection projection;
  require(projectPoints(*store, surface, how, projection));
  for (const auto& p : projection.position) {
    for (const double value : p) require(std::isfinite(value));
  }
  renderSurfaceOf(surface, store->size());
}

void sampleAndRender(const FuzzCloud& cloud) {
  SplatParams params;
  params.threads = 1;
  SplatSet splats;
  if (sampleSplats(cloud.view, {cloud.bgr.data(), 3}, params, splats))
    return require(splats.empty());
  require(validateDiscs(splats));
  const Camera camera = cameraOf(spheresOf(splats), cloud.view.size);
  if (camera.validate()) return;
  DiscRenderParams how;
  how.threads = 1;
  GBuffer buffer;
  require(renderDiscs(splats, camera, how, buffer));
}

}  // namespace

int fuzzSlim(const std::uint8_t* bytes, std::size_t size) {
  const std::vector<unsigned char> file = sealed({bytes, bytes + size});
  const Result<SLIMSurface> surface = decodeSlim(file.data(), file.size());
  if (!surface) return 0;
  require(surface->validate());
  const std::vector<unsigned char> written = encodeSlim(*surface);
  const Result<SLIMSurface> again = decodeSlim(written.data(), written.size());
  require(static_cast<bool>(again));
  require(encodeSlim(*again) == written);
  if (surface->size() < kMostPoints) renderSurfaceOf(*surface, size);
  return 0;
}

int fuzzClouds(const std::uint8_t* bytes, std::size_t size) {
  if (size < 2) return 0;
  const FuzzCloud cloud(bytes + 2, size - 2, bytes[0] % 2 == 1);
  fitAndRender(cloud.view, bytes[1] % 5);
  sampleAndRender(cloud);
  return 0;
}

}  // namespace pcl_slim_test
