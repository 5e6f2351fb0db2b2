// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/program.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/filters/io/point_file_pieces.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "scan/scan_program.h"
#include "scan/tile_fit.h"

namespace pcl_slim {

/** \brief What the programs do alike that bring a scan onto its surface and write it again. */
struct ProjectionJob {
  ScanFiles files;
  std::string surface;  ///< a file to read instead of fitting, or none
  FitJob fit;
  ProjectionParams projection;
  bool mesh = false;  ///< smooth the scan's mesh in place of its points
};

/** \brief What a program of this kind is called, and the one switch of its own. */
struct ProjectionProgram {
  std::string name, version, summary;
  std::string switch_name, switch_help;  ///< the switch adds curvatures to the output
  bool meshes = false;                   ///< whether it has the option -mesh
  bool keeps_scan = false;  ///< a scan that is no surface is written unchanged, with a warning
};

/** \brief Makes the file to write from the file read and its projection. \param[in] chosen whether
 * the program's own switch is on; \param[in] threads 0: all cores. */
using MakeOutput = std::function<PointFile(const PointFile& file, const CloudProjection& projection,
                                           bool chosen, int threads)>;

/** \brief What became of the points, into the report. */
void reportProjection(const CloudProjectionStatistics& statistics, Report& report);

/** \brief Reads the arguments, loads, fits or loads the surface, projects, writes and reports.
 * \return the exit status; messages are printed. */
int runProjectionProgram(const ProjectionProgram& program, ProjectionJob& job, int argc,
                         const char* const* argv, const MakeOutput& make_output);

/** \brief A surface in blocks, of which only those about some points are read: it need not fit into
 * memory. */
class BlockSurface {
 public:
  using Blocks = std::vector<bool>;
  /** \brief Some of a cloud's points, and the blocks whose balls may contain them. */
  struct Part {
    std::vector<std::int32_t> rows;  ///< ascending; empty: all points
    Blocks blocks;
  };

  /** \brief Opens a file. \return whether it is one of blocks; other files are loaded whole. */
  bool open(const std::string& path);
  bool isOpen() const { return !boxes_.empty(); }
  std::size_t count() const { return boxes_.size(); }
  /** \brief A part without points and blocks. */
  Part none() const { return {{}, Blocks(boxes_.size())}; }
  /** \brief Most bytes that blocks in memory may take. */
  void setMostBytes(double bytes) { most_bytes_ = bytes; }

  /** \brief All points, and the blocks whose balls may contain some. O(points * blocks). */
  Part partOf(const CloudView& cloud) const;

  /** \brief Divides points along the Morton curve, so that the blocks of each part fit into memory:
   * into one part where possible. O(points * blocks), points log points where they are divided. */
  std::vector<Part> partsOf(const CloudView& cloud) const;

  /** \brief The surfels of a part's blocks. \return an error where memory is too small for them. */
  Result<SLIMSurface> load(const Part& part);

  /** \brief Prints and reports how many of the blocks were read. */
  void reportBlocks(Console& console, Report& report) const;

 private:
  template <typename Rows>
  void addBlocks(const CloudView& cloud, const Rows& rows, Blocks& blocks) const;
  double bytesOf(const Blocks& blocks) const;

  std::string path_;
  SlimBlockReader reader_;
  std::vector<WorldBox> boxes_;
  double most_bytes_ = 0;
};

/** \brief A scan that is fitted by tiles and brought onto its surface some rows at a time. */
class PieceJob {
 public:
  PieceJob(const ProjectionJob& job, const MakeOutput& make_output, const bool& chosen)
      : job_(job), make_output_(make_output), chosen_(chosen) {}

  TileRequest& tiles() { return tiles_; }
  BlockSurface& blocks() { return blocks_; }

  /** \brief Opens the scan. \return whether it is worked on in pieces; an error where the user
   * requests pieces, or memory is too small for anything else, and the scan or the job does not
   * allow them. */
  Result<bool> open(Console& console);

  /** \brief Fits, unless a surface was read, projects and writes; ScanResult::save puts the file in
   * its place. */
  Error run(SLIMSurface& surface, Console& console, Report& report, ScanResult& result);

 private:
  std::size_t rows() const;
  Result<bool> openRows(Console& console);
  Error projectRows(const SLIMSurface& surface, Console& console, Report& report);
  Result<PointFile> brought(PointFile piece, const SLIMSurface& surface);
  Result<PointFile> brought(const CloudFile& cloud, const SLIMSurface& surface);
  Result<CloudProjection> project(const CloudFile& cloud, const SLIMSurface& surface) const;
  void count(const CloudProjectionStatistics& piece);

  const ProjectionJob& job_;
  const MakeOutput& make_output_;
  const bool& chosen_;
  TileRequest tiles_;
  std::unique_ptr<PointSource> source_;  ///< null: a surface was read
  BlockSurface blocks_;                  ///< a surface that was read, if it is in blocks
  PointFileReader reader_;
  PointFileWriter writer_;
  CloudProjectionStatistics sum_;  ///< rms_displacement: a sum of squares
};

}  // namespace pcl_slim
