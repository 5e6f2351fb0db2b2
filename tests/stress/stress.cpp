// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_stress [CLOUDS [SEED]]: so many clouds of every family that anybody may feed us, through
// every class, each cloud in a process of its own. Prints a table of what came out, and what failed
// with the number that makes it again. PCL_SLIM_STRESS=CLOUDS selects the long form where the
// suite runs it.
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "stress/stress_classes.h"

namespace {

using namespace pcl_slim_test;

constexpr unsigned kSeconds =
    60;  ///< of processor time, after which a cloud counts as hanging, ...
constexpr unsigned kWallSeconds = 900;  ///< ... and of the clock, where it only waits

/** Counts of one class in one family. */
struct Cell {
  std::size_t results = 0, refusals = 0, failures = 0;
};

std::mt19937_64 randomOf(std::uint64_t seed, std::size_t family, std::size_t number) {
  std::seed_seq sequence{seed, static_cast<std::uint64_t>(family),
                         static_cast<std::uint64_t>(number)};
  return std::mt19937_64(sequence);
}

/** What the process of a cloud writes: a line for each class. */
[[noreturn]] void work(const StressFamily& family, std::mt19937_64 random, int pipe_end) {
  itimerval limit{};
  limit.it_value.tv_sec = kSeconds;
  setitimer(ITIMER_PROF, &limit, nullptr);
  alarm(kWallSeconds);
  const StressCloud cloud = family.make(random);
  std::string lines;
  for (const StressOutcome& outcome : runClasses(cloud, random)) {
    lines += static_cast<char>(outcome.kind) + outcome.text + "\n";
  }
  const bool written =
      write(pipe_end, lines.data(), lines.size()) == static_cast<ssize_t>(lines.size());
  _exit(written ? 0 : 1);
}

/** Runs a cloud. \return its lines; one that names a signal where it crashed or hung. */
std::vector<std::string> linesOf(const StressFamily& family, std::mt19937_64 random) {
  int ends[2];
  if (pipe(ends) != 0) return {"fno pipe"};
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) work(family, random, ends[1]);
  close(ends[1]);
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = read(ends[0], buffer.data(), buffer.size())) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return {"fsignal " + std::to_string(WTERMSIG(status))};
  std::vector<std::string> lines;
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    lines.push_back(text.substr(at, end - at));
  }
  return lines;
}

void count(const std::string& line, Cell& cell) {
  cell.results += line[0] == 'r';
  cell.refusals += line[0] == 'e';
  cell.failures += line[0] == 'f';
}

std::size_t runFamily(std::size_t family, std::size_t clouds, std::uint64_t seed,
                      std::vector<Cell>& row) {
  std::size_t failures = 0;
  for (std::size_t k = 0; k < clouds; ++k) {
    const auto lines = linesOf(stressFamilies()[family], randomOf(seed, family, k));
    for (std::size_t c = 0; c < lines.size(); ++c) {
      count(lines[c], row[c]);
      if (lines[c][0] != 'f') continue;
      ++failures;
      std::fprintf(stderr, "FAILED %s, cloud %zu, seed %llu, %s: %s\n",
                   stressFamilies()[family].name, k, static_cast<unsigned long long>(seed),
                   lines.size() > 1 ? stressClasses()[c] : "all", lines[c].c_str() + 1);
    }
  }
  return failures;
}

void printRow(const char* name, const std::vector<Cell>& row) {
  std::printf("| %s |", name);
  for (const Cell& cell : row) {
    std::printf(" %zu + %zu", cell.results, cell.refusals);
    if (cell.failures > 0) std::printf(" + **%zu**", cell.failures);
    std::printf(" |");
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const char* const asked = std::getenv("PCL_SLIM_STRESS");
  const std::size_t families = stressFamilies().size();
  const std::size_t clouds = std::strtoul(argc > 1 ? argv[1] : asked ? asked : "100", nullptr, 10);
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::string names, line;
  for (const char* name : stressClasses()) {
    names += std::string(" ") + name + " |";
    line += "---|";
  }
  std::printf("| what is special |%s\n|---|%s\n", names.c_str(), line.c_str());
  std::size_t failures = 0, cases = 0;
  for (std::size_t f = 0; f < families; ++f) {
    std::vector<Cell> row(stressClasses().size());
    failures += runFamily(f, clouds / families + (f < clouds % families), seed, row);
    for (const Cell& cell : row) cases += cell.results + cell.refusals + cell.failures;
    printRow(stressFamilies()[f].name, row);
  }
  std::printf(
      "\n%zu cases of %zu clouds, seed %llu: %zu failed. Results + refusals in one sentence.\n",
      cases, clouds, static_cast<unsigned long long>(seed), failures);
  return failures == 0 ? 0 : 1;
}
