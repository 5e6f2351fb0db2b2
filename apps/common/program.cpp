// SPDX-License-Identifier: BSD-3-Clause
#include "common/program.h"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#endif
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

Console::Console(bool quiet)
    : quiet_(quiet),
      terminal_(!quiet && isatty(STDOUT_FILENO) == 1),
      progress_([this](float fraction, const char* stage) { showBar(fraction, stage); }) {
  cancelOnSignals(&progress_);
}

Console::~Console() {
  cancelOnSignals(nullptr);
}

void Console::begin(const std::string& what) {
  stage_ = Stopwatch();
  line_ = "> " + what + " ";
  if (quiet_) return;
  std::fputs(line_.c_str(), stdout);
  std::fflush(stdout);
}

void Console::done(double seconds, const std::string& detail) {
  if (quiet_) return;
  clearBar();
  std::printf("[done, %.4g ms : %s]\n", seconds * 1e3, detail.c_str());
  std::fflush(stdout);
}

Error Console::failed(const Error& error) {
  if (quiet_) return error;
  clearBar();
  std::puts("[failed]");
  std::fflush(stdout);
  return error;
}

void Console::note(const std::string& text) {
  if (!quiet_) std::printf("%s\n", text.c_str());
}

void Console::warn(const std::string& text) {
  std::fflush(stdout);
  std::fprintf(stderr, "warning: %s\n", text.c_str());
}

void Console::showBar(float fraction, const char* stage) {
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

void Console::clearBar() {
  if (shown_percent_ < 0) return;
  shown_percent_ = -1;
  std::printf("\r\033[K%s", line_.c_str());
}

Report::Report(const OptionTable& options, const std::string& input, int threads)
    : json_(std::make_unique<nlohmann::ordered_json>()) {
  auto& json = *json_;
  json["program"] = options.program();
  json["version"] = options.version();
  json["input"] = input;
  json["points"] = 0;
  json["threads"] = resolveThreads(threads);
  json["seconds"]["total"] = 0.0;
  json["peak_rss_mb"] = 0.0;
}

Report::Report(const Report& other)
    : total_(other.total_), json_(std::make_unique<nlohmann::ordered_json>(*other.json_)) {}

Report::~Report() = default;

void Report::add(const nlohmann::ordered_json& values) {
  json_->update(values);
}

void Report::time(const std::string& stage, double seconds) {
  (*json_)["seconds"][stage] = seconds;
}

Error Report::write(const std::string& path) {
  if (path.empty()) return {};
  (*json_)["seconds"]["total"] = total_.seconds();
  (*json_)["peak_rss_mb"] = peakMemoryMb();
  // File names need not be UTF-8, JSON must be.
  const std::string text =
      json_->dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  return writeFile(path, text.data(), text.size());
}

double peakMemoryMb() {
#if defined(__unix__) || defined(__APPLE__)
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
#ifdef __APPLE__
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);  // bytes there
#else
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
#endif
#else
  return 0.0;
#endif
}

bool samePlace(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code code;
  if (a == b || std::filesystem::equivalent(a, b, code)) return true;
  // Of files that are not there yet, or links to such.
  const std::string first = placeOf(a), second = placeOf(b);
  return !first.empty() && first == second;
}

Error checkPlaces(const std::vector<std::string>& read, const std::vector<std::string>& written) {
  for (std::size_t i = 0; i < written.size(); ++i) {
    for (const std::string& name : read) {
      if (samePlace(name, written[i])) {
        return {ErrorCode::kBadArgument, "'" + name + "' would be overwritten; name another file"};
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (samePlace(written[j], written[i])) {
        return {ErrorCode::kBadArgument,
                "two outputs share a file, '" + written[i] + "'; name different ones"};
      }
    }
  }
  return {};
}

Error checkOutputs(const std::string& output, const std::string& report) {
  Error error;
  if (!output.empty()) error = checkWritable(output);
  if (!error && !report.empty()) error = checkWritable(report);
  return error;
}

Error saveOutput(const std::string& output, const std::string& report_file,
                 const std::function<Error()>& save, const std::string& detail, Console& console,
                 Report& report) {
  if (console.interrupted()) return stopped();
  FileTransaction files;
  console.begin("Saving " + output);
  Error error = save();
  const double seconds = console.seconds();
  report.time("save", seconds);
  report.json()["output"] = output;
  if (!error) error = report.write(report_file);
  if (!error) error = commitOutputs(files);
  if (error) return console.failed(error);
  console.done(seconds, detail);
  return {};
}

Error commitOutputs(FileTransaction& files) {
  if (!outlastSignals()) return stopped();
  return files.commit();
}

}  // namespace pcl_slim
