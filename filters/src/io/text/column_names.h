// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/text/text_table.h"

namespace pcl_slim {

/** A column's name in lower case, without a unit in brackets, with _ for what separates words. */
std::string
plainColumnName(const std::string& written);

/** Names of fields for a table's columns: x y z, normal_x normal_y normal_z, red green blue alpha,
 * intensity where they are such, others as the file names them or column_4 and so on.
 *
 * With names in the file: those of common programs are known, in any case and with units in brackets.
 * Without: x y z come first; behind them three columns of unit length are normals, three of whole numbers
 * from 0 to 255 are colours, and one more is the intensity. \param[in] intensity_first of four columns
 * that may be colours and an intensity, as in .pts files. \return an error for a table without x y z. */
Result<std::vector<std::string>>
columnNames(const TextTable& table, bool intensity_first);

}  // namespace pcl_slim
