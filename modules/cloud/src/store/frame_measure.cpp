// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/cloud_reader.h"

#include <cstring>

#include "pcl_slim/core/parallel.h"
#include "store/cloud_summary.h"
#include "store/frame_units.h"
#include "store/place_sample.h"

namespace pcl_slim::detail {

struct FrameMeasure::State {
  std::vector<PlaceSample> parts;  ///< one a thread
  Bulk bulk;                       ///< of the first pass: everything
  CloudSummary summary;            ///< of the pass under way
  std::uint64_t input = 0;
  bool need_normal = false;
  int passes = 0;
};

FrameMeasure::FrameMeasure() : state_(std::make_unique<State>()) {}
FrameMeasure::~FrameMeasure() = default;

void
FrameMeasure::add(const CloudView& piece, int threads)
{
  State& s = *state_;
  const CloudReader reader(piece);
  s.summary.add(summarizeAll(piece, reader, s.bulk, s.need_normal, threads));
  if (s.passes > 0) return;
  s.input += piece.count();
  s.parts.resize(static_cast<std::size_t>(threads));
  const std::size_t slices = s.parts.size(), n = piece.count();
  parallelFor(slices, threads, 1, [&](std::size_t slice, int) {
    for (std::size_t i = slice * n / slices; i < (slice + 1) * n / slices; ++i) {
      const auto p = reader.position(piece.inputIndex(i));
      if (isFinite(p)) s.parts[slice].offer(p);
    }
  });
}

std::vector<unsigned char>
FrameMeasure::packed()
{
  State& s = *state_;
  PlaceSample sample;
  for (PlaceSample& part : s.parts) sample.merge(part);
  const std::vector<std::array<double, 3>> places = sample.places();
  const std::size_t head = sizeof(s.input) + sizeof(s.summary),
                    rest = places.size() * sizeof(places[0]);
  std::vector<unsigned char> bytes(head + rest);
  std::memcpy(bytes.data(), &s.input, sizeof(s.input));
  std::memcpy(bytes.data() + sizeof(s.input), &s.summary, sizeof(s.summary));
  if (rest > 0) std::memcpy(bytes.data() + head, places.data(), rest);
  return bytes;
}

void
FrameMeasure::merge(const std::vector<std::vector<unsigned char>>& parts)
{
  State& s = *state_;
  std::uint64_t input = 0;
  PlaceSample all;
  s.summary = {};
  for (const std::vector<unsigned char>& bytes : parts) {
    std::uint64_t points;
    CloudSummary summary;
    std::memcpy(&points, bytes.data(), sizeof(points));
    std::memcpy(&summary, bytes.data() + sizeof(points), sizeof(summary));
    input += points;
    s.summary.add(summary);
    std::array<double, 3> place;
    for (std::size_t at = sizeof(points) + sizeof(summary); at < bytes.size();
         at += sizeof(place)) {
      std::memcpy(&place, bytes.data() + at, sizeof(place));
      all.offer(place);
    }
  }
  if (s.passes > 0) return;  // only the first one counts the input and samples places
  s.input = input;
  s.parts.assign(1, all);
}

bool
FrameMeasure::needsAnotherPass()
{
  State& s = *state_;
  ++s.passes;
  const CloudSummary& all = s.summary;
  const bool some_normals = all.with_normal > 0 && all.with_normal < all.near;
  bool again = some_normals && !s.need_normal;
  if (s.passes == 1) {
    PlaceSample places;
    for (PlaceSample& part : s.parts) places.merge(part);
    s.bulk = places.bulk();
    again = again || (all.finite > 0 && !(s.bulk.holds(all.min) && s.bulk.holds(all.max)));
  }
  if (!again) return false;
  s.need_normal = some_normals;
  s.summary = {};
  return true;
}

Error
FrameMeasure::finish(StoreFrame& frame, FrameCounts& counts) const
{
  const CloudSummary& all = state_->summary;
  if (all.near == 0) return CloudView::nothingFinite();
  frame.with_normals = all.with_normal > 0;
  counts = {state_->input, all.finite, all.near, all.with_normal,
            frame.with_normals ? all.with_normal : all.near};
  return setUnits(all.min, all.max, state_->bulk, 0.0, frame);
}

}  // namespace pcl_slim::detail
