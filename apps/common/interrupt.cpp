// SPDX-License-Identifier: BSD-3-Clause
#include "common/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>

#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr int kPatienceMicroseconds = 500000;
constexpr int kEndingSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

std::atomic<Progress*> g_running{nullptr};
std::atomic<int> g_signal{0};

// Only what is safe in a signal handler: atomics, setitimer, unlink, write and _exit.

void
endNow(int signal)
{
  removeUnfinishedFiles();
  constexpr char kText[] = "stopped; nothing is written\n";
  if (write(STDERR_FILENO, kText, sizeof(kText) - 1) < 0) _exit(128 + signal);
  _exit(128 + signal);
}

extern "C" void
endOnAlarm(int)
{
  const int signal = g_signal.load();
  endNow(signal != 0 ? signal : SIGALRM);  // without one before, the alarm is another program's
}

extern "C" void
onSignal(int signal)
{
  Progress* progress = g_running.load();
  if (g_signal.exchange(signal) != 0 || progress == nullptr) endNow(signal);
  progress->cancel();
  itimerval patience{};
  patience.it_value.tv_usec = kPatienceMicroseconds;
  setitimer(ITIMER_REAL, &patience, nullptr);
}

void
handle(int signal, void (*handler)(int))
{
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigfillset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

void
endOnSignals()
{
  handle(SIGALRM, endOnAlarm);
  for (const int signal : {SIGPIPE, SIGXFSZ}) handle(signal, SIG_IGN);
  for (const int signal : kEndingSignals) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    // nohup has the program ignore SIGHUP.
    if (signal != SIGHUP || before.sa_handler != SIG_IGN) handle(signal, onSignal);
  }
}

bool
outlastSignals()
{
  for (const int signal : kEndingSignals) handle(signal, SIG_IGN);
  handle(SIGALRM, SIG_IGN);
  return g_signal.load() == 0;
}

void
cancelOnSignals(Progress* progress)
{
  g_running.store(progress);
}

int
receivedSignal()
{
  return g_signal.load();
}

}  // namespace pcl_slim
