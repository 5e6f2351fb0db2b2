// SPDX-License-Identifier: BSD-3-Clause
#include "common/file_program.h"

#include <unistd.h>

#include <filesystem>

#include "common/program.h"
#include "common/several_inputs.h"
#include "common/standard_output.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

namespace fs = std::filesystem;

Error checkFolder(const std::string& option, const std::string& folder) {
  const auto refused = [&](const std::string& why) {
    return Error{ErrorCode::kBadArgument, option + ": the folder '" + folder + "' " + why};
  };
  std::error_code code;
  if (!fs::exists(folder, code)) return refused("does not exist; create it first");
  if (!fs::is_directory(folder, code)) return refused("is a file; name a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    return refused("is read-only; allow writing it or name another");
  return {};
}

/** Every place that is written, before any work. */
Error checkPlacesWritten(const OptionTable& options) {
  for (const OptionTable::NamedFile& file : options.files()) {
    if (file.target->empty()) continue;
    Error error;
    if (file.use == FileUse::kWritten) error = checkWritable(*file.target);
    if (file.use == FileUse::kScratch || file.use == FileUse::kKept)
      error = checkFolder(file.name, *file.target);
    if (error) return error;
  }
  return {};
}

/** A file that an option writes beside the output is none of the arguments. */
Error checkOptionsWritten(const OptionTable& options) {
  const auto isOption = [](const OptionTable::NamedFile& file) { return file.name[0] == '-'; };
  for (const OptionTable::NamedFile& file : options.files()) {
    if (!isOption(file) || file.use != FileUse::kWritten) continue;
    for (const OptionTable::NamedFile& other : options.files()) {
      if (isOption(other) || !samePlace(*file.target, *other.target)) continue;
      return {ErrorCode::kBadArgument,
              file.name + ": '" + *file.target + "' is " + other.name + ", too; name another file"};
    }
  }
  return {};
}

/** A scan that is typed in is a mistake. */
Error checkTerminal(const OptionTable& options) {
  for (const OptionTable::NamedFile& file : options.files()) {
    if (file.use == FileUse::kRead && *file.target == "/dev/stdin" && isatty(STDIN_FILENO) == 1)
      return {ErrorCode::kBadArgument, "standard input is a terminal: pipe a file, or name one"};
  }
  return {};
}

Exit run(OptionTable& options, const char* invoked, const FileProgram& program) {
  SeveralInputs several(options);
  if (Error error = several.plan()) return Exit::usage(error);
  if (Error error = several.check()) return Exit::usage(error);
  if (Error error = checkTerminal(options)) return Exit::usage(error);
  StandardOutput stream;
  if (Error error = stream.take(options)) return Exit::usage(error);
  if (Error error = program.finish()) return Exit::usage(error);
  if (Error error = checkPlacesWritten(options)) return Exit::usage(error);
  if (Error error = checkOptionsWritten(options)) return Exit::usage(error);
  Exit exit = several.any() ? several.run(invoked) : program.run();
  const bool done = exit.status == kExitDone || exit.status == kExitBeyondLimits;
  if (!done) return exit;
  if (Error error = stream.send()) return error;
  return exit;
}

}  // namespace

int runFileProgram(OptionTable& options, int argc, const char* const* argv,
                   const FileProgram& program) {
  return runProgram(options, argc, argv, program.relief,
                    [&] { return run(options, argv[0], program); });
}

}  // namespace pcl_slim
