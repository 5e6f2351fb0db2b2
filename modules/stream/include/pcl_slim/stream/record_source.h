// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/scalar_type.h"
#include "pcl_slim/stream/point_source.h"

namespace pcl_slim {

/** \brief Where a file has its points: records of one size, or words of text. */
struct RecordLayout {
  /** \brief One number of a point in its record. */
  struct Field {
    std::size_t offset = 0;  ///< bytes into the record; of text: words into the row
    ScalarType type = kFloat32;
  };

  std::string path;
  std::uint64_t begin = 0;  ///< bytes in front of the first record
  std::uint64_t count = 0;  ///< records
  std::size_t step = 0;     ///< bytes of a record; of text: words of a row
  bool text = false;        ///< numbers as words, separated by white space
  bool big_endian = false;
  bool colors = false;  ///< records have colours, which no pass reads
  std::array<Field, 3> position;
  std::optional<std::array<Field, 3>> normal;
  std::optional<std::array<double, 3>> sensor;
  bool has_sensors = false;  ///< records also contain sensor positions: not read
};

/** \brief The points of a file with records of one size, or of text, read in pieces of some
 * megabytes. */
class PCL_SLIM_EXPORT RecordSource : public PointSource {
 public:
  /** \param[in] share,shares the share-th of this number of equal parts of the records, from 0 on
   */
  explicit RecordSource(RecordLayout layout, std::uint64_t share = 0, std::uint64_t shares = 1);

  const RecordLayout& layout() const { return layout_; }
  std::uint64_t size() const override { return end_ - first_; }
  bool hasNormals() const override { return layout_.normal.has_value(); }
  CloudView::Scalar scalar() const override;
  std::optional<std::array<double, 3>> sensor() const override { return layout_.sensor; }
  /** \brief Also an error where the file has changed since this was made. */
  Error pass(const Visit& visit) override;

 private:
  Error passOver(const Visit& visit) const;

  RecordLayout layout_;
  std::array<std::uint64_t, 4> state_;  ///< of the file
  std::uint64_t first_, end_;           ///< records
};

}  // namespace pcl_slim
