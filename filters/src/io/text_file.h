// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** Reads a number written in decimals, "nan" or "inf". \param[in,out] in_float cleared where a
 * float cannot represent every digit written. false: it is no number. */
bool parseDecimal(const char* begin, const char* end, double& value, bool& in_float);

/** What is known of a column of numbers. */
struct TextColumn {
  std::string name;      ///< as the header writes it; empty without one
  bool numeric = true;   ///< else its values are text and not kept
  bool in_float = true;  ///< floats represent every digit
  bool whole = true;     ///< every finite value is a whole number
  double least = std::numeric_limits<double>::infinity();  ///< of the finite values
  double most = -std::numeric_limits<double>::infinity();
};

/** The rows of a text file: numbers, separated by white space, commas or semicolons. */
struct TextTable {
  std::vector<TextColumn> columns;
  std::vector<double> values;  ///< row by row; NaN where a field is empty or text
  std::vector<std::string> comments;
  bool named = false;  ///< the file names its columns

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  double at(std::size_t row, std::size_t column) const {
    return values[row * columns.size() + column];
  }
};

/** Reads a table. Lines that start with #, // or % are comments; the first line that is none, or
 * the last comment before the rows, may name the columns; a line of one whole number counts the
 * rows that follow, as .pts files do. \return an error that names the line. */
Result<TextTable> parseTextTable(const std::vector<unsigned char>& bytes);

/** A column's name in lower case, without a unit in brackets, with _ for what separates words. */
std::string plainColumnName(const std::string& written);

}  // namespace pcl_slim
