// SPDX-License-Identifier: BSD-3-Clause
// From lines to fields.
#include <algorithm>
#include <cstring>

#include "io/text/text.h"

namespace pcl_slim {

namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/** A field without blanks and one pair of quotes around it. */
TextWord trimmed(const char* begin, const char* end) {
  while (begin != end && isBlank(*begin)) ++begin;
  while (begin != end && isBlank(end[-1])) --end;
  if (end - begin < 2 || *begin != '"' || end[-1] != '"') return {begin, end, false};
  ++begin;
  --end;
  while (begin != end && isBlank(*begin)) ++begin;
  while (begin != end && isBlank(end[-1])) --end;
  return {begin, end, true};
}

/** The end of a field: a separator outside quotes. A quote that is not closed is a character. */
const char* endOfField(const char* at, const char* end, char separator) {
  const auto ends = [separator](char c) { return separator == ' ' ? isBlank(c) : c == separator; };
  const char* first = at;
  while (first != end && isBlank(*first) && !ends(*first)) ++first;
  if (first != end && *first == '"') {
    const char* close = first;
    do {
      close = std::find(close + 1, end, '"');
      if (close != end && close + 1 != end && close[1] == '"')
        ++close;  // "" is no end
      else if (close != end && (close + 1 == end || ends(close[1]) || isBlank(close[1])))
        break;
    } while (close != end);
    if (close != end) at = close + 1;
  }
  return std::find_if(at, end, ends);
}

/** Digits with at most one comma between them, a sign and an exponent. */
bool mayHaveDecimalComma(const TextWord& word) {
  double value = 0;
  bool in_float = false;
  const auto commas = std::count(word.begin, word.end, ',');
  const bool inside = commas == 1 && *word.begin != ',' && word.end[-1] != ',' &&
                      std::find(word.begin, word.end, '.') == word.end;
  return (commas == 0 || inside) && !word.empty() && parseField(word, true, value, in_float);
}

bool hasOutsideQuotes(const char* begin, const char* end, char wanted) {
  bool quoted = false;
  for (const char* at = begin; at != end; ++at) {
    if (*at == '"') quoted = !quoted;
    if (!quoted && *at == wanted) return true;
  }
  return false;
}

}  // namespace

TextForm formOf(const char* begin, const char* end) {
  for (const char separator : {'|', ';'}) {
    if (hasOutsideQuotes(begin, end, separator)) return {separator};
  }
  std::vector<TextWord> words;
  const auto isOne = [](const TextWord& word) {
    return word.quoted || std::none_of(word.begin, word.end, isBlank);
  };
  if (hasOutsideQuotes(begin, end, '\t')) {
    splitLine(begin, end, '\t', words);
    const bool alone = std::all_of(words.begin(), words.end(), [&](const TextWord& word) {
      return isOne(word) && (word.empty() || word.end[-1] != ',');
    });
    if (alone) return {'\t'};
  }
  if (!hasOutsideQuotes(begin, end, ',')) return {' '};
  splitLine(begin, end, ' ', words);
  const bool decimal =
      words.size() > 2 && std::all_of(words.begin(), words.end(), mayHaveDecimalComma);
  return {decimal ? ' ' : ','};
}

void splitLine(const char* begin, const char* end, char separator, std::vector<TextWord>& words) {
  words.clear();
  const char* at = begin;
  while (at != end) {
    const char* stop = endOfField(at, end, separator);
    if (separator != ' ' || stop != at) words.push_back(trimmed(at, stop));
    at = stop == end ? stop : stop + 1;
  }
}

std::string textOf(const TextWord& word) {
  constexpr std::size_t kMost = 80;
  std::string text(word.begin, word.begin + std::min(kMost, word.size()));
  for (std::size_t at = 0; word.quoted && (at = text.find("\"\"", at)) != std::string::npos; ++at)
    text.erase(at, 1);
  return text;
}

}  // namespace pcl_slim
