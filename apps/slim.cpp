// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim: starts the program of a command.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/man_page.h"
#include "common/options.h"
#include "common/programs.h"

namespace {

using namespace pcl_slim;
namespace fs = std::filesystem;

constexpr const char* kSummary =
    "Fits, smooths, meshes, measures and draws smooth surfaces of point clouds.";

/** The folder of this program, behind links; empty where it is unknown. */
fs::path ownFolder(const char* invoked) {
  std::error_code code;
  const fs::path self = fs::read_symlink("/proc/self/exe", code);
  if (!code) return self.parent_path();
  const fs::path given = invoked;
  return given.has_parent_path() ? fs::canonical(given, code).parent_path() : fs::path();
}

/** The file of a program: beside this one or in a folder of PATH; empty where there is none. */
std::string findProgram(const std::string& name, const char* invoked) {
  std::vector<fs::path> folders = {ownFolder(invoked)};
  const char* path = std::getenv("PATH");
  const std::string listed = path != nullptr ? path : "";
  for (std::size_t begin = 0; begin < listed.size();) {
    const std::size_t end = std::min(listed.find(':', begin), listed.size());
    folders.emplace_back(listed.substr(begin, end - begin));
    begin = end + 1;
  }
  for (const fs::path& folder : folders) {
    std::error_code code;
    const fs::path file = folder / name;
    if (!folder.empty() && fs::is_regular_file(file, code) && access(file.c_str(), X_OK) == 0)
      return file.string();
  }
  return "";
}

const ProgramEntry* findCommand(const std::string& command) {
  for (const ProgramEntry& program : programs()) {
    if (command == program.command) return &program;
  }
  return nullptr;
}

int fail(const std::string& message) {
  std::fprintf(stderr, "pcl_slim: %s\n", printable(message).c_str());
  return kExitUsage;
}

int unknownCommand(const std::string& command) {
  std::vector<std::string> commands = {"help"};
  for (const ProgramEntry& program : programs()) commands.emplace_back(program.command);
  const std::string nearest = nearestWord(command, commands);
  return fail("unknown command '" + command + "'; " +
              (nearest.empty() ? "" : "did you mean " + nearest + "? ") + "see pcl_slim -h");
}

/** Becomes the program of a command; returns only where that fails. */
int start(const std::string& command, std::vector<std::string> arguments, const char* invoked) {
  const ProgramEntry* program = findCommand(command);
  if (program == nullptr) return unknownCommand(command);
  const std::string file = findProgram(program->name, invoked);
  if (file.empty()) {
    const std::string needs = program->needs;
    return fail(std::string(program->name) + " is not installed" +
                (needs.empty() ? "" : ", as it is built with " + needs + " only") +
                "; see docs/install.md");
  }
  std::vector<char*> words = {const_cast<char*>(program->name)};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  execv(file.c_str(), words.data());
  return fail("cannot start '" + file + "': " + std::strerror(errno) + "; install it again");
}

std::string help(const char* invoked) {
  std::string text =
      std::string("Syntax is: pcl_slim COMMAND <arguments>\n") + kSummary + "\n\nCommands:\n";
  for (const ProgramEntry& program : programs()) {
    const std::string command = program.command;
    text += "  " + command + std::string(11 - command.size(), ' ') + program.summary +
            (findProgram(program.name, invoked).empty() ? " (not installed)" : "") + "\n";
  }
  return text +
         "  help       Lists the arguments of a command: pcl_slim help COMMAND.\n"
         "  -version   Prints the version.\n";
}

std::string markdown() {
  std::string text = "| command | program | |\n|---|---|---|\n";
  for (const ProgramEntry& program : programs()) {
    text += "| `" + std::string(program.command) + "` | `" + program.name + "` | " +
            program.summary + " |\n";
  }
  return text;
}

std::string manual() {
  ManPage page("pcl_slim", PCL_SLIM_VERSION, kSummary);
  page.section("SYNOPSIS");
  page.form("pcl_slim", "COMMAND <arguments>");
  page.form("pcl_slim", "help COMMAND");
  page.section("DESCRIPTION");
  page.paragraph(
      "Starts the program of a command with the arguments that follow, and ends as it does. The "
      "programs are in the folder of pcl_slim, or in one of PATH.");
  std::vector<std::string> names;
  for (const ProgramEntry& program : programs()) {
    page.item(program.command, std::string("(") + program.name + ")", program.summary);
    names.emplace_back(program.name);
  }
  page.section("OPTIONS");
  page.item("-h, -help", "", "lists the commands");
  page.item("-version", "", "prints the version");
  page.exitStatus();
  page.seeAlso(names);
  return page.text();
}

// What follows the list of commands, each with its program.
constexpr const char* kBeforePrograms = R"bash(
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$commands help -help -version" -- "${COMP_WORDS[1]}")
    return
  fi
  case ${COMP_WORDS[1]} in
    help)
      mapfile -t COMPREPLY < <(compgen -W "$commands" -- "${COMP_WORDS[COMP_CWORD]}")
      return
      ;;
)bash";
constexpr const char* kAfterPrograms = R"bash(    *) return ;;
  esac
  if ! declare -F "_$program" > /dev/null; then
    if [[ -r $own/$program ]]; then
      source "$own/$program"
    else
      eval "$("$beside$program" --help-completion 2> /dev/null)"
    fi
  fi
  declare -F "_$program" > /dev/null || return
  COMP_WORDS=("$program" "${COMP_WORDS[@]:2}")
  ((--COMP_CWORD))
  "_$program"
}
complete -F _pcl_slim pcl_slim
)bash";

/** The script completes commands, and their arguments by the scripts of their programs: those in its
 * own folder or, where they are not, as the programs print them. */
std::string completion() {
  std::string commands, cases;
  for (const ProgramEntry& program : programs()) {
    commands += (commands.empty() ? "" : " ") + std::string(program.command);
    cases += std::string("    ") + program.command + ") program=" + program.name + " ;;\n";
  }
  return "# Completion of pcl_slim " PCL_SLIM_VERSION
         " for bash: pcl_slim --help-completion prints it.\n_pcl_slim() {\n"
         "  local commands='" +
         commands + "' program own=${BASH_SOURCE[0]%/*} beside=${COMP_WORDS[0]%pcl_slim}" +
         kBeforePrograms + cases + kAfterPrograms;
}

/** What an option of pcl_slim itself prints; empty for other words. */
std::string answer(const std::string& word, const char* invoked) {
  if (word == "-h" || word == "-help" || word == "--help") return help(invoked);
  if (word == "-version" || word == "--version") return "pcl_slim " PCL_SLIM_VERSION "\n";
  if (word == "--help-markdown") return markdown();
  if (word == "--help-man") return manual();
  if (word == "--help-completion") return completion();
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool helps = !arguments.empty() && arguments[0] == "help";
  const std::string text =
      arguments.empty() || (helps && argc == 2) ? help(argv[0]) : answer(arguments[0], argv[0]);
  if (!text.empty()) {
    std::fputs(text.c_str(), stdout);
    return kExitDone;
  }
  if (helps && argc > 3) return fail("help takes one command: pcl_slim help COMMAND");
  if (helps) return start(arguments[1], {"-h"}, argv[0]);
  return start(arguments[0], {arguments.begin() + 1, arguments.end()}, argv[0]);
}
