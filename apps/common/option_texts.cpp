// SPDX-License-Identifier: BSD-3-Clause
// The texts that are made of a table of options: help, tables of pages, manual page, completion.
#include <algorithm>
#include <cctype>
#include <sstream>
#include <string>
#include <vector>

#include "common/man_page.h"
#include "common/options.h"

namespace pcl_slim {

namespace {

/** One argument of the help: its name, then its meaning in lines that end before column 80. */
std::string helpRow(const std::string& name, const std::string& meaning) {
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

std::vector<std::string> OptionTable::forms() const {
  const std::string rest = options_.empty() ? "" : " <options>";
  std::string given;
  for (const Positional& p : positionals_)
    given += (given.empty() ? "" : " ") + (p.optional ? "[" + p.name + "]" : p.name);
  std::vector<std::string> all = {given + rest};
  if (names_ != nullptr) all.push_back(positionals_.front().name + "... -out DIR" + rest);
  return all;
}

std::string OptionTable::syntax() const {
  return "Syntax is: " + program_ + " " + forms().front();
}

std::string OptionTable::help() const {
  std::string text = syntax() + "\n";
  for (std::size_t i = 1; i < forms().size(); ++i)
    text += "       or: " + program_ + " " + forms()[i] + "\n";
  text += summary_ + "\n\nArguments:\n";
  for (const Positional& p : positionals_) text += helpRow(p.name, p.help);
  text += "\nOptions:\n";
  for (const Option& o : options_) {
    text += helpRow("-" + o.name + " " + o.value_name,
                    o.help + " (" + o.range + "default: " + o.default_text + ")");
  }
  text += helpRow("-h, -help", "this text") + helpRow("-version", "the version");
  const bool has_switch = std::any_of(options_.begin(), options_.end(),
                                      [](const Option& o) { return o.kind == Kind::kToggle; });
  if (has_switch) {
    text +=
        "\n-name VALUE may be written --name VALUE or -name=VALUE. A switch [0|1] alone\n"
        "is 1; true, false, on and off will do, too. A file of such a name is written\n"
        "./0.\n";
  }
  const auto named = files();
  if (std::any_of(named.begin(), named.end(),
                  [](const NamedFile& file) { return file.use == FileUse::kRead; }))
    text += "\nA file named - is standard input or, where it is written, standard output.\n";
  return text;
}

std::string OptionTable::markdown() const {
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
    text += "| `-" + o.name + " " + escaped(o.value_name) + "` | " + o.range + "default " +
            escaped(o.default_text) + " | " + escaped(o.help) + " |\n";
  }
  return text;
}

std::string OptionTable::manual() const {
  ManPage page(program_, version_, summary_);
  page.section("SYNOPSIS");
  for (const std::string& form : forms()) page.form(program_, form);
  page.section("DESCRIPTION");
  page.paragraph(summary_);
  for (const Positional& p : positionals_) page.item(p.name, "", p.help);
  page.section("OPTIONS");
  page.paragraph(
      "Options may also be written --name VALUE or -name=VALUE. A switch, [0|1], is 1 where its "
      "value is left out.");
  for (const Option& o : options_) {
    page.item("-" + o.name, o.value_name,
              o.help + " (" + o.range + "default: " + o.default_text + ")");
  }
  page.item("-h, -help", "", "prints the arguments");
  page.item("-version", "", "prints the version");
  page.exitStatus(statuses_);
  if (program_ != "pcl_slim") page.seeAlso({"pcl_slim"});
  return page.text();
}

namespace {

/** The words among the values of an option: of "auto|FILE|X,Y,Z" auto. */
std::vector<std::string> wordsOf(const std::string& value_name) {
  std::vector<std::string> words;
  std::istringstream parts(value_name);
  const auto isUpper = [](unsigned char c) { return std::isupper(c) != 0; };
  for (std::string part; std::getline(parts, part, '|');) {
    const bool plain = !part.empty() && part[0] != '.' && part[0] != '[' &&
                       std::none_of(part.begin(), part.end(), isUpper);
    if (plain) words.push_back(part);
  }
  return words;
}

/** What bash offers after an option: files, folders, words or, of numbers, nothing. */
std::string offered(const std::string& value_name) {
  std::string words;
  for (const std::string& word : wordsOf(value_name)) words += (words.empty() ? "" : " ") + word;
  if (value_name.find("FILE") != std::string::npos) return "offer=files list='" + words + "'";
  if (value_name == "DIR" || value_name == "FOLDER") return "offer=folders";
  return "offer=words list='" + words + "'";
}

// What follows the table of an option's values. Bash splits -name=value at the sign.
constexpr const char* kOffer = R"(  esac
  [[ $offer != any || $word == -* ]] || offer=files
  case $offer in
    words) mapfile -t COMPREPLY < <(compgen -W "$list" -- "$word") ;;
    folders) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    files) mapfile -t COMPREPLY < <(compgen -W "$list" -- "$word"; compgen -f -- "$word") ;;
    any)
      [[ $word != --* ]] || names=-${names// -/ --}
      mapfile -t COMPREPLY < <(compgen -W "$names" -- "$word")
      ;;
  esac
  [[ $offer != f* ]] || compopt -o filenames 2> /dev/null
}
)";

}  // namespace

std::string OptionTable::completion() const {
  std::string names, cases;
  for (const Option& o : options_) {
    names += "-" + o.name + " ";
    if (o.kind != Kind::kToggle) cases += "    -" + o.name + ") " + offered(o.value_name) + " ;;\n";
  }
  return "# Completion of " + program_ + " " + version_ + " for bash: " + program_ +
         " --help-completion prints it.\n_" + program_ +
         "() {\n  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  local offer=any list= names='" +
         names +
         "-help -version'\n  COMPREPLY=()\n"
         "  if [[ $word == '=' ]]; then\n    word=\n  elif [[ $before == '=' ]]; then\n"
         "    before=${COMP_WORDS[COMP_CWORD - 2]}\n  fi\n  case ${before/#--/-} in\n" +
         cases + kOffer + "complete -F _" + program_ + " " + program_ + "\n";
}

}  // namespace pcl_slim
