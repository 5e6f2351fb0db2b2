// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <type_traits>
#include <vector>

#include "pcl_slim/stream/ranks.h"

namespace pcl_slim::detail {

/** \brief One process alone. */
class OneRank : public Ranks {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }

 protected:
  void swap(std::vector<Bytes>&) override {}
};

template <typename T>
void
appendBytes(const T& value, Ranks::Bytes& bytes)
{
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.resize(bytes.size() + sizeof(T));
  std::memcpy(bytes.data() + bytes.size() - sizeof(T), &value, sizeof(T));
}

/** \brief The values stored in bytes, one behind the other. */
template <typename T>
std::vector<T>
valuesOf(const Ranks::Bytes& bytes)
{
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

inline std::vector<Ranks::Bytes>
emptyMessages(const Ranks& ranks)
{
  return std::vector<Ranks::Bytes>(static_cast<std::size_t>(ranks.size()));
}

/** \brief The bytes of all ranks, in the order of the ranks, at each of them. */
std::vector<Ranks::Bytes>
fromAll(Ranks& ranks, const Ranks::Bytes& own);

/** \brief Appends all ranks' bytes at rank 0, in their order; none are left at the others. */
void
gather(Ranks& ranks, Ranks::Bytes& bytes);

/** \brief All ranks' values, in the order of the ranks, at each of them. */
template <typename T>
std::vector<T>
allOf(Ranks& ranks, const std::vector<T>& own)
{
  Ranks::Bytes bytes;
  for (const T& value : own) appendBytes(value, bytes);
  std::vector<T> all;
  for (const Ranks::Bytes& part : fromAll(ranks, bytes)) {
    const std::vector<T> values = valuesOf<T>(part);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

/** \brief The value of rank 0. */
template <typename T>
T
ofFirst(Ranks& ranks, const T& own)
{
  std::vector<T> first;
  if (ranks.rank() == 0) first.push_back(own);
  return allOf(ranks, first).front();
}

/** \brief Messages that ranks exchange in rounds, until none has more to send. */
class Rounds {
 public:
  explicit Rounds(Ranks& ranks) : ranks_(ranks), messages_(emptyMessages(ranks)) {}

  /** \brief What the next round sends to a rank. */
  Ranks::Bytes& to(std::size_t rank) { return messages_[rank]; }
  /** \brief Exchanges what is there. \param[in] more whether this rank has another round to come
   * \param[out] received from all ranks, in their order \return whether some rank has more */
  bool exchange(bool more, Ranks::Bytes& received);

 private:
  Ranks& ranks_;
  std::vector<Ranks::Bytes> messages_;
};

}  // namespace pcl_slim::detail
