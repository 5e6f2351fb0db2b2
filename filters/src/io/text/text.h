// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** Reads a number written in decimals, "nan" or "inf". \param[in,out] in_float cleared where a
 * float cannot represent every digit written. false: it is no number. */
bool parseDecimal(const char* begin, const char* end, double& value, bool& in_float);

/** Text in UTF-8 without a byte order mark; it refers to the bytes it was made of, or owns its own. */
struct PlainText {
  const char *begin = nullptr, *end = nullptr;
  std::vector<unsigned char> made;  ///< of UTF-16 and UTF-32
};

/** Decodes UTF-8, UTF-16 and UTF-32 by their byte order mark, UTF-16 also without one. \return an
 * error that names the line for a byte of 0 in other text. */
Error decodeText(const std::vector<unsigned char>& bytes, PlainText& text);

/** How the fields of a line are separated. */
struct TextForm {
  char separator = ' ';  ///< ' ': white space
  bool given = false;    ///< by a line "sep=;": the numbers do not decide
};

/** A field of a line, without quotes and blanks around it. */
struct TextWord {
  const char *begin = nullptr, *end = nullptr;
  bool quoted = false;

  bool empty() const { return begin == end; }
  std::size_t size() const { return static_cast<std::size_t>(end - begin); }
};

/** The separator that a line of numbers uses: | ; a tab, a comma or blanks. Commas between digits are
 * decimal where blanks separate three numbers or more. */
TextForm formOf(const char* begin, const char* end);

/** The fields of a line. Separators in quotes are part of a field. */
void splitLine(const char* begin, const char* end, char separator, std::vector<TextWord>& words);

/** The characters of a field, 80 at most; "" in quotes is one quote. */
std::string textOf(const TextWord& word);

/** Reads a field: a number with a decimal point or comma, with e or D before its exponent; NaN where it
 * is empty or a word for a missing value (NA, N/A, null, none). \param[in] commas whether commas may be
 * decimal. false: it is none of these. */
bool parseField(const TextWord& word, bool commas, double& value, bool& in_float);

/** Whether a field is a number as parseField() reads it, and not empty. */
bool isNumber(const TextWord& word, bool commas);

/** What is known of a column of numbers. */
struct TextColumn {
  std::string name;      ///< as the header writes it; empty without one
  bool numeric = true;   ///< else its values are text and not kept
  bool in_float = true;  ///< floats represent every digit
  bool whole = true;     ///< every finite value is a whole number
  double least = std::numeric_limits<double>::infinity();  ///< of the finite values
  double most = -std::numeric_limits<double>::infinity();
};

/** Who named the columns of a table. */
enum class ColumnNames { kNobody, kFile, kCaller };

/** The rows of a text file. */
struct TextTable {
  std::vector<TextColumn> columns;
  std::vector<double> values;  ///< row by row; NaN where a field is empty or text
  std::vector<std::string> comments, left_out;
  ColumnNames named_by = ColumnNames::kNobody;
  bool row_names =
      false;  ///< the first column has no name in a header: it numbers or names the rows

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  double at(std::size_t row, std::size_t column) const {
    return values[row * columns.size() + column];
  }
};

/** Reads a table. Lines that start with #, // or % are comments; lines before the rows that do not
 * begin with a number, or comments of as many words as there are columns, may name the columns; a line
 * of one whole number counts the rows that follow, as .pts files do; "sep=;" as the first line sets the
 * separator. \param[in] names of the columns, which then replace those of the file; none: the file's.
 * \return an error that names the line. */
Result<TextTable> parseTextTable(const std::vector<unsigned char>& bytes,
                                 const std::vector<std::string>& names = {});

/** A column's name in lower case, without a unit in brackets, with _ for what separates words. */
std::string plainColumnName(const std::string& written);

/** Names of fields for a table's columns, empty for those that are left out. */
struct FieldNames {
  std::vector<std::string> names;
  bool degrees = false;       ///< x and y are named longitude and latitude
  bool numbers_rows = false;  ///< the first column counts the points; nobody named it
};

/** Names x y z, normal_x normal_y normal_z, red green blue alpha, intensity where columns are such, others
 * as the file names them or column_4 and so on.
 *
 * With names: those of common programs are known, in any case and with units in brackets. Without: a first
 * column that counts the points is left out; x y z come next; behind them three columns of unit length
 * are normals, three of whole numbers from 0 to 255 or of fractions from 0 to 1 are colours, and one more is
 * the intensity. Of four columns that may be an intensity and colours the first is the intensity, unless it
 * varies with the two between clearly more than the last. \param[in] intensity_first it is in any case, as
 * in .pts files. \return an error for a table without x y z. */
Result<FieldNames> fieldNames(const TextTable& table, bool intensity_first);

/** Whether names, as a user gives them, have x, y and z among them. */
bool namePlaces(const std::vector<std::string>& written);

}  // namespace pcl_slim
