// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/parallel.h"

#include <algorithm>
#include <thread>

#include "thread_team.h"

namespace pcl_slim {

using namespace detail;

namespace {

thread_local bool in_team = false;

/** What a member of a team runs, remembering meanwhile that it is one. */
struct Membership {
  void (*work)(void*, int);
  void* context;

  static void run(void* membership, int thread)
  {
    const auto& self = *static_cast<const Membership*>(membership);
    in_team = true;
    self.work(self.context, thread);
    in_team = false;
  }
};

}  // namespace

int
resolveThreads(int requested)
{
  if (requested > 0) return requested;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace internal {

void
runOnTeam(int threads, void (*work)(void*, int), void* context)
{
  if (threads <= 1 || in_team) return work(context, 0);
  thread_local ThreadTeam team;
  Membership membership{work, context};
  team.run(threads, Membership::run, &membership);
}

}  // namespace internal

}  // namespace pcl_slim
