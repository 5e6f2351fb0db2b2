// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fit_mpi: pcl_slim_fit by tiles on the ranks of an MPI job that share a folder.
#include <mpi.h>
#include <time.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "common/options.h"
#include "scan/fit_program.h"

namespace {

constexpr const char* kProgram = "pcl_slim_fit_mpi";

using Arguments = std::vector<std::string>;

int
run(const Arguments& arguments)
{
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  return pcl_slim::runFitProgram(kProgram, PCL_SLIM_VERSION, static_cast<int>(argv.size()),
                                 argv.data());
}

bool
has(const Arguments& arguments, const char* option)
{
  for (const std::string& argument : arguments) {
    if (argument == option) return true;
  }
  return false;
}

/** The arguments of a run over some tiles: it says nothing and writes no report. */
Arguments
forTiles(const Arguments& all, const std::string& tiles)
{
  Arguments some;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool last = i + 1 == all.size();
    if (all[i] == "-quiet") {
      if (!last && pcl_slim::switchValue(all[i + 1])) ++i;
    } else if (all[i] == "-json") {
      ++i;
    } else {
      some.push_back(all[i]);
    }
  }
  for (const std::string& word : {std::string("-tiles"), tiles, std::string("-quiet")})
    some.push_back(word);
  return some;
}

/** Waits for all ranks without keeping a core busy. \return the worst status. */
int
worst(int status)
{
  int all = 0, done = 0;
  MPI_Request request;
  MPI_Iallreduce(&status, &all, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
  for (;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done) return all;
    const timespec nap{0, 2000000};
    nanosleep(&nap, nullptr);
  }
}

/** Plans on one rank, fits on all, joins on one. A rank that fails ends the others. */
int
fitOnRanks(const Arguments& arguments, int rank, int ranks)
{
  int status = rank == 0 ? run(forTiles(arguments, "0:0")) : 0;
  status = worst(status);
  if (status != 0) return status;
  status = run(forTiles(arguments, std::to_string(rank) + "/" + std::to_string(ranks)));
  if (status != 0) {
    std::fprintf(stderr, "%s: rank %d failed; the job ends\n", kProgram, rank);
    MPI_Abort(MPI_COMM_WORLD, status);
  }
  worst(0);
  return worst(rank == 0 ? run(arguments) : 0);
}

/** Whether the arguments are for one process alone, as -h is, or wrong. */
bool
isForOne(const Arguments& arguments)
{
  for (const char* option : {"-h", "-help", "-version", "-help-markdown"}) {
    if (has(arguments, option)) return true;
  }
  return arguments.size() < 3;
}

int
refuse(int rank, const char* why)
{
  if (rank == 0) std::fprintf(stderr, "%s: %s\n", kProgram, why);
  return 2;
}

}  // namespace

int
main(int argc, char** argv)
{
  MPI_Init(&argc, &argv);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  Arguments arguments = pcl_slim::plainArguments(argc, argv);
  int status = 0;
  if (isForOne(arguments)) {
    status = worst(rank == 0 ? run(Arguments(argv, argv + argc)) : 0);
  } else if (!has(arguments, "-plan")) {
    status = refuse(rank, "-plan is missing: name a folder that all ranks see");
  } else if (has(arguments, "-tiles")) {
    status = refuse(rank, "-tiles is for single processes: leave it, ranks share the tiles");
  } else {
    if (!has(arguments, "-threads")) {
      arguments.push_back("-threads");
      arguments.push_back("1");
    }
    status = fitOnRanks(arguments, rank, ranks);
  }
  MPI_Finalize();
  return status;
}
