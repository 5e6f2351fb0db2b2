// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

/** \brief One block of a .slim file of format version 3: the surfels of one tile. */
struct SlimBlock {
  std::uint64_t offset = 0, bytes = 0;  ///< in the file: a complete .slim of version 1, 2, 4 or 5
  std::uint64_t surfels = 0;
  std::uint64_t first_key = 0, end_key = 0;  ///< Morton codes of the tile, half open
  std::array<float, 3> low{}, high{};        ///< box of the surfels' balls, local units

  /** \brief Whether it has the surfels of levels above the tiles' first, none of them a leaf, in
   * place of those of a tile: its codes are 0. */
  bool isCoarse() const { return first_key == end_key; }
};

/** \brief A box in world coordinates: lowest and highest corner. */
using WorldBox = std::array<std::array<double, 3>, 2>;

/** \brief What a file of blocks has. */
struct PCL_SLIM_EXPORT SlimDirectory {
  SurfaceInfo info;
  std::uint64_t surfels = 0;
  std::vector<SlimBlock> blocks;

  /** \brief The box of a block's balls. */
  WorldBox boxOf(const SlimBlock& block) const;
  /** \brief The box of all blocks. */
  WorldBox box() const;
  /** \brief Bytes that a block's surfels take in memory, about. */
  std::uint64_t memoryOf(const SlimBlock& block) const;
};

/** \brief Writes a surface that need not fit into memory, block by block.
 *
 * The file appears under its name only when complete. Each block has a checksum; the directory
 * of all blocks is at the end, and the header's checksum is over header and directory.
 */
class PCL_SLIM_EXPORT SlimBlockWriter {
 public:
  /** \param[in] rounding as that of saveSlim, for each tile */
  Error open(const std::string& path, const SlimRounding& rounding = {});
  /** \brief Appends the surfels of a tile; all tiles have the same units and degree. Tiles without
   * surfels leave no block. \return an error where the surface is not valid or cannot be written.
   */
  Error add(const SLIMSurface& tile, std::uint64_t first_key, std::uint64_t end_key);
  /** \brief Writes header and directory. \return an error where there is no surfel. */
  Error finish();

  std::uint64_t surfels() const { return directory_.surfels; }

 private:
  FileWriter file_;
  SlimDirectory directory_;
  SlimRounding rounding_;
};

/** \brief Reads the directory of a file of format version 3; nothing of its blocks. */
PCL_SLIM_EXPORT Result<SlimDirectory> loadSlimDirectory(const std::string& path);

/** \brief Reads the blocks of a file of format version 3 as they are needed. */
class PCL_SLIM_EXPORT SlimBlockReader {
 public:
  /** \brief Reads the directory. \return an error for a file that is missing, damaged or has no
   * blocks. */
  Error open(const std::string& path);
  const SlimDirectory& directory() const { return directory_; }

  /** \brief The surfels of some blocks in the file's order, without links.
   *
   * Blocks stay in memory for later calls; those that this call does not need are dropped while all
   * kept ones take more than most_kept bytes. \param[in] wanted one value a block
   */
  Result<SLIMSurface> load(const std::vector<bool>& wanted, std::uint64_t most_kept = 0);

  /** \brief Different blocks that were read so far. */
  std::size_t blocksRead() const;

 private:
  Result<SLIMSurface> read(std::size_t block);
  void drop(const std::vector<bool>& wanted, std::uint64_t most_kept);

  std::string path_;
  std::ifstream file_;
  SlimDirectory directory_;
  std::map<std::size_t, SLIMSurface> kept_;
  std::vector<bool> read_;
};

/** \brief Reads those blocks that wanted(block) names, as one surface with links. A file of another
 * version is one block of all its surfels. */
PCL_SLIM_EXPORT Result<SLIMSurface> loadSlimBlocks(
    const std::string& path, const std::function<bool(const SlimBlock&)>& wanted);

/** \brief Reads the blocks whose balls may reach into a box. */
PCL_SLIM_EXPORT Result<SLIMSurface> loadSlimBox(const std::string& path, const WorldBox& box);

/** \brief Whether two boxes have a point in common. */
PCL_SLIM_EXPORT bool boxesMeet(const WorldBox& a, const WorldBox& b);

}  // namespace pcl_slim
