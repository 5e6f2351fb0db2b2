// SPDX-License-Identifier: BSD-3-Clause
#include "common/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "pcl_slim/core/file_access.h"

// The list of options, and the option that an unknown one resembles. Then the command line into the
// options' targets. option_texts.cpp makes the texts of the list.

namespace pcl_slim {

namespace {

/** Number of single-letter edits between two words. */
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

/** "1 to 4, " for a small range: what a help line can show. */
std::string smallRange(std::int64_t low, std::int64_t high) {
  return high <= 10000 ? std::to_string(low) + " to " + std::to_string(high) + ", " : "";
}

template <typename T>
bool parseWhole(const std::string& text, T& value) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

bool parseNumber(const std::string& text, double& value) {
  return parseWhole(text, value) && std::isfinite(value);
}

std::size_t countParts(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
}

bool parseNumbers(const std::string& text, std::size_t count, std::vector<double>& values) {
  std::vector<double> parsed;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    double value = 0.0;
    if (!parseNumber(text.substr(begin, end - begin), value)) return false;
    parsed.push_back(value);
    begin = end + 1;
  }
  if (parsed.size() != count) return false;
  values = parsed;
  return true;
}

std::string rangeText(double low, double high) {
  if (high >= 1e18) return low > -1e18 ? " of at least " + numberText(low) : std::string();
  return " from " + numberText(low) + " to " + numberText(high);
}

}  // namespace

OptionTable::OptionTable(std::string program, std::string version, std::string summary)
    : program_(std::move(program)), version_(std::move(version)), summary_(std::move(summary)) {}

void OptionTable::output(const std::string& name, std::string* target, const std::string& help,
                         const std::string& usual) {
  positionals_.push_back({name, help, target, FileUse::kWritten});
  output_ = target;
  usual_ = usual;
  for (std::size_t begin = name.find('.'); begin < name.size();) {
    const std::size_t end = std::min(name.find('|', begin), name.size());
    formats_.push_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
}

void OptionTable::optionalOutput(const std::string& name, std::string* target,
                                 const std::string& help, const std::string& usual) {
  output(name, target, help, usual);
  positionals_.back().optional = true;
}

void OptionTable::integer(const std::string& name, const Store<std::int64_t>& store,
                          std::int64_t low, std::int64_t high, const std::string& help,
                          const std::string& default_text) {
  const auto least = static_cast<double>(low), most = static_cast<double>(high);
  const auto assign = [store, least, most](const std::string& text) -> std::string {
    std::int64_t value = 0;
    const bool read = parseWhole(text, value);
    const auto v = static_cast<double>(value);
    if (!read || v < least || v > most) return "a whole number" + rangeText(least, most);
    store(value);
    return "";
  };
  options_.push_back({Kind::kNumber, name, "N", help, default_text, assign, smallRange(low, high)});
}

void OptionTable::number(const std::string& name, const Store<double>& store, double low,
                         double high, const std::string& help, const std::string& default_text) {
  const auto assign = [store, low, high](const std::string& text) -> std::string {
    double value = 0.0;
    if (!parseNumber(text, value) || value < low || value > high)
      return "a number" + rangeText(low, high);
    store(value);
    return "";
  };
  options_.push_back({Kind::kNumber, name, "X", help, default_text, assign});
}

void OptionTable::number(const std::string& name, double* target, double low, double high,
                         const std::string& help, const std::string& unset) {
  number(
      name, [target](double value) { *target = value; }, low, high, help,
      unset.empty() ? numberText(*target) : unset);
}

void OptionTable::toggle(const std::string& name, const Store<bool>& store, const std::string& help,
                         const std::string& default_text) {
  const auto assign = [store](const std::string& text) {
    const std::optional<bool> on = switchValue(text);
    if (on) store(*on);
    return on ? "" : "0 or 1";
  };
  options_.push_back({Kind::kToggle, name, "[0|1]", help, default_text, assign});
}

void OptionTable::toggle(const std::string& name, bool* target, const std::string& help) {
  toggle(
      name, [target](bool on) { *target = on; }, help, *target ? "1" : "0");
}

void OptionTable::toggle(const std::string& name, std::optional<bool>* target,
                         const std::string& help, const std::string& unset) {
  toggle(
      name, [target](bool on) { *target = on; }, help, unset);
}

void OptionTable::text(const std::string& name, std::string* target, const std::string& value_name,
                       const std::string& help, FileUse use) {
  const auto assign = [target, value_name](const std::string& text) {
    *target = text;
    return text.empty() ? value_name : "";
  };
  Option option{Kind::kText, name, value_name, help, target->empty() ? "none" : *target, assign};
  option.use = use;
  option.target = target;
  options_.push_back(option);
}

void OptionTable::outputNames(OutputNames* names) {
  names_ = names;
  text("out", &names->folder, "DIR",
       "folder of the outputs, one for each IN and named after it; several IN may be given",
       FileUse::kScratch);
  std::vector<std::string> words;
  for (const std::string& format : formats_) words.push_back(format.substr(1));
  choice("format", &names->format, words, "format of outputs in -out and of standard output (-)");
  options_.back().default_text = usual_.empty() ? "the input's" : usual_.substr(1);
}

void OptionTable::choice(const std::string& name, std::string* target,
                         const std::vector<std::string>& words, const std::string& help) {
  std::string value_name;
  for (const std::string& word : words) value_name += (value_name.empty() ? "" : "|") + word;
  const auto assign = [target, words, value_name](const std::string& text) {
    *target = text;
    return std::count(words.begin(), words.end(), text) ? "" : value_name;
  };
  options_.push_back({Kind::kNumber, name, value_name, help, *target, assign});
}

void OptionTable::numbers(const std::string& name, const Store<const std::vector<double>&>& store,
                          const std::string& value_name, const std::string& help) {
  const auto assign = [store, value_name](const std::string& text) {
    std::vector<double> values;
    const bool read = parseNumbers(text, countParts(value_name), values);
    if (read) store(values);
    return read ? "" : "numbers in the form " + value_name;
  };
  options_.push_back({Kind::kNumber, name, value_name, help, "none", assign});
}

void OptionTable::numbers(const std::string& name, std::vector<double>* target,
                          const std::string& value_name, const std::string& help) {
  numbers(
      name, [target](const std::vector<double>& values) { *target = values; }, value_name, help);
}

void OptionTable::numbers(const std::string& name, std::optional<std::array<double, 3>>* target,
                          const std::string& value_name, const std::string& help) {
  const auto store = [target](const std::vector<double>& values) {
    std::copy(values.begin(), values.end(), target->emplace().begin());
  };
  numbers(name, store, value_name, help);
}

void OptionTable::exclusive(const std::vector<std::string>& names) {
  exclusive_.push_back(names);
}

const OptionTable::Option* OptionTable::find(const std::string& name) const {
  for (const Option& option : options_) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

bool OptionTable::given(const std::string& name) const {
  const Option* option = find(name);
  return option && option->given;
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2);
  for (const std::string& other : words) {
    const std::size_t distance = editDistance(word, other);
    if (distance <= least && (nearest.empty() || distance < least)) {
      nearest = other;
      least = distance;
    }
  }
  return nearest;
}

std::vector<OptionTable::NamedFile> OptionTable::files() const {
  std::vector<NamedFile> files;
  for (const Positional& p : positionals_) {
    if (p.use != FileUse::kNone) files.push_back({p.name, p.name, p.use, p.target});
  }
  for (const Option& o : options_) {
    if (o.use != FileUse::kNone) files.push_back({"-" + o.name, o.value_name, o.use, o.target});
  }
  return files;
}

std::string OptionTable::unnamedExtension(const std::string& input) const {
  if (names_ != nullptr && !names_->format.empty()) return "." + names_->format;
  if (!usual_.empty()) return usual_;
  for (const std::string& format : formats_) {
    if (lowerExtension(input) == format) return format;
  }
  return "";
}

namespace {

/** An option's name and, after "=", its value, of a word that starts with one dash or two. */
struct OptionWord {
  std::string name;
  std::optional<std::string> value;

  explicit OptionWord(const std::string& word) {
    const std::size_t begin = word[1] == '-' ? 2 : 1, equals = word.find('=');
    name = word.substr(begin, equals == std::string::npos ? equals : equals - begin);
    if (equals != std::string::npos) value = word.substr(equals + 1);
  }
};

}  // namespace

std::optional<bool> switchValue(const std::string& word) {
  if (word == "1" || word == "true" || word == "on") return true;
  if (word == "0" || word == "false" || word == "off") return false;
  return std::nullopt;
}

std::vector<std::string> plainArguments(int argc, const char* const* argv) {
  std::vector<std::string> plain;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    if (i == 0 || word.size() < 2 || word[0] != '-') {
      plain.push_back(word);
      continue;
    }
    const OptionWord option(word);
    plain.push_back("-" + option.name);
    if (option.value) plain.push_back(*option.value);
  }
  return plain;
}

/** Takes an argument without a dash; the text returned, if any, is a mistake.
 * \param[in] bare the switch before it that has no value, or null. */
std::string OptionTable::takePositional(const std::string& word, const Option* bare,
                                        std::size_t& next) {
  if (has_folder_) {
    inputs_.push_back(word);
    return "";
  }
  if (next < positionals_.size()) {
    *positionals_[next++].target = word;
    return "";
  }
  if (further_ != nullptr && !bare) {
    further_->push_back(word);
    return "";
  }
  if (bare) return "option -" + bare->name + " got '" + word + "'; give 0 or 1";
  return "unexpected argument '" + word + "'; " +
         (names_ != nullptr ? "give -out DIR for several inputs, or " : "") + "see " + program_ +
         " -h";
}

/** Takes an option and its value: the one after "=", or else the next argument if there is one. A
 * switch takes a 0 or 1 only, or a word for it; without one it is 1. A text is never the name of
 * another option: that one lacks a value.
 * \param[out] used whether the next argument was taken. */
std::string OptionTable::takeOption(Option& option, const std::optional<std::string>& own,
                                    const char* following, bool& used) {
  if (option.given) return "option -" + option.name + " is given twice; give it once";
  option.given = true;
  const std::string next = following ? following : "";
  const bool is_name = next.size() > 1 && next[0] == '-' && find(OptionWord(next).name) != nullptr;
  const bool toggle = option.kind == Kind::kToggle;
  used = !own && (toggle ? switchValue(next).has_value()
                         : following && !(option.kind == Kind::kText && is_name));
  if (toggle && !own && !used) {
    option.assign("1");
    return "";
  }
  if (!own && !used) return "option -" + option.name + " needs a value: " + option.value_name;
  const std::string value = own ? *own : next;
  const std::string wanted = option.assign(value);
  return wanted.empty() ? "" : "option -" + option.name + " got '" + value + "'; give " + wanted;
}

/** Reads every argument; the text returned, if any, names the first mistake. */
std::string OptionTable::parseArguments(int argc, const char* const* argv) {
  std::size_t next = 0;
  for (int i = 1; i < argc && names_ != nullptr; ++i) {
    const std::string word = argv[i];
    has_folder_ =
        has_folder_ || (word.size() > 1 && word[0] == '-' && OptionWord(word).name == "out");
  }
  const Option* bare = nullptr;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    std::string mistake;
    if (word.size() < 2 || word[0] != '-') {
      mistake = takePositional(word, bare, next);
      bare = nullptr;
    } else {
      const OptionWord named(word);
      auto* option = const_cast<Option*>(find(named.name));
      if (!option) return unknownOption(word);
      bool used = false;
      mistake = takeOption(*option, named.value, i + 1 < argc ? argv[i + 1] : nullptr, used);
      bare = used || named.value ? nullptr : option;
      const bool common = named.name != "out" && named.name != "format" && named.name != "json";
      if (common) common_options_.push_back(word);
      if (common && used) common_options_.emplace_back(argv[i + 1]);
      i += used ? 1 : 0;
    }
    if (!mistake.empty()) return mistake;
  }
  if (std::string mistake = checkPositionals(next); !mistake.empty()) return mistake;
  if (std::string mistake = checkExclusive(); !mistake.empty()) return mistake;
  return useStreams();
}

/** \param[in] count of positional arguments that were given */
std::string OptionTable::checkPositionals(std::size_t count) {
  if (has_folder_ && !inputs_.empty()) {
    *positionals_.front().target = inputs_.front();
    return "";
  }
  if (count == positionals_.size() || positionals_[count].optional) return "";
  return "no " + positionals_[count].name + " is given; " + syntax();
}

/** Lets a "-" in place of a file that is read be standard input. */
std::string OptionTable::useStreams() {
  if (std::count(inputs_.begin(), inputs_.end(), "-") > 0) {
    return "standard input has no name to call its output in -out by: give - and the output's name";
  }
  int read = 0, written = 0;
  for (const NamedFile& file : files()) {
    if (*file.target != "-") continue;
    if (file.use == FileUse::kRead && ++read) *file.target = "/dev/stdin";
    if (file.use == FileUse::kWritten) ++written;
  }
  if (read > 1) return "standard input can be read once: give - for one file only";
  if (written > 1) return "standard output takes one file: give - for one only";
  const bool unnamed = has_folder_ || (output_ != nullptr && *output_ == "-");
  if (!given("format") || names_ == nullptr || unnamed) return "";
  return "-format is of -out and of standard output: '" + *output_ + "' has its format in its name";
}

std::string OptionTable::unknownOption(const std::string& word) const {
  std::vector<std::string> names;
  for (const Option& option : options_) names.push_back(option.name);
  const std::string nearest = nearestWord(OptionWord(word).name, names);
  const std::string hint = nearest.empty() ? "" : "did you mean -" + nearest + "? ";
  return "unknown option '" + word + "'; " + hint + "see " + program_ + " -h";
}

std::string OptionTable::checkExclusive() const {
  for (const auto& names : exclusive_) {
    std::string first;
    for (const std::string& name : names) {
      if (!given(name)) continue;
      if (!first.empty())
        return "options -" + first + " and -" + name + " exclude each other; give one";
      first = name;
    }
  }
  return "";
}

std::optional<int> OptionTable::parse(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    std::string answer;
    if (word == "-h" || word == "-help" || word == "--help") answer = help();
    if (word == "-version" || word == "--version") answer = program_ + " " + version_ + "\n";
    if (word == "--help-markdown") answer = markdown();
    if (word == "--help-man") answer = manual();
    if (word == "--help-completion") answer = completion();
    if (answer.empty()) continue;
    std::fputs(answer.c_str(), stdout);
    return kExitDone;
  }
  const std::string mistake = parseArguments(argc, argv);
  if (mistake.empty()) return std::nullopt;
  std::fprintf(stderr, "%s: %s\n", program_.c_str(), printable(mistake).c_str());
  return kExitUsage;
}

std::string printable(std::string text) {
  const auto at = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    // U+0080 to U+009F are control characters, too: 0xc2 and a byte below 0xa0.
    const bool wide = at(i) == 0xc2 && i + 1 < text.size() && at(i + 1) >= 0x80 && at(i + 1) < 0xa0;
    if (wide) text.erase(i, 1);
    if (wide || at(i) < ' ' || at(i) == 0x7f) text[i] = '?';
  }
  return text;
}

}  // namespace pcl_slim
