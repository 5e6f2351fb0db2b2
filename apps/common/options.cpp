// SPDX-License-Identifier: BSD-3-Clause
// The list of options and its uses: help, documentation, and the option that an
// unknown one resembles.
#include "common/options.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "common/number_list.h"

namespace pcl_slim {

namespace {

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

/** "1 to 4, " for whole numbers of a small range: what a help line can show. */
std::string
smallRange(bool whole, double low, double high)
{
  return whole && high <= 10000 ? numberText(low) + " to " + numberText(high) + ", "
                                : std::string();
}

/** One argument of the help: its name, then its meaning in lines that end before column 80. */
std::string
helpRow(const std::string& name, const std::string& meaning)
{
  constexpr std::size_t kIndent = 28, kColumns = 79;
  std::string text = "  " + name;
  if (text.size() + 2 > kIndent) text += "\n";
  std::size_t column = text.back() == '\n' ? 0 : text.size();
  std::istringstream words(meaning);
  for (std::string word; words >> word;) {
    if (column >= kIndent && column + 1 + word.size() > kColumns) {
      text += "\n";
      column = 0;
    }
    const std::size_t gap = column < kIndent ? kIndent - column : 1;
    text += std::string(gap, ' ') + word;
    column += gap + word.size();
  }
  return text + "\n";
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
  option.default_text = unset.empty() ? numberText(*target) : unset;
}

template <typename Target>
void
OptionTable::addSwitch(const std::string& name, Target* target, const std::string& default_text,
                       const std::string& help)
{
  Option& option = add(name, Kind::kToggle, target, help);
  option.value_name = "[0|1]";
  option.default_text = default_text;
  option.turn = [target](bool on) { *target = on; };
}

void
OptionTable::toggle(const std::string& name, bool* target, const std::string& help)
{
  addSwitch(name, target, *target ? "1" : "0", help);
}

void
OptionTable::toggle(const std::string& name, std::optional<bool>* target, const std::string& help,
                    const std::string& unset)
{
  addSwitch(name, target, unset, help);
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
  std::string text = syntax() + "\n" + summary_ + "\n\nArguments:\n";
  for (const Positional& p : positionals_) text += helpRow(p.name, p.help);
  text += "\nOptions:\n";
  for (const Option& o : options_) {
    text += helpRow("-" + o.name + " " + o.value_name,
                    o.help + " (" + smallRange(o.kind == Kind::kInteger, o.low, o.high) +
                        "default: " + o.default_text + ")");
  }
  text += helpRow("-h", "this text") + helpRow("-version", "the version");
  const bool has_switch = std::any_of(options_.begin(), options_.end(),
                                      [](const Option& o) { return o.kind == Kind::kToggle; });
  if (has_switch) {
    text +=
        "\n-name VALUE may be written --name VALUE or -name=VALUE. A switch [0|1] alone\n"
        "is 1; true, false, on and off will do, too. A file of such a name is written\n"
        "./0.\n";
  }
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
