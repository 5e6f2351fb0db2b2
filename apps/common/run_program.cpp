// SPDX-License-Identifier: BSD-3-Clause
#include "common/run_program.h"

#if defined(__linux__)
#include <sys/resource.h>
#endif
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <thread>
#include <utility>

#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr int kPatienceMicroseconds = 500000;
constexpr int kEndingSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

std::atomic<Progress*> g_running{nullptr};
std::atomic<int> g_signal{0};
std::atomic<pid_t> g_process{0};

// Only what is safe in a signal handler: atomics, setitimer, unlink, write and _exit.

void endNow(int signal) {
  removeUnfinishedFiles();
  constexpr char kText[] = "stopped; nothing is written\n";
  if (write(STDERR_FILENO, kText, sizeof(kText) - 1) < 0) _exit(128 + signal);
  _exit(128 + signal);
}

extern "C" void endOnAlarm(int) {
  const int signal = g_signal.load();
  endNow(signal != 0 ? signal : SIGALRM);  // without one before, the alarm is another program's
}

extern "C" void onSignal(int signal) {
  if (const pid_t process = g_process.load(); process > 0) {
    g_signal = signal;
    kill(process, signal);
    return;
  }
  Progress* progress = g_running.load();
  if (g_signal.exchange(signal) != 0 || progress == nullptr) endNow(signal);
  progress->cancel();
  itimerval patience{};
  patience.it_value.tv_usec = kPatienceMicroseconds;
  setitimer(ITIMER_REAL, &patience, nullptr);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigfillset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

void endOnSignals() {
  handle(SIGALRM, endOnAlarm);
  for (const int signal : {SIGPIPE, SIGXFSZ}) handle(signal, SIG_IGN);
  for (const int signal : kEndingSignals) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    // nohup has the program ignore SIGHUP.
    if (signal != SIGHUP || before.sa_handler != SIG_IGN) handle(signal, onSignal);
  }
}

bool outlastSignals() {
  for (const int signal : kEndingSignals) handle(signal, SIG_IGN);
  handle(SIGALRM, SIG_IGN);
  return g_signal.load() == 0;
}

void cancelOnSignals(Progress* progress) {
  g_running.store(progress);
}

void passSignalsTo(pid_t process) {
  g_process.store(process);
  if (process > 0 && g_signal.load() != 0) kill(process, g_signal.load());
}

int signalReceived() {
  return g_signal.load();
}

namespace {

constexpr double kMegabyte = 1024.0 * 1024.0;
constexpr std::uint64_t kMostMegabytes = 1000000000000000000u;
constexpr double kStack = 8 * kMegabyte;  ///< address space that a thread reserves and hardly uses

std::uint64_t limit = 0;  ///< megabytes; 0: none

/** A line of the system's report on this process or the machine, in bytes; 0 where there is none.
 */
double statusOf(const std::string& key, const char* file = "/proc/self/status") {
  std::ifstream status(file);
  for (std::string line; std::getline(status, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    double kilobytes = 0;
    std::istringstream(line.substr(key.size())) >> kilobytes;
    return 1024.0 * kilobytes;
  }
  return 0.0;
}

std::string megabytesText(double bytes) {
  return std::to_string(static_cast<std::uint64_t>(std::ceil(bytes / kMegabyte))) + " MB";
}

/** Limits the memory of this process from here on. \return an error where the program itself takes
 * more. */
Error limitMemory(std::uint64_t megabytes) {
  if (megabytes == 0) return {};
  const double wanted = kMegabyte * static_cast<double>(megabytes), now = statusOf("VmRSS:");
  if (wanted <= now) {
    return {ErrorCode::kBadArgument, "-max_memory " + std::to_string(megabytes) +
                                         " is less than the program itself takes: allow " +
                                         megabytesText(2 * now) + " or more"};
  }
#if defined(__linux__)
  // Private memory is limited; what is mapped from files, as the program itself, is not.
  const double stacks = kStack * (1 + std::thread::hardware_concurrency());
  rlimit bound{};
  if (getrlimit(RLIMIT_DATA, &bound) == 0) {
    const double most = statusOf("VmData:") + wanted - now + stacks;
    if (bound.rlim_max == RLIM_INFINITY || most < static_cast<double>(bound.rlim_max)) {
      bound.rlim_cur = static_cast<rlim_t>(most);
      setrlimit(RLIMIT_DATA, &bound);
    }
  }
#endif
  return {};
}

}  // namespace

void declareMemoryLimit(OptionTable& options) {
  options.integer("max_memory", &limit, 0, kMostMegabytes,
                  "most memory to take, in MB: work that needs more is refused; 0: all there is");
}

bool isWithinMemoryLimit(double bytes) {
  return limit == 0 || bytes <= kMegabyte * static_cast<double>(limit);
}

Error checkMemory(double bytes, const std::string& what, const std::string& relief) {
  const double needed = bytes + statusOf("VmRSS:");
  if (isWithinMemoryLimit(needed)) return {};
  return badInput(what + " takes " + megabytesText(needed) + " or more, above -max_memory " +
                  std::to_string(limit) + ": raise it, or " + relief);
}

double memoryLeft() {
  constexpr double kShare = 0.8;
  if (limit == 0) {
    const double free = statusOf("MemAvailable:", "/proc/meminfo");
    return free > 0 ? kShare * free : HUGE_VAL;
  }
  return std::fmax(0.0, kMegabyte * static_cast<double>(limit) - statusOf("VmRSS:"));
}

Error stopped() {
  return {ErrorCode::kCancelled, "stopped; nothing is written"};
}

Exit::Exit(const Error& work) {
  if (!work) return;
  const bool cancelled = work.code == ErrorCode::kCancelled;
  status = cancelled ? kExitInterrupted : kExitFailed;
  message = cancelled ? stopped().message : work.message;
}

namespace {

/** How the body ends; what it throws fails. */
Exit runBody(const std::string& relief, const std::function<Exit()>& body) {
  try {
    if (Error error = limitMemory(limit)) return Exit::usage(error);
    return body();
  } catch (const std::bad_alloc&) {
    const std::string bound = limit == 0 ? "" : " within -max_memory " + std::to_string(limit);
    return {kExitFailed, "not enough memory" + bound + "; " + relief + " or fewer -threads"};
  } catch (const std::exception& failure) {
    return {kExitFailed, failure.what()};
  }
}

}  // namespace

int runProgram(OptionTable& options, int argc, const char* const* argv, const std::string& relief,
               const std::function<Exit()>& body) {
  endOnSignals();
  if (const auto status = options.parse(argc, argv)) return *status;
  Exit exit = runBody(relief, body);
  if (exit.status == kExitDone) return kExitDone;
  const int signal = g_signal.load();
  if (exit.status != kExitInterrupted && signal != 0) exit = stopped();
  std::fprintf(stderr, "%s: %s\n", options.program().c_str(),
               printable(std::move(exit.message)).c_str());  // no memory is taken
  return exit.status == kExitInterrupted && signal != 0 ? 128 + signal : exit.status;
}

std::string commandLine(int argc, const char* const* argv) {
  std::string text = std::filesystem::path(argv[0]).filename().string();
  for (int i = 1; i < argc; ++i) text += std::string(" ") + argv[i];
  return text;
}

}  // namespace pcl_slim
