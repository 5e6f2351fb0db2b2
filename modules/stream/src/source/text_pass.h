// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/stream/record_source.h"
#include "source/file_reader.h"

namespace pcl_slim::detail {

/** \brief A pass over points that are rows of words, [first, end). Coordinates that are float are rounded as such.
 * \return an error that names the row where the text ends or a word is no number. */
Error
passText(const RecordLayout& layout, std::uint64_t first, std::uint64_t end, const FileReader& file,
         const PointSource::Visit& visit);

}  // namespace pcl_slim::detail
