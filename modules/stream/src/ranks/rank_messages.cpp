// SPDX-License-Identifier: BSD-3-Clause
#include "ranks/rank_messages.h"

#include "pcl_slim/core/stopwatch.h"

namespace pcl_slim {

void
Ranks::exchange(std::vector<Bytes>& messages)
{
  const Stopwatch watch;
  for (std::size_t r = 0; r < messages.size(); ++r)
    sent_ += r == static_cast<std::size_t>(rank()) ? 0 : messages[r].size();
  swap(messages);
  seconds_ += watch.seconds();
}

namespace detail {

std::vector<Ranks::Bytes>
fromAll(Ranks& ranks, const Ranks::Bytes& own)
{
  std::vector<Ranks::Bytes> messages(static_cast<std::size_t>(ranks.size()), own);
  ranks.exchange(messages);
  return messages;
}

void
gather(Ranks& ranks, Ranks::Bytes& bytes)
{
  std::vector<Ranks::Bytes> messages = emptyMessages(ranks);
  messages[0].swap(bytes);
  ranks.exchange(messages);
  if (ranks.rank() != 0) return;
  bytes.swap(messages[0]);
  for (std::size_t r = 1; r < messages.size(); ++r)
    bytes.insert(bytes.end(), messages[r].begin(), messages[r].end());
}

bool
Rounds::exchange(bool more, Ranks::Bytes& received)
{
  for (Ranks::Bytes& message : messages_) message.push_back(more ? 1 : 0);
  ranks_.exchange(messages_);
  received.clear();
  bool any = false;
  for (Ranks::Bytes& message : messages_) {
    any = any || message.back() != 0;
    received.insert(received.end(), message.begin(), message.end() - 1);
    message.clear();
  }
  return any;
}

}  // namespace detail
}  // namespace pcl_slim
