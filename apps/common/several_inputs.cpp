// SPDX-License-Identifier: BSD-3-Clause
#include "common/several_inputs.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>

#include "pcl_slim/core/file_access.h"

extern char** environ;

namespace pcl_slim {

namespace {

namespace fs = std::filesystem;

Error refused(const std::string& why) {
  return {ErrorCode::kBadArgument, why};
}

/** The extensions of a list, without their dots: "pcd ply". */
std::string listOf(const std::vector<std::string>& formats) {
  std::string list;
  for (const std::string& format : formats) list += (list.empty() ? "" : " ") + format.substr(1);
  return list;
}

/** All that a pipe gives until its other end is closed. */
std::string readAll(int pipe) {
  std::string text;
  char bytes[4096];
  for (;;) {
    const ssize_t size = read(pipe, bytes, sizeof(bytes));
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return text;
    text.append(bytes, static_cast<std::size_t>(size));
  }
}

/** Waits for a process. \return its status, or 128 and the number of the signal that ended it */
int statusOf(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return kExitFailed;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/** Starts this program once more. \return its process, or -1. */
pid_t startSelf(std::vector<std::string> words, const char* invoked) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  constexpr const char* kSelf = "/proc/self/exe";
  pid_t process = -1;
  const int code =
      access(kSelf, X_OK) == 0
          ? posix_spawn(&process, kSelf, nullptr, nullptr, arguments.data(), environ)
          : posix_spawnp(&process, invoked, nullptr, nullptr, arguments.data(), environ);
  return code == 0 ? process : -1;
}

}  // namespace

Error SeveralInputs::plan() {
  if (!any()) return {};
  for (const OptionTable::NamedFile& file : options_.files()) {
    if (file.name == "-json") report_ = file.target;
    const bool one = file.use == FileUse::kKept || file.use == FileUse::kWritten;
    if (one && file.target != report_ && file.target != options_.output() && !file.target->empty())
      return refused(file.name + " is of one input: leave it out with -out");
  }
  for (const std::string& input : options_.inputs()) {
    const std::string extension = options_.unnamedExtension(input);
    if (extension.empty()) {
      return refused("'" + input + "' is of a format that is not written: give -format, one of " +
                     listOf(options_.formats()));
    }
    const fs::path folder = options_.names()->folder;
    std::string output = (folder / (fs::path(input).stem().string() + extension)).string();
    if (output[0] == '-') output.insert(0, "./");
    jobs_.push_back({input, output});
  }
  *options_.output() = jobs_.front().output;
  return {};
}

Error SeveralInputs::check() const {
  std::map<std::string, std::string> inputs, outputs;  // by their places
  for (const Job& job : jobs_) inputs.emplace(placeOf(job.input), job.input);
  if (report_ != nullptr && !report_->empty()) outputs.emplace(placeOf(*report_), "the report");
  for (const Job& job : jobs_) {
    const std::string place = placeOf(job.output);
    if (inputs.count(place) > 0)
      return refused("'" + inputs[place] + "' would be overwritten; give another -out");
    const auto [other, is_new] = outputs.emplace(place, "'" + job.input + "'");
    if (!is_new) {
      return refused(other->second + " and '" + job.input + "' would both be written to '" +
                     job.output + "'; rename one, or work on it alone");
    }
    if (Error error = checkWritable(job.output)) return error;
  }
  return {};
}

namespace {

/** A pipe to or from a process, which names its end /dev/fd/N. */
class Pipe {
 public:
  ~Pipe() {
    for (const int end : ends_) {
      if (end >= 0) close(end);
    }
  }
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  /** Makes it. \param[in] own end that the other process does not get: 0 reads, 1 writes */
  bool open(std::size_t own) {
    own_ = own;
    return pipe(ends_) == 0 && fcntl(ends_[own], F_SETFD, FD_CLOEXEC) == 0;
  }
  std::string name() const { return "/dev/fd/" + std::to_string(ends_[1 - own_]); }
  /** To be called once the process has started. */
  void closeOther() { closeEnd(1 - own_); }
  std::string read() const { return ends_[0] >= 0 ? readAll(ends_[0]) : ""; }
  /** Writes a text that is shorter than what a pipe stores. */
  bool write(const std::string& text) {
    const ssize_t size = ::write(ends_[1], text.data(), text.size());
    closeEnd(1);
    return size == static_cast<ssize_t>(text.size());
  }

 private:
  void closeEnd(std::size_t end) {
    if (ends_[end] >= 0) close(ends_[end]);
    ends_[end] = -1;
  }

  int ends_[2] = {-1, -1};
  std::size_t own_ = 0;
};

}  // namespace

/** \param[in] handed_on what the process before wrote for this one; empty: nothing
 * \return the exit status */
int SeveralInputs::runOne(const Job& job, const char* invoked, const std::string& handed_on,
                          Left& left) const {
  std::vector<std::string> words = {options_.program(), job.input, job.output};
  words.insert(words.end(), options_.commonOptions().begin(), options_.commonOptions().end());
  const HandedOn* handing = options_.handedOn();
  if (handing != nullptr && !handing->wanted(options_)) handing = nullptr;
  Pipe report, written, read;
  if (report_ != nullptr && !report_->empty()) {
    if (!report.open(0)) return kExitFailed;
    words.insert(words.end(), {"-json", report.name()});
  }
  if (handing != nullptr) {
    if (!written.open(0)) return kExitFailed;
    words.insert(words.end(), {"-" + handing->write, written.name()});
  }
  if (handing != nullptr && !handed_on.empty()) {
    if (!read.open(1)) return kExitFailed;
    words.insert(words.end(), {"-" + handing->read, read.name()});
    if (!read.write(handed_on)) return kExitFailed;
  }
  const pid_t process = startSelf(words, invoked);
  for (Pipe* pipe : {&report, &written, &read}) pipe->closeOther();
  if (process > 0) {
    passSignalsTo(process);
    left.report = report.read();
    left.handed_on = written.read();
  }
  const int status = process > 0 ? statusOf(process) : kExitFailed;
  passSignalsTo(0);
  return status;
}

/** A list of the reports, each as the program writes it. */
Error SeveralInputs::saveReports(const std::vector<std::string>& reports) const {
  std::string list = "[";
  for (const std::string& report : reports)
    list += (list.size() > 1 ? ",\n" : "\n") + report.substr(0, report.find_last_not_of('\n') + 1);
  list += "\n]\n";
  return writeFile(*report_, list.data(), list.size());
}

Exit SeveralInputs::run(const char* invoked) const {
  const bool reports_wanted = report_ != nullptr && !report_->empty();
  std::vector<std::string> reports;
  std::string failed, handed_on;
  std::size_t failures = 0, done = 0;
  for (const Job& job : jobs_) {
    Left left;
    const int status = runOne(job, invoked, handed_on, left);
    if (signalReceived() != 0) {
      return {kExitInterrupted, "stopped; " + std::to_string(done) + " of " +
                                    std::to_string(jobs_.size()) + " inputs are done"};
    }
    done += status == kExitDone ? 1 : 0;
    if (status == kExitDone && reports_wanted) reports.push_back(left.report);
    if (status == kExitDone && !left.handed_on.empty() &&
        options_.handedOn()->keeps(left.handed_on))
      handed_on = left.handed_on;
    if (status == kExitDone) continue;
    failed += (failures++ > 0 ? ", '" : "'") + job.input + "'";
    if (status > 128 && status != kExitInterrupted) {
      std::fprintf(stderr, "%s: '%s': ended by signal %d (%s)\n", options_.program().c_str(),
                   printable(job.input).c_str(), status - 128, strsignal(status - 128));
    }
  }
  if (reports_wanted) {
    if (Error error = saveReports(reports)) return error;
  }
  if (failures == 0) return {};
  return {kExitFailed, std::to_string(failures) + " of " + std::to_string(jobs_.size()) +
                           (jobs_.size() == 1 ? " input" : " inputs") + " failed: " + failed};
}

}  // namespace pcl_slim
