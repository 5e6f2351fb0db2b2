// SPDX-License-Identifier: BSD-3-Clause
#include "common/man_page.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "common/options.h"

namespace pcl_slim {

namespace {

constexpr const char* kDate = "2026-11-29";  ///< of the text that all pages share

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/** "Moves points." as the line of whatis: "moves points". Names such as SLIM keep their capitals. */
std::string whatis(std::string summary) {
  if (summary.size() > 1 && std::islower(static_cast<unsigned char>(summary[1])))
    summary[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(summary[0])));
  if (!summary.empty() && summary.back() == '.') summary.pop_back();
  return summary;
}

}  // namespace

std::string manText(const std::string& text) {
  std::string escaped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]));
    switch (text[i]) {
      case '\\': escaped += "\\e"; break;
      case '^': escaped += "\\(ha"; break;
      case '~': escaped += "\\(ti"; break;
      case '`': escaped += "\\(ga"; break;
      case '-': escaped += begins ? "\\-" : "-"; break;
      default: escaped += text[i];
    }
  }
  return escaped;
}

ManPage::ManPage(const std::string& program, const std::string& version,
                 const std::string& summary) {
  text_ = ".TH " + upper(program) + " 1 " + kDate + " \"pcl_slim " + version + "\" \"pcl_slim\"\n";
  section("NAME");
  wrap(program + " \\- " + manText(whatis(summary)));
}

void ManPage::section(const std::string& title) {
  text_ += ".SH " + (title.find(' ') == std::string::npos ? title : "\"" + title + "\"") + "\n";
}

void ManPage::form(const std::string& program, const std::string& rest) {
  if (text_.compare(text_.size() - 9, 9, "SYNOPSIS\n") != 0) text_ += ".br\n";
  text_ += ".B " + program + "\n";
  wrap(manText(rest));
}

void ManPage::paragraph(const std::string& text) {
  const std::size_t line = text_.rfind('\n', text_.size() - 2) + 1;
  if (text_.compare(line, 3, ".SH") != 0) text_ += ".PP\n";
  wrap(manText(text));
}

void ManPage::item(const std::string& term, const std::string& rest, const std::string& meaning) {
  text_ += ".TP\n\\fB" + manText(term) + "\\fR" + (rest.empty() ? "" : " ") + manText(rest) + "\n";
  wrap(manText(meaning));
}

void ManPage::exitStatus(const std::vector<std::pair<int, std::string>>& more) {
  section("EXIT STATUS");
  item("0", "", "The work is done.");
  item("1", "", "The work failed, or that of one of several inputs; no output of it is left.");
  item("2", "", "An option, an input or the place of an output cannot be used.");
  for (const auto& [status, meaning] : more) item(std::to_string(status), "", meaning);
  item("130", "", "Ctrl-C stopped the program; no output is left.");
}

void ManPage::seeAlso(std::vector<std::string> programs) {
  section("SEE ALSO");
  std::sort(programs.begin(), programs.end());
  for (std::size_t i = 0; i < programs.size(); ++i)
    text_ += ".BR " + programs[i] + " (1)" + (i + 1 < programs.size() ? "," : "") + "\n";
}

void ManPage::wrap(const std::string& text) {
  constexpr std::size_t kColumns = 78;
  std::istringstream words(text);
  std::string line;
  const auto end = [&] {
    // A line that begins with a dot or an apostrophe would be a macro.
    if (!line.empty()) text_ += (line[0] == '.' || line[0] == '\'' ? "\\&" : "") + line + "\n";
    line.clear();
  };
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kColumns) end();
    line += (line.empty() ? "" : " ") + word;
  }
  end();
}

}  // namespace pcl_slim
