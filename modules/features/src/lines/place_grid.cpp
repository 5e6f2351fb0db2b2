// SPDX-License-Identifier: BSD-3-Clause
#include "lines/place_grid.h"

#include <cmath>

namespace pcl_slim::detail {

void
PlaceGrid::clear()
{
  ++age_;
  used_ = 0;
  entries_.clear();
  links_.clear();
}

void
PlaceGrid::cellOf(const Vector3& place, std::int64_t (&cell)[3]) const
{
  for (std::size_t a = 0; a < 3; ++a) {
    cell[a] = static_cast<std::int64_t>(std::floor(place[a] * inverse_));
  }
}

std::uint64_t
PlaceGrid::keyOf(const std::int64_t (&cell)[3])
{
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  return (static_cast<std::uint64_t>(cell[0]) & kMask) << 42 |
         (static_cast<std::uint64_t>(cell[1]) & kMask) << 21 |
         (static_cast<std::uint64_t>(cell[2]) & kMask);
}

std::size_t
PlaceGrid::slotOf(std::uint64_t key) const
{
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = (key * 0x9e3779b97f4a7c15ULL >> 32) & mask;
  while (slots_[at].age == age_ && slots_[at].key != key) at = (at + 1) & mask;
  return at;
}

std::uint32_t
PlaceGrid::headOf(std::uint64_t key) const
{
  const Slot& slot = slots_[slotOf(key)];
  return slot.age == age_ ? slot.head : kNone;
}

void
PlaceGrid::grow()
{
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.age == age_) slots_[slotOf(slot.key)] = slot;
  }
}

void
PlaceGrid::add(const Vector3& place, double reach, std::int64_t number)
{
  const auto entry = static_cast<std::uint32_t>(entries_.size());
  entries_.push_back({place, reach * reach, number});
  std::int64_t low[3], high[3], cell[3];
  cellOf(subtract(place, {reach, reach, reach}), low);
  cellOf(subtract(place, {-reach, -reach, -reach}), high);
  for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0]) {
    for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1]) {
      for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) {
        if (2 * used_ >= slots_.size()) grow();
        const std::uint64_t key = keyOf(cell);
        Slot& slot = slots_[slotOf(key)];
        if (slot.age != age_) {
          slot = {key, kNone, age_};
          ++used_;
        }
        links_.push_back({entry, slot.head});
        slot.head = static_cast<std::uint32_t>(links_.size() - 1);
      }
    }
  }
}

}  // namespace pcl_slim::detail
