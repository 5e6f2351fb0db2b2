// SPDX-License-Identifier: BSD-3-Clause
// Surfaces in pieces for ParaView, read by VTK's own reader and by ours.
#ifdef PCL_SLIM_WITH_VTP
#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPPolyDataReader.h>

#include <filesystem>

#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/sphere_surface.h"
#include "support/temporary_folder.h"
#include "support/trim_maps.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** A surface in three blocks, of which only the last has trim maps. */
SLIMSurface writeBlocks(const std::string& path) {
  SLIMSurface open = sphereSurface(3, 100), all = sphereSurface(3, 300);
  setRandomTrimMaps(open);
  all = all.slice(0, 200);
  SlimBlockWriter writer;
  EXPECT_FALSE(writer.open(path));
  EXPECT_FALSE(writer.add(all.slice(0, 120), 1, 2));
  EXPECT_FALSE(writer.add(all.slice(120, 200), 2, 3));
  EXPECT_FALSE(writer.add(open, 3, 4));
  EXPECT_FALSE(writer.finish());
  all.append(open);
  return all;
}

void writePieces(const TemporaryFolder& folder, const std::string& name) {
  SlimBlockReader reader;
  ASSERT_FALSE(reader.open(folder / "blocks.slim"));
  const Error error = saveSurfacePieces(folder / name, reader);
  ASSERT_FALSE(error) << error.message;
}

TEST(SurfacePieces, AreReadByVtk) {
  const TemporaryFolder folder;
  const SLIMSurface surface = writeBlocks(folder / "blocks.slim");
  writePieces(folder, "a&b.pvtp");
  vtkNew<vtkXMLPPolyDataReader> reader;
  reader->SetFileName((folder / "a&b.pvtp").c_str());
  reader->Update();
  vtkPolyData* const data = reader->GetOutput();
  ASSERT_EQ(data->GetNumberOfPoints(), static_cast<vtkIdType>(surface.size()));
  EXPECT_EQ(data->GetNumberOfVerts(), data->GetNumberOfPoints());
  vtkDataArray* const radius = data->GetPointData()->GetArray("radius");
  vtkDataArray* const normals = data->GetPointData()->GetNormals();
  ASSERT_TRUE(radius != nullptr && normals != nullptr);
  EXPECT_EQ(data->GetPointData()->GetArray("trim_low"), nullptr) << "not all pieces have it";
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    double p[3];
    data->GetPoint(i, p);
    EXPECT_FLOAT_EQ(
        static_cast<float>(p[0]),
        static_cast<float>(surface.info.origin[0] + surface.info.scale * double{surface.cx[k]}));
    EXPECT_FLOAT_EQ(static_cast<float>(normals->GetComponent(i, 2)), surface.nz[k]);
    EXPECT_FLOAT_EQ(static_cast<float>(radius->GetTuple1(i)),
                    static_cast<float>(surface.info.scale) * surface.radius[k]);
  }
}

TEST(SurfacePieces, GiveTheWholeSurfaceBack) {
  const TemporaryFolder folder;
  const SLIMSurface surface = writeBlocks(folder / "blocks.slim");
  writePieces(folder, "a&b.pvtp");
  const auto loaded = loadSurface(folder / "a&b.pvtp");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(encodeSlim(*loaded), encodeSlim(surface));
  EXPECT_EQ(loaded->child_begin.size(), surface.size() + 1);
  // A surface that is not in blocks is one piece.
  ASSERT_FALSE(saveSurface(folder / "one.pvtp", surface));
  const auto one = loadSurface(folder / "one.pvtp");
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(encodeSlim(*one), encodeSlim(surface));
  EXPECT_FALSE(std::filesystem::exists(folder / "one/one_1.vtp"));
}

TEST(SurfacePieces, AMissingOrForeignPieceIsAnError) {
  const TemporaryFolder folder;
  writeBlocks(folder / "blocks.slim");
  writePieces(folder, "a.pvtp");
  SLIMSurface other = sphereSurface(3, 50);
  other.info.scale *= 2;
  ASSERT_FALSE(saveSurface(folder / "a/a_1.vtp", other));
  const auto foreign = loadSurface(folder / "a.pvtp");
  ASSERT_FALSE(foreign);
  EXPECT_NE(foreign.error().message.find("another surface"), std::string::npos);
  std::filesystem::remove(folder / "a/a_1.vtp");
  EXPECT_EQ(loadSurface(folder / "a.pvtp").error().code, ErrorCode::kIo);
  writeBytes(folder / "a.pvtp", {'<', 'V', 'T', 'K'});
  EXPECT_EQ(loadSurface(folder / "a.pvtp").error().code, ErrorCode::kBadInput);
  writeBytes(folder / "b", {});
  EXPECT_EQ(saveSurface(folder / "b.pvtp", other).code, ErrorCode::kIo)
      << "a file in the folder's place";
}

}  // namespace
#endif
