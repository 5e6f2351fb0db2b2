// SPDX-License-Identifier: BSD-3-Clause
// Reading .vtp: every form that VTK writes, and files that were damaged on their way.
#ifdef PCL_SLIM_WITH_VTP
#include <gtest/gtest.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include <random>
#include <string>

#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/sphere_surface.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::fileBytes;
using pcl_slim_test::sphereSurface;
using pcl_slim_test::TemporaryFolder;
using pcl_slim_test::writeBytes;
using pcl_slim_test::writeText;

TEST(VtpRead, EveryFormThatVtkWrites) {
  const TemporaryFolder folder;
  const SLIMSurface surface = sphereSurface(3, 500);
  ASSERT_FALSE(saveSurface(folder / "a.vtp", surface));
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "a.vtp").c_str());
  reader->Update();
  for (int form = 0; form < 20; ++form) {
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(reader->GetOutput());
    writer->SetFileName((folder / "b.vtp").c_str());
    writer->SetDataMode(form % 4 == 0   ? vtkXMLWriter::Ascii
                        : form % 4 == 1 ? vtkXMLWriter::Binary
                                        : vtkXMLWriter::Appended);
    writer->SetEncodeAppendedData(form % 4 == 2);
    if (form & 4) writer->SetCompressorTypeToNone();
    if (form & 8) writer->SetByteOrderToBigEndian();
    if (form & 16) writer->SetHeaderTypeToUInt64();
    writer->SetBlockSize(1024);
    ASSERT_EQ(writer->Write(), 1);
    const auto loaded = loadSurface(folder / "b.vtp");
    ASSERT_TRUE(loaded) << "form " << form << ": " << loaded.error().message;
    EXPECT_EQ(encodeSlim(*loaded), encodeSlim(surface)) << "form " << form;
  }
}

TEST(VtpRead, AnArrayOfNoKnownTypeIsNamed) {
  const TemporaryFolder folder;
  ASSERT_FALSE(saveSurface(folder / "a.vtp", sphereSurface(2, 50)));
  const auto bytes = fileBytes(folder / "a.vtp");
  std::string text(bytes.begin(), bytes.end());
  text[text.find("String") + 4] = '0';
  writeText(folder / "a.vtp", text);
  const auto loaded = loadSurface(folder / "a.vtp");
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("type"), std::string::npos) << loaded.error().message;
}

TEST(VtpRead, DamageNeverCrashesAndIsToldInOneLine) {
  const TemporaryFolder folder;
  ASSERT_FALSE(saveSurface(folder / "a.vtp", sphereSurface(2, 30)));
  const auto bytes = fileBytes(folder / "a.vtp");
  std::mt19937 random(3);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    auto damaged = bytes;
    for (int k = 0; k <= trial % 3; ++k) {
      // Half of the changes fall upon the markup and the first array's header.
      const std::size_t range = random() % 2 ? damaged.size() : damaged.size() / 3;
      damaged[random() % range] = static_cast<unsigned char>(random());
    }
    if (trial % 5 == 0) damaged.resize(random() % damaged.size());
    writeBytes(folder / "b.vtp", damaged);
    const auto loaded = loadSurface(folder / "b.vtp");
    if (loaded) continue;
    ++refused;
    EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos) << loaded.error().message;
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace pcl_slim
#endif
