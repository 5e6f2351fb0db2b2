// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcl_slim {

/** Field types by PCLPointField's numbers; the 64-bit integers have no name there before 1.13. */
enum ScalarType : std::uint8_t {
  kInt8 = 1,
  kUInt8 = 2,
  kInt16 = 3,
  kUInt16 = 4,
  kInt32 = 5,
  kUInt32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
  kInt64 = 9,
  kUInt64 = 10,
  kBool = 11
};

/** Bytes of one value, 0 for an unknown type. */
std::size_t
scalarSize(std::uint8_t type);

/** Value at an address of any alignment, in this machine's byte order. */
double
readScalar(const std::uint8_t* at, std::uint8_t type);

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

/** Walks over text held in memory. */
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
