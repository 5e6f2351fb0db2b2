// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/scalar_type.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** Parses text into one value of a type. false: not a number, or out of the type's range. */
bool parseScalar(const char* begin, const char* end, std::uint8_t type, std::uint8_t* at);

/** Text that gives every double back: 17 digits, whatever the locale. */
std::string formatScalar(double value);

/** Turns the bytes of one value round. */
void swapBytes(std::uint8_t* at, std::size_t size);

/** The character that ends lines: '\r' where the first line has no '\n' behind it, as of old Macs. */
char lineEndOf(const char* begin, const char* end);

/** Reads text in memory word by word. */
class TextScanner {
 public:
  TextScanner(const unsigned char* bytes, std::size_t size)
      : begin_(reinterpret_cast<const char*>(bytes)),
        at_(begin_),
        end_(begin_ + size),
        line_end_(lineEndOf(begin_, end_)) {}

  /** Next line without its end ("\n", "\r\n" or "\r"). false: no more lines. */
  bool nextLine(std::string& line);
  /** Next word, separated by white space and line ends. false: no more words. */
  bool nextWord(const char*& begin, const char*& end);

  std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }

 private:
  const char* begin_;
  const char* at_;
  const char* end_;
  char line_end_;
};

/** A whole number, 0 or more. false: the word is none. */
bool parseCount(const std::string& word, std::size_t& count);

/** Whether a field packs a colour into four bytes. */
inline bool isPackedColor(const PointField& field) {
  return (field.name == "rgb" || field.name == "rgba") && scalarSize(field.datatype) == 4 &&
         field.count <= 1;
}

/** Names coordinates x y z that are named X Y Z. */
void adoptCapitals(PointTable& cloud);

/** Words of a line. */
std::vector<std::string> splitWords(const std::string& line);

/** The content of a PCD file, versions 0.5 to 0.7, in all three of its data forms. */
Result<PointFile> parsePcd(const std::vector<unsigned char>& bytes);

/** The bytes of a binary PCD 0.7 file. */
std::vector<unsigned char> formatPcd(const PointFile& file);

/** The vertices and faces of a PLY file of any of the three data forms. */
Result<PointFile> parsePly(const std::vector<unsigned char>& bytes);

/** Of a PLY file of 3D Gaussian splatting: leaves out splats of a lower opacity, and gives the others the
 * colour that they have from all sides, in a field rgb. Other files stay as they are. */
void adoptSplats(double min_opacity, PointFile& file);

/** Whether fields of these names are of such a file. */
bool hasSplatFields(const std::vector<std::string>& names);

/** The bytes of a binary_little_endian PLY file, or why the fields do not fit the format. */
Result<std::vector<unsigned char>> formatPly(const PointFile& file);

/** The points of a LAS file, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS, LAS 1.4 R15). */
Result<PointFile> parseLas(const std::vector<unsigned char>& bytes);

/** The bytes of a LAS file: those of the one read where a file comes from one, and else of version
 * 1.4, format 6, or 7 where there are colours. \return an error for coordinates that are not
 * finite. */
Result<std::vector<unsigned char>> formatLas(const PointFile& file);

/** What a text file's extension says of its columns. */
enum class TextKind { kAny, kPts, kXyzRgb, kXyzNormal };

/** The points of a text file, one a line; text/text.h describes the format.
 *
 * Coordinates and other numbers are floats where those represent every digit written, else doubles.
 * \param[in] columns their names, separated by commas; none: the file's, or guessed. */
Result<PointFile> parseText(const std::vector<unsigned char>& bytes, TextKind kind,
                            const std::string& columns);

/** The scans of a Leica PTX file, in the coordinates that they share. One scan keeps its rows, and has
 * its sensor; of several each point has its sensor in vp_x vp_y vp_z and its scan's number in frame.
 * Directions without a point are NaN. */
Result<PointFile> parsePtx(const std::vector<unsigned char>& bytes);

/** A Wavefront OBJ file: v with or without colours, vn, f. A vertex that faces give several normals
 * has their mean. Texture coordinates, lines, groups and materials are left out, and named. */
Result<PointFile> parseObj(const std::vector<unsigned char>& bytes);

/** An STL file, binary or ASCII. Corners of equal coordinates become one vertex. */
Result<PointFile> parseStl(const std::vector<unsigned char>& bytes);

/** An OFF, COFF, NOFF or CNOFF file in ASCII. Colours of faces are left out, and named. */
Result<PointFile> parseOff(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim
