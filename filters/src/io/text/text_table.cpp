// SPDX-License-Identifier: BSD-3-Clause
// From fields to rows of numbers, and which line names the columns.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kMostColumns = 4096;
constexpr std::size_t kMostHeadLines = 1000;  ///< before the rows: more is no table
constexpr std::size_t kLeastNumbers = 3;      ///< of a row that does not begin with one

using Line = std::pair<const char*, const char*>;

bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/** A line without blanks around it; tabs at its end may separate empty fields. */
Line trimmed(const char* begin, const char* end) {
  while (begin != end && isSpace(*begin)) ++begin;
  const char* last = end;
  while (last != begin && isSpace(last[-1])) --last;
  while (last != begin && last != end && *last == '\t') ++last;
  return {begin, last};
}

bool isComment(const Line& line) {
  const char c = *line.first;
  return c == '#' || c == '%' || (line.second - line.first > 1 && c == '/' && line.first[1] == '/');
}

/** A comment's text. */
Line textOf(Line comment) {
  const auto isMark = [](char c) { return c == '#' || c == '/' || c == '%' || isSpace(c); };
  while (comment.first != comment.second && isMark(*comment.first)) ++comment.first;
  return comment;
}

/** Names of columns rarely start as numbers do. */
bool startsNumber(const TextWord& word) {
  return !word.empty() && std::strchr("+-.0123456789", *word.begin) != nullptr;
}

/** The names in a line of as many fields as there are columns, whatever separates them. */
std::vector<std::string> namesIn(const Line& line, char separator, std::size_t columns) {
  std::vector<TextWord> words;
  for (const char c : {separator, formOf(line.first, line.second).separator, ';', ',', '\t', ' '}) {
    splitLine(line.first, line.second, c, words);
    if (words.size() == columns) break;
  }
  std::vector<std::string> names;
  for (const TextWord& word : words) names.push_back(textOf(word));
  return names;
}

class TableReader {
 public:
  TableReader(const PlainText& text, const std::vector<std::string>& names)
      : at_(text.begin), end_(text.end), line_end_(lineEndOf(at_, end_)), given_(names) {}

  Result<TextTable> read() {
    while (at_ != end_) {
      const char* stop = static_cast<const char*>(
          std::memchr(at_, line_end_, static_cast<std::size_t>(end_ - at_)));
      const Line line = trimmed(at_, stop ? stop : end_);
      at_ = stop ? stop + 1 : end_;
      ++line_;
      if (line.first == line.second) continue;
      if (Error error = takeLine(line)) return error;
    }
    if (table_.columns.empty()) return badInput("it has no points: give one a line, as x y z");
    if (unsure_ && !rowsAreNumbered()) return wrongCount(first_row_, columns(), columns() - 1);
    if (expected_.value_or(0) > table_.rows()) {
      return badInput("the file is truncated: " + std::to_string(table_.rows()) + " of " +
                      std::to_string(*expected_) + " points; copy it again");
    }
    return std::move(table_);
  }

 private:
  std::size_t columns() const { return table_.columns.size(); }

  Error takeLine(const Line& line) {
    if (isComment(line)) {
      const Line text = textOf(line);
      table_.comments.emplace_back(text.first, text.second);
      if (table_.columns.empty() && text.first != text.second) comments_.push_back(text);
      return {};
    }
    const bool begun = !table_.columns.empty();
    if (!begun && takeSeparator(line)) return {};
    if (!begun && !form_.given) form_ = formOf(line.first, line.second);
    split(line);
    if (words_.empty()) return {};
    if (words_.size() == 1 && takeCount(words_[0])) return {};
    if (!begun) {
      bool row = false;
      if (Error error = lookAtHead(line, row)) return error;
      if (!row) return {};
      padFirst(line);
      if (Error error = beginRows()) return error;
    }
    if (expected_ && table_.rows() >= *expected_) {
      return badInput("line " + std::to_string(line_) + " is one point more than the " +
                      std::to_string(*expected_) +
                      " that a line before announces; correct that number, or copy the file again");
    }
    return takeRow();
  }

  /** Spreadsheets write the separator in a first line, sep=; */
  bool takeSeparator(const Line& line) {
    constexpr char kKey[] = "sep=";
    constexpr std::size_t kKeySize = sizeof(kKey) - 1;
    if (!head_.empty() || form_.given) return false;
    std::string text(line.first, line.second);
    text.erase(std::remove(text.begin(), text.end(), '"'), text.end());
    const bool tab = text.size() == kKeySize;  // a tab at the end is white space
    if (text.compare(0, kKeySize, kKey) != 0 || text.size() > kKeySize + 1) return false;
    form_ = {tab ? '\t' : text[kKeySize], true};
    return true;
  }

  void split(const Line& line) {
    splitLine(line.first, line.second, form_.separator, words_);
    // A separator at the end is followed by an empty field only where one is missing.
    if (form_.separator != ' ' && line.second[-1] == form_.separator &&
        words_.size() < std::max(table_.columns.size(), given_.size()))
      words_.push_back({line.second, line.second});
    if (open_ && words_.size() > table_.columns.size()) words_.resize(table_.columns.size());
  }

  /** The first row's last field may be empty, too. */
  void padFirst(const Line& line) {
    std::vector<std::string> names;
    if (form_.separator != ' ' && line.second[-1] == form_.separator &&
        fromHead(words_.size() + 1, true, names))
      words_.push_back({line.second, line.second});
  }

  /** A line with the number of rows that follow. */
  bool takeCount(const TextWord& word) {
    double count = 0;
    bool in_float = false;
    if (!parseDecimal(word.begin, word.end, count, in_float)) return false;
    if (!(count >= 0 && count < 1e15 && count == std::floor(count))) return false;
    expected_ = table_.rows() + static_cast<std::size_t>(count);
    return true;
  }

  /** Whether the rows begin here; other lines may name the columns. */
  Error lookAtHead(const Line& line, bool& row) {
    const auto numbers = static_cast<std::size_t>(std::count_if(
        words_.begin(), words_.end(), [](const TextWord& word) { return isNumber(word, true); }));
    row = isNumber(words_[0], true) || numbers >= kLeastNumbers;
    if (row) return {};
    if (startsNumber(words_[0]) && numbers + 1 >= kLeastNumbers) return noNumber(words_[0]);
    if (head_.empty() && textOfWord(0) == "ncols") {
      return badInput(
          "it is a grid of heights (ESRI ASCII), not a list of points; convert it: "
          "gdal_translate -of XYZ IN.asc OUT.xyz");
    }
    if (head_.size() < kMostHeadLines) head_.push_back(line);
    return {};
  }

  std::string textOfWord(std::size_t k) const {
    std::string text = pcl_slim::textOf(words_[k]);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  }

  Error beginRows() {
    first_row_ = line_;
    if (words_.size() > kMostColumns)
      return badInput("line " + std::to_string(line_) + " has more than 4096 columns; split them");
    std::vector<std::string> names;
    if (Error error = findNames(names)) return error;
    table_.columns.resize(words_.size());
    for (std::size_t k = 0; k < words_.size(); ++k) {
      TextColumn& column = table_.columns[k];
      if (!names.empty()) column.name = names[k];
      const bool number = words_[k].empty() || isNumber(words_[k], true);
      const bool named = table_.named_by != ColumnNames::kNobody;
      column.numeric = (number || (!named && startsNumber(words_[k]))) && column.name != "-";
    }
    return {};
  }

  /** The names of the columns; none where nobody names them. */
  Error findNames(std::vector<std::string>& names) {
    const std::size_t columns = words_.size();
    if (!given_.empty()) {
      names = given_;
      table_.named_by = ColumnNames::kCaller;
      if (columns == given_.size()) return {};
      return badInput("line " + std::to_string(line_) + " has " + std::to_string(columns) +
                      " columns where -columns names " + std::to_string(given_.size()) +
                      "; name each, and - for one to leave out");
    }
    if (findListNames(names)) return {};
    if (fromHead(columns, true, names) || fromComments(columns, names)) {
      table_.named_by = ColumnNames::kFile;
      table_.row_names = names[0].empty();
      return {};
    }
    // Programs for statistics number the rows; that column has no name, or not even a place for one.
    if (columns > 1 && fromHead(columns - 1, true, names)) {
      if (isNumber(words_[0], true) && !words_[0].quoted && !countsFrom(words_[0]))
        return wrongCount(line_, columns, names.size());
      unsure_ = isNumber(words_[0], true) && !words_[0].quoted;
      names.insert(names.begin(), "");
      table_.row_names = true;
      table_.named_by = ColumnNames::kFile;
      return {};
    }
    if (fromHead(columns, false, names)) {
      table_.named_by = ColumnNames::kFile;
      return {};
    }
    for (const Line& line : head_) {
      const auto other = namesIn(line, form_.separator, columns);
      if (namePlaces(other)) return wrongCount(line_, columns, other.size());
    }
    names.clear();
    return {};
  }

  /** Whether rows are numbered from 0 or 1 on. */
  static bool countsFrom(const TextWord& word) {
    return word.size() == 1 && (*word.begin == '0' || *word.begin == '1');
  }

  /** Whether the first column ascends in whole numbers. */
  bool rowsAreNumbered() const {
    bool numbered = table_.rows() > 1 && table_.columns[0].whole;
    for (std::size_t row = 1; row < table_.rows(); ++row)
      numbered = numbered && table_.at(row, 0) > table_.at(row - 1, 0);
    return numbered;
  }

  Error wrongCount(std::size_t line, std::size_t columns, std::size_t named) const {
    return badInput("line " + std::to_string(line) + " has " + std::to_string(columns) +
                    " columns where " + std::to_string(named) +
                    " are named; mend it, or name them all: -columns x,y,z,...");
  }

  /** The last line before the rows with this number of names. */
  bool fromHead(std::size_t columns, bool with_places, std::vector<std::string>& names) const {
    for (auto line = head_.rbegin(); line != head_.rend(); ++line) {
      names = namesIn(*line, form_.separator, columns);
      if (names.size() == columns && (!with_places || namePlaces(names))) return true;
    }
    return false;
  }

  bool fromComments(std::size_t columns, std::vector<std::string>& names) const {
    for (auto line = comments_.rbegin(); line != comments_.rend(); ++line) {
      names = namesIn(*line, form_.separator, columns);
      if (names.size() == columns && namePlaces(names)) return true;
    }
    return false;
  }

  /** COLMAP's points have a list of any length behind their columns: "ERROR, TRACK[] as (...)". */
  bool findListNames(std::vector<std::string>& names) {
    for (const Line& line : comments_) {
      std::vector<TextWord> words;
      splitLine(line.first, line.second, ',', words);
      std::vector<std::string> all;
      for (const TextWord& word : words) all.push_back(pcl_slim::textOf(word));
      const auto list = std::find_if(all.begin(), all.end(), [](const std::string& name) {
        return name.find("[]") != std::string::npos;
      });
      const auto before = static_cast<std::size_t>(list - all.begin());
      if (list == all.end() || before > words_.size()) continue;
      names.assign(all.begin(), list);
      if (!namePlaces(names)) continue;
      table_.left_out.push_back("'" + list->substr(0, list->find("[]")) + "', a list,");
      table_.named_by = ColumnNames::kFile;
      words_.resize(before);
      return open_ = true;
    }
    return false;
  }

  Error takeRow() {
    if (words_.size() != table_.columns.size()) {
      return badInput("line " + std::to_string(line_) + " has " + std::to_string(words_.size()) +
                      " columns, line " + std::to_string(first_row_) + " has " +
                      std::to_string(table_.columns.size()) + "; mend it");
    }
    for (std::size_t k = 0; k < words_.size(); ++k) {
      TextColumn& column = table_.columns[k];
      double value = std::numeric_limits<double>::quiet_NaN();
      if (column.numeric && !words_[k].empty()) {
        if (Error error = takeNumber(words_[k], column, value)) return error;
      }
      table_.values.push_back(value);
    }
    return {};
  }

  Error takeNumber(const TextWord& word, TextColumn& column, double& value) {
    if (!parseDecimal(word.begin, word.end, value, column.in_float)) {
      if (!parseField(word, true, value, column.in_float)) {
        // A column whose fields were empty so far turns out to be text.
        if (column.name.empty() || std::isfinite(column.least) || startsNumber(word))
          return noNumber(word);
        column.numeric = false;
        return {};
      }
      if (comma_line_ == 0 && std::find(word.begin, word.end, ',') != word.end) comma_line_ = line_;
    }
    if (point_line_ == 0 && std::find(word.begin, word.end, '.') != word.end) point_line_ = line_;
    if (comma_line_ != 0 && point_line_ != 0) {
      return badInput("line " + std::to_string(comma_line_) + " has decimals with a comma, line " +
                      std::to_string(point_line_) + " with a point; use points in all");
    }
    note(value, column);
    return {};
  }

  Error noNumber(const TextWord& word) const {
    return badInput("line " + std::to_string(line_) + ": '" + pcl_slim::textOf(word) +
                    "' is no number; mend it, or leave its column out: -columns x,y,z,-");
  }

  static void note(double value, TextColumn& column) {
    if (!std::isfinite(value)) return;
    column.whole = column.whole && value == std::floor(value);
    column.least = std::min(column.least, value);
    column.most = std::max(column.most, value);
  }

  const char* at_;
  const char* end_;
  char line_end_;
  const std::vector<std::string>& given_;
  TextForm form_;
  bool unsure_ = false;  ///< whether the first column, of numbers without a name, counts the rows
  bool open_ = false;    ///< what follows the named columns is a list that is left out
  std::size_t line_ = 0, first_row_ = 0, comma_line_ = 0, point_line_ = 0;
  std::optional<std::size_t> expected_;  ///< rows, after the last line with their number
  std::vector<Line> head_, comments_;    ///< lines before the rows
  std::vector<TextWord> words_;
  TextTable table_;
};

}  // namespace

Result<TextTable> parseTextTable(const std::vector<unsigned char>& bytes,
                                 const std::vector<std::string>& names) {
  PlainText text;
  if (Error error = decodeText(bytes, text)) return error;
  return TableReader(text, names).read();
}

}  // namespace pcl_slim
