// SPDX-License-Identifier: BSD-3-Clause
#include "columns/web_header.h"

namespace pcl_slim::detail {
namespace {

constexpr std::uint32_t kMagic = 0x32504c53;  ///< "SLP2"

/** \brief The numbers of a header in their order, for writing and reading. */
template <typename Header, typename Visit>
void
visitNumbers(Header& h, const Visit& visit)
{
  for (auto& axis : h.info.origin) visit(axis);
  for (auto* number : {&h.info.scale, &h.info.diagonal, &h.info.lambda, &h.info.cover_radius,
                       &h.info.cover_threshold, &h.precision}) {
    visit(*number);
  }
  for (auto& axis : h.corner) visit(axis);
  for (auto* number : {&h.step, &h.radius.low, &h.radius.ratio, &h.error.low, &h.error.ratio,
                       &h.size.low, &h.size.ratio}) {
    visit(*number);
  }
}

}  // namespace

void
WebHeader::write(PlaneWriter& out) const
{
  out.putNumber(kMagic);
  out.putNumber(surfels);
  out.putNumber(leaves);
  out.put({static_cast<std::uint32_t>(info.degree), static_cast<std::uint32_t>(info.blend_kernel),
           static_cast<std::uint32_t>(info.hasFront()), static_cast<std::uint32_t>(info.paper_mode),
           static_cast<std::uint32_t>(colored)},
          1);
  visitNumbers(*this, [&](double number) { out.putDouble(number); });
}

bool
WebHeader::read(PlaneReader& in)
{
  if (in.getNumber() != kMagic) return false;
  surfels = in.getNumber();
  leaves = in.getNumber();
  const auto small = in.get(5, 1);
  if (in.failed()) return false;
  info.degree = static_cast<int>(small[0]);
  info.blend_kernel = static_cast<WeightKernel>(small[1]);
  info.oriented = small[2] != 0;
  info.paper_mode = small[3] != 0;
  colored = small[4] != 0;
  visitNumbers(*this, [&](double& number) { number = in.getDouble(); });
  return !in.failed() && leaves <= surfels && info.degree >= 1 && info.degree <= kMaxDegree;
}

}  // namespace pcl_slim::detail
