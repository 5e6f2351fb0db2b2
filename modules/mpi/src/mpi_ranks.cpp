// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mpi/mpi_ranks.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>

namespace pcl_slim {

namespace {

constexpr std::size_t kPiece = 1 << 28;  ///< bytes of one MPI message: counts are int
constexpr int kTestsWithoutNap = 200;
constexpr std::chrono::microseconds kShortNap{20}, kLongNap{2000};

}  // namespace

bool waitFor(MPI_Request& request, double seconds) {
  const auto start = std::chrono::steady_clock::now();
  auto nap = kShortNap;
  for (int tests = 0;; ++tests) {
    int done = 0;
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return true;
    if (tests < kTestsWithoutNap) continue;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    if (seconds >= 0 && passed.count() > seconds) return false;
    std::this_thread::sleep_for(nap);
    nap = std::min(kLongNap, nap * 2);
  }
}

MpiRanks::MpiRanks(MPI_Comm world) {
  MPI_Comm_dup(world, &ranks_);
  MPI_Comm_rank(ranks_, &rank_);
  MPI_Comm_size(ranks_, &size_);
}

MpiRanks::~MpiRanks() {
  MPI_Comm_free(&ranks_);
}

void MpiRanks::swap(std::vector<Bytes>& messages) {
  const auto ranks = static_cast<std::size_t>(size_), own = static_cast<std::size_t>(rank_);
  std::vector<std::uint64_t> sent(ranks), coming(ranks);
  for (std::size_t r = 0; r < ranks; ++r) sent[r] = messages[r].size();
  MPI_Request sizes;
  MPI_Ialltoall(sent.data(), 1, MPI_UINT64_T, coming.data(), 1, MPI_UINT64_T, ranks_, &sizes);
  waitFor(sizes);
  std::vector<Bytes> received(ranks);
  std::vector<MPI_Request> requests;
  // MPI keeps the order of the pieces between two ranks.
  const auto forPieces = [&](Bytes& bytes, const auto& start) {
    for (std::size_t at = 0; at < bytes.size(); at += kPiece) {
      requests.emplace_back();
      start(bytes.data() + at, static_cast<int>(std::min(kPiece, bytes.size() - at)));
    }
  };
  for (std::size_t r = 0; r < ranks; ++r) {
    if (r == own) continue;
    received[r].resize(coming[r]);
    forPieces(received[r], [&](void* to, int bytes) {
      MPI_Irecv(to, bytes, MPI_BYTE, static_cast<int>(r), 0, ranks_, &requests.back());
    });
  }
  for (std::size_t r = 0; r < ranks; ++r) {
    if (r == own) continue;
    forPieces(messages[r], [&](const void* from, int bytes) {
      MPI_Isend(from, bytes, MPI_BYTE, static_cast<int>(r), 0, ranks_, &requests.back());
    });
  }
  for (MPI_Request& request : requests) waitFor(request);
  received[own].swap(messages[own]);
  messages.swap(received);
}

}  // namespace pcl_slim
