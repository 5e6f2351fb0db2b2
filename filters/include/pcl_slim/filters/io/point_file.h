// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim {

/** \brief A point file as it is on disk: every field in its own type, nothing narrowed.
 *
 * PCL's own readers narrow nothing either for PCD, but refuse double properties of PLY files and
 * print instead of reporting; these read all formats alike and return one sentence when a file
 * cannot be used. Names become PCL's (nx: normal_x; red green blue of 8 bits: rgb).
 */
struct PCL_SLIM_EXPORT PointFile {
  PointTable cloud;
  std::array<float, 3> sensor_origin{};
  std::array<float, 4> sensor_orientation{1, 0, 0, 0};  ///< quaternion w x y z
  std::vector<std::string> comments;      ///< text of the header's comment lines, in order
  std::vector<std::string> left_out;      ///< other content of the file, in words: "element 'edge'"
  std::vector<std::uint32_t> face_begin;  ///< faces: number of faces + 1 offsets, or empty
  std::vector<std::uint32_t>
      face_vertices;     ///< vertices of face i: [face_begin[i], face_begin[i+1])
  std::string columns;   ///< of a text file: what its columns are, and how that is known
  bool degrees = false;  ///< the file says that x and y are degrees of longitude and latitude
  std::vector<std::string> notes;     ///< what was made of the content, a line each
  std::vector<std::string> warnings;  ///< the same where it may be wrong
  std::vector<unsigned char>
      las_head;  ///< of a LAS file: header and records before its points, kept for writing
  std::vector<unsigned char> las_tail;  ///< what follows them

  std::size_t numFaces() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }

  /** \brief Whether origin or orientation differ by more than 1e-5 from 0 and no turn, which files
   * have whose sensor is not known. */
  bool hasSensorPose() const;

  /** \brief Names what contradicts itself: in the cloud (checkPointTable), in a comment, or in the
   * faces. What loadPointFile() returns is consistent. O(faces). */
  Error validate() const;
};

/** \brief What a reader cannot know of a file. */
struct PCL_SLIM_EXPORT PointFileOptions {
  /** \brief Names of a text file's columns, separated by commas, in place of those that it has or that
   * are guessed: "x,y,z,i,r,g,b,-"; - leaves a column out. */
  std::string columns;
  /** \brief Of a PLY file of 3D Gaussian splatting: splats of a lower opacity are left out, 0 to 1. */
  double min_opacity = 0.1;
};

/** \brief Reads a point file by its extension, upper or lower case.
 *
 * - .pcd: ascii, binary, binary_compressed
 * - .ply: ascii, binary of either order; vertices and faces
 * - .las: versions 1.0 to 1.4, point formats 0 to 10; x y z are doubles, other values fields of their
 *   names (intensity, return_number, classification, gps_time, red, ...), extra bytes fields as their
 *   record describes them
 * - .laz: the same compressed, also COPC, in builds with LASzip
 * - .xyz .txt .asc .csv .neu: text, a point a line; columns by their names, or guessed (columns)
 * - .xyzrgb .xyzn: the same; colours or normals behind x y z
 * - .pts: the same, with the number of points first and intensity before colours
 * - .ptx: scans of Leica's format, with the places of their scanners
 * - .obj .off .stl: vertices, with normals and colours where there are any, and faces
 * - .vtp: VTK's XML PolyData of one piece, in builds with PCL_SLIM_WITH_VTP: points, their arrays (3
 *   bytes "RGB": rgb; the normals: normal_x ...) and polygons
 *
 * A missing, foreign, truncated or self-contradicting file gives an error; one without points is
 * read and has none. Ignored parts of a file (elements of a PLY file other than vertices and faces,
 * texture coordinates, colours of faces, columns of text) are named in left_out. For .e57, and for
 * .laz without LASzip, the error names a command that converts it.
 *
 * The file is opened once, so that it may be a pipe. The content of a stream without an extension
 * (isStream(): /dev/stdin) shows its format; text is then .xyz.
 */
PCL_SLIM_EXPORT Result<PointFile> loadPointFile(const std::string& path,
                                                const PointFileOptions& options = {});

/** \brief The same of bytes that are read already. \param[in] path gives the extension, and a name
 * to errors */
PCL_SLIM_EXPORT Result<PointFile> parsePointFile(const std::string& path,
                                                 const std::vector<unsigned char>& bytes,
                                                 const PointFileOptions& options = {});

/** \brief No error for names of columns that PointFileOptions can have. */
PCL_SLIM_EXPORT Error checkColumns(const std::string& columns);

/** \brief No error for an extension that loadPointFile() knows, and for a stream without one. */
PCL_SLIM_EXPORT Error checkPointFileExtension(const std::string& path);

/** \brief Writes .pcd (binary), .ply (binary_little_endian), .las or .vtp by extension.
 *
 * Fields go out in their order and type, so that loading and saving gives the same bytes again. PCD
 * and LAS keep no faces, LAS no comments; only PCD keeps the rows of an organised cloud and the
 * sensor. Points of a .vtp are vertex cells or corners of polygons; those without coordinates (NaN)
 * are in no cell. A .las of points read from one keeps its version, point format, records and extra
 * bytes; new fields become extra bytes. Coordinates that its scale cannot represent get a finer
 * one. Of other points LAS 1.4 is made, format 6 or, with colours, 7: coordinates are rounded to a
 * billionth of the extent. \return an error for another extension, for points that contradict themselves
 * (PointFile::validate) or when the file cannot be written. */
PCL_SLIM_EXPORT Error savePointFile(const std::string& path, const PointFile& file);

}  // namespace pcl_slim
