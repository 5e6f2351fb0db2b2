// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fit_mpi: pcl_slim_fit by tiles on the ranks of an MPI job.
#include <mpi.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/mpi/mpi_ranks.h"
#include "slim_fit.h"

namespace {

constexpr const char* kProgram = "pcl_slim_fit_mpi";
constexpr double kPatience =
    1.0;  ///< seconds that a rank which failed waits for others to end, too

/** Whether the arguments are for one process alone, as -h is. */
bool isForOne(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    for (const char* option : {"-h", "-help", "-version", "-help-markdown"}) {
      if (argument == option) return true;
    }
  }
  return false;
}

/** The one process of texts that a build makes, without an MPI job. */
class OneRank : public pcl_slim::Ranks {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }

 protected:
  void swap(std::vector<Bytes>&) override {}
};

/** Keeps what a rank but the first prints, for the one whose failure is to be read. */
class KeptOutput {
 public:
  explicit KeptOutput(bool keeps) {
    if (!keeps || (file_ = std::tmpfile()) == nullptr) return;
    out_ = dup(STDOUT_FILENO);
    error_ = dup(STDERR_FILENO);
    dup2(fileno(file_), STDOUT_FILENO);
    dup2(fileno(file_), STDERR_FILENO);
  }

  void print() {
    if (file_ == nullptr) return;
    std::fflush(nullptr);
    dup2(out_, STDOUT_FILENO);
    dup2(error_, STDERR_FILENO);
    std::rewind(file_);
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_)) std::fputc(c, stderr);
  }

 private:
  std::FILE* file_ = nullptr;
  int out_ = -1, error_ = -1;
};

/** Ends all ranks together. The first rank that failed prints the error; if others still work, or
 * wait for it, it ends them. \return what all exit with */
int settle(int rank, int ranks, int status, KeptOutput& output) {
  const int own[2] = {status == 0 ? ranks : rank, status};
  int first[2] = {};
  MPI_Request request;
  MPI_Iallreduce(own, first, 1, MPI_2INT, MPI_MINLOC, MPI_COMM_WORLD, &request);
  if (!pcl_slim::waitFor(request, status == 0 ? -1 : kPatience)) {
    output.print();
    std::fflush(nullptr);
    MPI_Abort(MPI_COMM_WORLD, status);
  }
  if (first[0] == rank) output.print();
  return first[1];
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument != "--help-man" && argument != "--help-completion") continue;
    OneRank one;
    return pcl_slim::runFit(kProgram, argc, argv, &one);
  }
  int provided = 0, rank = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  int status = 0;
  if (isForOne(pcl_slim::plainArguments(argc, argv))) {
    pcl_slim::MpiRanks ranks(MPI_COMM_SELF);
    if (rank == 0) status = pcl_slim::runFit(kProgram, argc, argv, &ranks);
  } else {
    pcl_slim::MpiRanks ranks;
    KeptOutput output(rank != 0);
    status = pcl_slim::runFit(kProgram, argc, argv, &ranks);
    status = settle(rank, ranks.size(), status, output);
  }
  MPI_Finalize();
  return status;
}
