// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief One block of a .slim file of format version 3: the surfels of one tile. */
struct SlimBlock {
  std::uint64_t offset = 0, bytes = 0;  ///< in the file: a complete .slim of version 1, 2, 4 or 5
  std::uint64_t surfels = 0;
  std::uint64_t first_key = 0, end_key = 0;  ///< Morton codes of the tile, half open
  std::array<float, 3> low{}, high{};        ///< box of the surfels' balls, local units
};

/** \brief What a file of blocks has. */
struct SlimDirectory {
  SurfaceInfo info;
  std::uint64_t surfels = 0;
  std::vector<SlimBlock> blocks;
};

/** \brief Writes a surface that need not fit into memory, block by block.
 *
 * The file appears under its name only when complete. Blocks have checksums of their own; the directory
 * of all blocks is at the end, and the header's checksum is over header and directory.
 */
class PCL_SLIM_EXPORT SlimBlockWriter {
 public:
  /** \param[in] rounding as that of saveSlim, for each tile */
  Error open(const std::string& path, double rounding = 0.0);
  /** \brief Appends the surfels of a tile; all tiles have the same units and degree. Tiles without
   * surfels leave no block. \return an error where the surface is not valid or cannot be written. */
  Error add(const SLIMSurface& tile, std::uint64_t first_key, std::uint64_t end_key);
  /** \brief Writes header and directory. \return an error where there is no surfel. */
  Error finish();

  std::uint64_t surfels() const { return directory_.surfels; }

 private:
  FileWriter file_;
  SlimDirectory directory_;
  double rounding_ = 0.0;
};

/** \brief Reads the directory of a file of format version 3; nothing of its blocks. */
PCL_SLIM_EXPORT Result<SlimDirectory>
loadSlimDirectory(const std::string& path);

/** \brief Reads those blocks that wanted(block) names, as one surface with links. A file of another version
 * is one block of all its surfels. */
PCL_SLIM_EXPORT Result<SLIMSurface>
loadSlimBlocks(const std::string& path, const std::function<bool(const SlimBlock&)>& wanted);

/** \brief Reads the blocks whose balls may reach into a box; world coordinates. */
PCL_SLIM_EXPORT Result<SLIMSurface>
loadSlimBox(const std::string& path, const std::array<double, 3>& low,
            const std::array<double, 3>& high);

}  // namespace pcl_slim
