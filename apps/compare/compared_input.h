// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "common/program.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/compare/carrier_mesh.h"
#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/surface/surface.h"
#include "scan/cloud_file.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief One of the two objects that are compared: a cloud with the surface fitted to it, a surface
 * that was read, or the exact triangles of a mesh. */
struct ComparedInput {
  enum class Kind : unsigned char { kCloud, kSurface, kMesh };

  std::string path;
  Kind kind = Kind::kCloud;
  std::optional<CloudFile> file;  ///< a cloud's points or a mesh's vertices; none of a surface
  PointStore store;               ///< of a cloud
  SLIMSurface surface;            ///< of a cloud or a surface
  TriangleMesh mesh;              ///< of a mesh

  bool use_normals = true;  ///< of the file

  bool isMesh() const { return kind == Kind::kMesh; }
  /** \brief The file's name without its folder. */
  std::string name() const;
  /** \brief The file's points; there must be one. */
  CloudView view() const { return file->view(use_normals); }
  /** \brief Number of places with independent errors; 0: it has none. */
  double independent(ScanPlaces which) const;
  /** \brief What others are compared with; this object must outlive it. */
  Result<DeviationReference> reference(int threads) const;
  /** \brief Places all over it. */
  Result<CarrierMesh> carrier(const CarrierParams& params, Progress& progress) const;
};

/** \brief Loads one of the two; prints and reports it. \param[in] as_mesh the faces of a file that has
 * any are the object; false: a surface is fitted to its vertices. */
Error loadCompared(const std::string& path, bool as_mesh, const FitJob& job, Console& console,
                   Report& report, ComparedInput& input);

/** \brief Fits a surface to a cloud; prints and reports it. Nothing of the others. */
Error fitCompared(const FitJob& job, Console& console, Report& report, ComparedInput& input);

}  // namespace pcl_slim
