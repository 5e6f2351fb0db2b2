// SPDX-License-Identifier: BSD-3-Clause
#include "common/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace pcl_slim {

namespace {

std::string
shortNumber(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

template <typename T>
bool
parseWhole(const std::string& text, T& value)
{
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

bool
parseNumber(const std::string& text, double& value)
{
  return parseWhole(text, value) && std::isfinite(value);
}

/** Number of single-letter edits between two words. */
std::size_t
editDistance(const std::string& a, const std::string& b)
{
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

std::size_t
countParts(const std::string& text)
{
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
}

bool
parseNumbers(const std::string& text, std::size_t count, std::vector<double>& values)
{
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

/** "1 to 4, " for whole numbers of a small range: what a help line can show. */
std::string
smallRange(bool whole, double low, double high)
{
  return whole && high <= 10000 ? shortNumber(low) + " to " + shortNumber(high) + ", "
                                : std::string();
}

std::string
rangeText(double low, double high)
{
  if (high >= 1e18) return low > -1e18 ? " of at least " + shortNumber(low) : std::string();
  return " from " + shortNumber(low) + " to " + shortNumber(high);
}

}  // namespace

OptionTable::OptionTable(std::string program, std::string version, std::string summary)
    : program_(std::move(program)), version_(std::move(version)), summary_(std::move(summary))
{
}

OptionTable::Option&
OptionTable::add(const std::string& name, Kind kind, void* target, const std::string& help)
{
  Option option;
  option.name = name;
  option.kind = kind;
  option.target = target;
  option.help = help;
  options_.push_back(std::move(option));
  return options_.back();
}

void
OptionTable::positional(const std::string& name, std::string* target, const std::string& help)
{
  positionals_.push_back({name, help, target});
}

void
OptionTable::integer(const std::string& name, int* target, std::int64_t low, std::int64_t high,
                     const std::string& help, const std::string& unset)
{
  Option& option = add(name, Kind::kInteger, target, help);
  option.low = static_cast<double>(low);
  option.high = static_cast<double>(high);
  option.value_name = "N";
  option.default_text = unset.empty() ? std::to_string(*target) : unset;
}

void
OptionTable::integer(const std::string& name, std::uint64_t* target, std::uint64_t low,
                     std::uint64_t high, const std::string& help)
{
  Option& option = add(name, Kind::kUnsigned, target, help);
  option.low = static_cast<double>(low);
  option.high = static_cast<double>(high);
  option.value_name = "N";
  option.default_text = std::to_string(*target);
}

void
OptionTable::number(const std::string& name, double* target, double low, double high,
                    const std::string& help, const std::string& unset)
{
  Option& option = add(name, Kind::kNumber, target, help);
  option.low = low;
  option.high = high;
  option.value_name = "X";
  option.default_text = unset.empty() ? shortNumber(*target) : unset;
}

void
OptionTable::toggle(const std::string& name, bool* target, const std::string& help)
{
  Option& option = add(name, Kind::kToggle, target, help);
  option.value_name = "0|1";
  option.default_text = *target ? "1" : "0";
}

void
OptionTable::text(const std::string& name, std::string* target, const std::string& value_name,
                  const std::string& help)
{
  Option& option = add(name, Kind::kText, target, help);
  option.value_name = value_name;
  option.default_text = target->empty() ? "none" : *target;
}

void
OptionTable::choice(const std::string& name, std::string* target,
                    const std::vector<std::string>& words, const std::string& help)
{
  Option& option = add(name, Kind::kChoice, target, help);
  option.words = words;
  for (const std::string& word : words) {
    option.value_name += (option.value_name.empty() ? "" : "|") + word;
  }
  option.default_text = *target;
}

void
OptionTable::numbers(const std::string& name, std::vector<double>* target,
                     const std::string& value_name, const std::string& help)
{
  Option& option = add(name, Kind::kNumbers, target, help);
  option.value_name = value_name;
  option.default_text = "none";
}

void
OptionTable::exclusive(const std::vector<std::string>& names)
{
  exclusive_.push_back(names);
}

const OptionTable::Option*
OptionTable::find(const std::string& name) const
{
  for (const Option& option : options_) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

bool
OptionTable::given(const std::string& name) const
{
  const Option* option = find(name);
  return option && option->given;
}

std::string
OptionTable::nearestName(const std::string& name) const
{
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, name.size() / 2);
  for (const Option& option : options_) {
    const std::size_t distance = editDistance(name, option.name);
    if (distance <= least && (nearest.empty() || distance < least)) {
      nearest = option.name;
      least = distance;
    }
  }
  return nearest;
}

/** Stores a value; the text returned, if any, says what the option wants instead. */
std::string
OptionTable::assign(Option& option, const std::string& value)
{
  const auto inRange = [&](double v) { return v >= option.low && v <= option.high; };
  switch (option.kind) {
    case Kind::kInteger: {
      std::int64_t v = 0;
      if (!parseWhole(value, v) || !inRange(static_cast<double>(v))) {
        return "a whole number" + rangeText(option.low, option.high);
      }
      *static_cast<int*>(option.target) = static_cast<int>(v);
      return "";
    }
    case Kind::kUnsigned: {
      std::uint64_t v = 0;
      if (!parseWhole(value, v) || !inRange(static_cast<double>(v))) {
        return "a whole number" + rangeText(option.low, option.high);
      }
      *static_cast<std::uint64_t*>(option.target) = v;
      return "";
    }
    case Kind::kNumber: {
      double v = 0.0;
      if (!parseNumber(value, v) || !inRange(v)) {
        return "a number" + rangeText(option.low, option.high);
      }
      *static_cast<double*>(option.target) = v;
      return "";
    }
    case Kind::kToggle:
      *static_cast<bool*>(option.target) = value == "1";
      return value == "0" || value == "1" ? "" : "0 or 1";
    case Kind::kText: *static_cast<std::string*>(option.target) = value; return "";
    case Kind::kChoice:
      *static_cast<std::string*>(option.target) = value;
      return std::count(option.words.begin(), option.words.end(), value) ? "" : option.value_name;
    case Kind::kNumbers:
      return parseNumbers(value, countParts(option.value_name),
                          *static_cast<std::vector<double>*>(option.target))
                 ? ""
                 : "numbers in the form " + option.value_name;
  }
  return "";
}

/** Reads every argument; the text returned, if any, names the first mistake. */
std::string
OptionTable::parseArguments(int argc, const char* const* argv)
{
  std::size_t next = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.size() < 2 || word[0] != '-') {
      if (next == positionals_.size()) {
        return "unexpected argument '" + word + "'; see " + program_ + " -h";
      }
      *positionals_[next++].target = word;
      continue;
    }
    auto* option = const_cast<Option*>(find(word.substr(1)));
    if (!option) {
      const std::string nearest = nearestName(word.substr(word[1] == '-' ? 2 : 1));
      const std::string hint = nearest.empty() ? "" : "did you mean -" + nearest + "? ";
      return "unknown option '" + word + "'; " + hint + "see " + program_ + " -h";
    }
    if (option->given) return "option -" + option->name + " is given twice; give it once";
    if (i + 1 == argc) return "option -" + option->name + " needs a value: " + option->value_name;
    const std::string wanted = assign(*option, argv[++i]);
    option->given = true;
    if (!wanted.empty()) {
      return "option -" + option->name + " got '" + argv[i] + "'; give " + wanted;
    }
  }
  if (next < positionals_.size()) return "no " + positionals_[next].name + " is given; " + syntax();
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

std::optional<int>
OptionTable::parse(int argc, const char* const* argv)
{
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    std::string answer;
    if (word == "-h" || word == "--help") answer = help();
    if (word == "-version" || word == "--version") answer = program_ + " " + version_ + "\n";
    if (word == "--help-markdown") answer = markdown();
    if (answer.empty()) continue;
    std::fputs(answer.c_str(), stdout);
    return kExitDone;
  }
  const std::string mistake = parseArguments(argc, argv);
  if (mistake.empty()) return std::nullopt;
  std::fprintf(stderr, "%s: %s\n", program_.c_str(), mistake.c_str());
  return kExitUsage;
}

std::string
OptionTable::syntax() const
{
  std::string text = "Syntax is: " + program_;
  for (const Positional& positional : positionals_) text += " " + positional.name;
  return text + (options_.empty() ? "" : " <options>");
}

std::string
OptionTable::help() const
{
  std::size_t width = 0;
  for (const Positional& p : positionals_) width = std::max(width, p.name.size());
  for (const Option& o : options_) width = std::max(width, o.name.size() + o.value_name.size() + 2);
  const auto row = [width](const std::string& left, const std::string& right) {
    return std::string(width + 4 - left.size(), ' ') + left + " = " + right + "\n";
  };
  std::string text = syntax() + "\n" + summary_ + "\n  where:\n";
  for (const Positional& p : positionals_) text += row(p.name, p.help);
  text += "  where options are:\n";
  for (const Option& o : options_) {
    text += row("-" + o.name + " " + o.value_name,
                o.help + " (" + smallRange(o.kind == Kind::kInteger, o.low, o.high) +
                    "default: " + o.default_text + ")");
  }
  text += row("-h", "this text") + row("-version", "the version");
  return text;
}

std::string
OptionTable::markdown() const
{
  const auto escaped = [](std::string text) {
    for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) {
      text.insert(i, "\\");
    }
    return text;
  };
  std::string text = "| argument | values | meaning |\n|---|---|---|\n";
  for (const Positional& p : positionals_) {
    text += "| `" + escaped(p.name) + "` | | " + escaped(p.help) + " |\n";
  }
  for (const Option& o : options_) {
    text += "| `-" + o.name + " " + escaped(o.value_name) + "` | " +
            smallRange(o.kind == Kind::kInteger, o.low, o.high) + "default " +
            escaped(o.default_text) + " | " + escaped(o.help) + " |\n";
  }
  return text;
}

}  // namespace pcl_slim
