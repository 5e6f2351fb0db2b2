// SPDX-License-Identifier: BSD-3-Clause
#include "common/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/interrupt.h"

namespace pcl_slim {

Console::Console(bool quiet)
    : quiet_(quiet),
      terminal_(!quiet && isatty(STDOUT_FILENO) == 1),
      progress_([this](float fraction, const char* stage) { showBar(fraction, stage); })
{
  cancelOnSignals(&progress_);
}

Console::~Console()
{
  cancelOnSignals(nullptr);
}

void
Console::begin(const std::string& what)
{
  stage_ = Stopwatch();
  line_ = "> " + what + " ";
  if (quiet_) return;
  std::fputs(line_.c_str(), stdout);
  std::fflush(stdout);
}

void
Console::done(double seconds, const std::string& detail)
{
  if (quiet_) return;
  clearBar();
  std::printf("[done, %.4g ms : %s]\n", seconds * 1e3, detail.c_str());
  std::fflush(stdout);
}

Error
Console::failed(const Error& error)
{
  if (quiet_) return error;
  clearBar();
  std::puts("[failed]");
  std::fflush(stdout);
  return error;
}

void
Console::note(const std::string& text)
{
  if (!quiet_) std::printf("%s\n", text.c_str());
}

void
Console::warn(const std::string& text)
{
  std::fflush(stdout);
  std::fprintf(stderr, "warning: %s\n", text.c_str());
}

void
Console::showBar(float fraction, const char* stage)
{
  if (!terminal_) return;
  const int percent = std::clamp(static_cast<int>(std::lround(fraction * 100.0f)), 0, 100);
  if (percent == shown_percent_ && shown_stage_ == stage) return;
  shown_percent_ = percent;
  shown_stage_ = stage;
  constexpr int kWidth = 24;
  const int filled = percent * kWidth / 100;
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kWidth - filled), '.');
  std::printf("\r\033[K%s%s %3d %% %s", line_.c_str(), bar.c_str(), percent, stage);
  std::fflush(stdout);
}

void
Console::clearBar()
{
  if (shown_percent_ < 0) return;
  shown_percent_ = -1;
  std::printf("\r\033[K%s", line_.c_str());
}

}  // namespace pcl_slim
