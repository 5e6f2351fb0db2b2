// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/scalar_type.h"

namespace pcl_slim {

/** Parses text into one value of a type. false: not a number, or out of the type's range. */
bool
parseScalar(const char* begin, const char* end, std::uint8_t type, std::uint8_t* at);

/** Text that gives every double back: 17 digits, whatever the locale. */
std::string
formatScalar(double value);

/** Appends a field behind those a cloud has; its points grow by the field's bytes. */
void
addField(pcl::PCLPointCloud2& cloud, const std::string& name, std::uint8_t type,
         std::size_t count = 1);

/** Turns the bytes of one value round. */
void
swapBytes(std::uint8_t* at, std::size_t size);

/** Reads text in memory word by word. */
class TextScanner {
 public:
  TextScanner(const unsigned char* bytes, std::size_t size)
      : begin_(reinterpret_cast<const char*>(bytes)), at_(begin_), end_(begin_ + size)
  {
  }

  /** Next line without its end ("\n" or "\r\n"). false: no more lines. */
  bool nextLine(std::string& line);
  /** Next word, separated by white space and line ends. false: no more words. */
  bool nextWord(const char*& begin, const char*& end);

  std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }

 private:
  const char* begin_;
  const char* at_;
  const char* end_;
};

/** Words of a line. */
std::vector<std::string>
splitWords(const std::string& line);

}  // namespace pcl_slim
