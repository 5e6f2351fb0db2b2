// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/version.h"

namespace pcl_slim {

/** \brief Exit status of every program. */
enum ExitStatus : int {
  kExitDone = 0,
  kExitFailed = 1,         ///< the work failed; no output file is left
  kExitUsage = 2,          ///< unknown or malformed option, missing or unreadable input
  kExitBeyondLimits = 3,   ///< the work is done, and what it measured is not within given limits
  kExitInterrupted = 130,  ///< stopped by Ctrl-C
};

/** \brief What a text of the command line names. A "-" in place of a file that is read or written
 * is standard input or output. */
enum class FileUse {
  kNone,
  kRead,     ///< a file that is read
  kWritten,  ///< a file that is written
  kScratch,  ///< a folder for temporary files
  kKept,     ///< a folder whose files belong to one input
};

/** \brief Names of outputs that are not given one by one. */
struct OutputNames {
  std::string folder;  ///< each input's output goes here, or none
  std::string format;  ///< extension without its dot, or none
};

class OptionTable;

/** \brief What the process of each of several inputs gets from that of the input before. */
struct HandedOn {
  std::string write, read;  ///< options, without their dashes: one file that both name
  /** \brief Whether it is handed on, by the options given. */
  std::function<bool(const OptionTable& options)> wanted;
  /** \brief Whether what was written is of use for the next input. */
  std::function<bool(const std::string& text)> keeps;
};

/** \brief A program's arguments: each declared once, for parsing, help and documentation.
 *
 * Options have one dash and a separate value, as PCL's tools do; two dashes and -name=value mean
 * the same. A switch may come without a value: -quiet is -quiet 1. A 0, 1, true, false, on or off
 * right after a switch is always its value, so a file of that name is written ./0 there. A target's
 * value at the time of declaration is the default that the help shows; targets must outlive
 * parse().
 */
class OptionTable {
 public:
  /** \param[in] summary one sentence shown above the options. */
  OptionTable(std::string program, std::string version, std::string summary);

  /** \brief The next argument without a dash; all of them must be given. */
  void positional(const std::string& name, std::string* target, const std::string& help) {
    positionals_.push_back({name, help, target, FileUse::kNone});
  }
  /** \brief One that is a file to read. With -out, several may be given. */
  void input(const std::string& name, std::string* target, const std::string& help) {
    positionals_.push_back({name, help, target, FileUse::kRead});
  }
  /** \brief Lets any number of arguments without a dash follow the last one. Of programs without
   * -out. */
  void furtherInputs(std::vector<std::string>* targets) { further_ = targets; }
  /** \brief One that is the file to write. \param[in] name ends in its formats: "OUT.pcd|.ply"
   * \param[in] usual extension of an output without a name: ".ply"; empty: its input's */
  void output(const std::string& name, std::string* target, const std::string& help,
              const std::string& usual);

  /** \brief The same of a file that may be left out; the target then stays as it is. It is the last
   * argument. */
  void optionalOutput(const std::string& name, std::string* target, const std::string& help,
                      const std::string& usual);
  /** \brief A status that only this program ends with, for the manual page. */
  void endsWith(int status, const std::string& meaning) { statuses_.push_back({status, meaning}); }

  /** \brief A function that takes a value read. */
  template <typename Value>
  using Store = std::function<void(Value)>;

  void integer(const std::string& name, const Store<std::int64_t>& store, std::int64_t low,
               std::int64_t high, const std::string& help, const std::string& default_text);
  /** \param[in] unset text shown instead of the target's value. */
  template <typename Whole>
  void integer(const std::string& name, Whole* target, std::int64_t low, std::int64_t high,
               const std::string& help, const std::string& unset = "") {
    integer(
        name, [target](std::int64_t value) { *target = static_cast<Whole>(value); }, low, high,
        help, unset.empty() ? std::to_string(*target) : unset);
  }
  /** \brief A finite number in [low, high]. */
  void number(const std::string& name, const Store<double>& store, double low, double high,
              const std::string& help, const std::string& default_text);
  void number(const std::string& name, double* target, double low, double high,
              const std::string& help, const std::string& unset = "");
  /** \brief A switch: 0 or 1; without a value it is 1. */
  void toggle(const std::string& name, const Store<bool>& store, const std::string& help,
              const std::string& default_text);
  void toggle(const std::string& name, bool* target, const std::string& help);
  /** \brief A switch that stays unset unless given. \param[in] unset text shown as its default. */
  void toggle(const std::string& name, std::optional<bool>* target, const std::string& help,
              const std::string& unset);
  /** \brief Text; the help shows value_name in its place. */
  void text(const std::string& name, std::string* target, const std::string& value_name,
            const std::string& help, FileUse use = FileUse::kNone);
  /** \brief One of a few words. */
  void choice(const std::string& name, std::string* target, const std::vector<std::string>& words,
              const std::string& help);
  /** \brief Numbers separated by commas, as many as value_name has parts ("X,Y,Z"); when not
   * given, the target stays empty. */
  void numbers(const std::string& name, const Store<const std::vector<double>&>& store,
               const std::string& value_name, const std::string& help);
  void numbers(const std::string& name, std::vector<double>* target, const std::string& value_name,
               const std::string& help);
  /** \brief Three numbers, or none. */
  void numbers(const std::string& name, std::optional<std::array<double, 3>>* target,
               const std::string& value_name, const std::string& help);
  /** \brief Adds -out, the folder of the outputs of several inputs, and -format, that of an output
   * without a name. Needs output(). */
  void outputNames(OutputNames* names);
  /** \brief With several inputs, what one option writes is read by another one's next process. */
  void handOn(HandedOn handed_on) { handed_on_ = std::move(handed_on); }
  /** \brief What handOn() was given, or null. */
  const HandedOn* handedOn() const { return handed_on_.write.empty() ? nullptr : &handed_on_; }
  /** \brief Of these options at most one may be given. */
  void exclusive(const std::vector<std::string>& names);

  /** \brief Reads the command line into the targets.
   *
   * \return nothing when the program should run; otherwise the status to exit with, after the
   * help (status 0) or one line naming the mistake and the remedy (status 2) has been printed.
   */
  std::optional<int> parse(int argc, const char* const* argv);

  /** \brief Whether an option was on the command line. */
  bool given(const std::string& name) const;

  /** \brief An argument that names a file or folder. */
  struct NamedFile {
    std::string name;        ///< of the option, with its dash, or of the argument
    std::string value_name;  ///< "FILE.png"
    FileUse use;
    std::string* target;
  };
  /** \brief Arguments and options that name files and folders, in the order of the help. */
  std::vector<NamedFile> files() const;

  /** \brief The inputs given with -out; empty without it. */
  const std::vector<std::string>& inputs() const { return inputs_; }
  /** \brief The options of each of several inputs as they were given, with their values: all but
   * -out, -format and -json. */
  const std::vector<std::string>& commonOptions() const { return common_options_; }
  /** \brief Formats of the output: ".pcd", ".ply". */
  const std::vector<std::string>& formats() const { return formats_; }
  /** \brief Where the name of the output is read to; null: the program writes none. */
  std::string* output() const { return output_; }
  /** \brief Those of outputNames(), or null. */
  const OutputNames* names() const { return names_; }
  /** \brief Extension of an output without a name. \param[in] input that it is made of \return
   * an empty text where it cannot be known. */
  std::string unnamedExtension(const std::string& input) const;

  const std::string& program() const { return program_; }
  const std::string& version() const { return version_; }

  /** \brief The text of -h. */
  std::string help() const;
  /** \brief The options as a Markdown table: the text in docs/. */
  std::string markdown() const;
  /** \brief The manual page, as man reads it. */
  std::string manual() const;
  /** \brief A script by which bash completes the program's arguments. */
  std::string completion() const;

 private:
  enum class Kind { kNumber, kToggle, kText };

  struct Option {
    Kind kind = Kind::kText;
    std::string name, value_name, help, default_text;
    /** Stores a value; returns what is wanted instead, or an empty text. */
    std::function<std::string(const std::string&)> assign;
    std::string range = {};  ///< "1 to 4, ", where a help line can show it
    bool given = false;
    FileUse use = FileUse::kNone;
    std::string* target = nullptr;  ///< of a text
  };
  struct Positional {
    std::string name, help;
    std::string* target = nullptr;
    FileUse use = FileUse::kNone;
    bool optional = false;
  };

  std::string parseArguments(int argc, const char* const* argv);
  std::string takePositional(const std::string& word, const Option* bare, std::size_t& next);
  std::string takeOption(Option& option, const std::optional<std::string>& own,
                         const char* following, bool& used);
  std::string unknownOption(const std::string& word) const;
  std::string checkExclusive() const;
  std::string checkPositionals(std::size_t count);
  std::string useStreams();
  /** The arguments after the program's name, one text for each way to give them. */
  std::vector<std::string> forms() const;
  std::string syntax() const;
  const Option* find(const std::string& name) const;

  std::string program_, version_, summary_;
  std::vector<Positional> positionals_;
  std::vector<Option> options_;
  std::vector<std::vector<std::string>> exclusive_;
  std::vector<std::pair<int, std::string>> statuses_;
  std::vector<std::string>* further_ = nullptr;  ///< furtherInputs()
  std::vector<std::string> formats_, inputs_, common_options_;
  std::string usual_;
  std::string* output_ = nullptr;
  const OutputNames* names_ = nullptr;
  HandedOn handed_on_;
  bool has_folder_ = false;  ///< -out is on the command line
};

/** \brief The word that another one resembles most, or an empty text. */
std::string nearestWord(const std::string& word, const std::vector<std::string>& words);

/** \brief What a word means to a switch: 1, true, on or 0, false, off; nothing if it means nothing.
 */
std::optional<bool> switchValue(const std::string& word);

/** \brief The same arguments with one dash and a separate value each: --name=value is -name value.
 */
std::vector<std::string> plainArguments(int argc, const char* const* argv);

/** \brief A number in plain notation: at most a given number of significant digits, no needless
 * zeros. */
inline std::string numberText(double value, int digits = 6) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

/** \brief Reads finite numbers separated by single commas; nothing else may separate them. */
inline bool parseNumberList(const std::string& text, std::vector<double>& values) {
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at || !std::isfinite(value)) return false;
    values.push_back(value);
    if (*end == '\0') return true;
    if (*end != ',') return false;
    at = end + 1;
  }
}

/** \brief Text for a terminal: control characters, which names of files may have, become '?'. */
std::string printable(std::string text);

}  // namespace pcl_slim
