// SPDX-License-Identifier: BSD-3-Clause
// What options there are, and what is said of them: help, documentation, and the option that an
// unknown one resembles.
#include "common/options.h"

#include <algorithm>
#include <numeric>

#include "common/number_text.h"

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
  const bool has_switch = std::any_of(options_.begin(), options_.end(),
                                      [](const Option& o) { return o.kind == Kind::kToggle; });
  if (has_switch)
    text += "  A switch [0|1] alone is 1; a file named 0 or 1 is written ./0 or ./1.\n";
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
