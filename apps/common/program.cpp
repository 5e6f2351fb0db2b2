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

#include "common/standard_output.h"
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
  line_ = "> " + printable(what) + " ";
  if (quiet_) return;
  std::fputs(line_.c_str(), stdout);
  std::fflush(stdout);
}

/** Three digits, in the unit that a reader would choose: 16.4 ms, 12.6 s, 7 min 5 s. */
static std::string durationText(double seconds) {
  char text[40];
  if (seconds < 0.9995)
    std::snprintf(text, sizeof(text), "%.3g ms", 1e3 * seconds);
  else if (seconds < 99.95)
    std::snprintf(text, sizeof(text), "%.3g s", seconds);
  else
    std::snprintf(text, sizeof(text), "%d min %d s", static_cast<int>(std::lround(seconds)) / 60,
                  static_cast<int>(std::lround(seconds)) % 60);
  return text;
}

void Console::done(double seconds, const std::string& detail) {
  if (quiet_) return;
  clearBar();
  std::printf("[done, %s : %s]\n", durationText(seconds).c_str(), printable(detail).c_str());
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
  if (!quiet_) std::printf("%s\n", printable(text).c_str());
}

void Console::warn(const std::string& text) {
  std::fflush(stdout);
  std::fprintf(stderr, "warning: %s\n", printable(text).c_str());
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

ReportValue::ReportValue(const Object& fields) : data(fields) {}

ReportValue::ReportValue(std::initializer_list<ReportField> fields) : data(Object(fields)) {}

Report::Report(const OptionTable& options, const std::string& input, int threads)
    : fields_{{"program", options.program()},
              {"version", options.version()},
              {"input", input},
              {"points", 0},
              {"threads", resolveThreads(threads)},
              {"seconds", {{"total", 0.0}}},
              {"peak_rss_mb", 0.0}} {}

void Report::add(std::initializer_list<ReportField> fields) {
  fields_.insert(fields_.end(), fields);
}

void Report::addPart(const std::string& name, const Report& part) {
  ReportValue::Object own;
  for (const ReportField& field : part.fields_) {
    const bool common = field.name == "program" || field.name == "version" ||
                        field.name == "threads" || field.name == "peak_rss_mb" ||
                        field.name == "seconds";
    if (!common) own.push_back(field);
  }
  own.push_back({"seconds", part.seconds_});
  set(name, own);
}

using Json = nlohmann::ordered_json;

// The JSON library finds these by their name.
static void to_json(Json& json, const ReportValue& value);

static void to_json(Json& json, const ReportValue::Object& fields) {
  json = Json::object();
  for (const ReportField& field : fields) json[field.name] = field.value;
}

static void to_json(Json& json, const ReportValue& value) {
  std::visit([&json](const auto& data) { json = data; }, value.data);
}

Error Report::write(const std::string& path) const {
  if (path.empty()) return {};
  Json json = fields_;
  json["seconds"].update(Json(seconds_));
  json["seconds"]["total"] = total_.seconds();
  json["peak_rss_mb"] = peakMemoryMb();
  // File names need not be UTF-8, JSON must be.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
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

Error saveOutput(const std::string& output, const std::string& report_file,
                 const std::function<Error()>& save, const std::string& detail, Console& console,
                 Report& report) {
  if (console.interrupted()) return stopped();
  FileTransaction files;
  console.begin("Saving " + shownName(output));
  Error error = save();
  const double seconds = console.seconds();
  report.time("save", seconds);
  report.set("output", isStandardOutput(output) ? "-" : output);
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
