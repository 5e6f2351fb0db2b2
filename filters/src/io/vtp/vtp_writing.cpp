// SPDX-License-Identifier: BSD-3-Clause
#include "io/vtp/vtp_writing.h"

#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

/** Keeps VTK from printing while a file is tried. */
class SilentVtk {
 public:
  SilentVtk() : display_(vtkObject::GetGlobalWarningDisplay())
  {
    vtkObject::GlobalWarningDisplayOff();
  }
  ~SilentVtk() { vtkObject::SetGlobalWarningDisplay(display_); }

 private:
  int display_;
};

}  // namespace

Error
writeVtp(const std::string& path, vtkPolyData* data)
{
  const SilentVtk silent;
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0) {
    return {ErrorCode::kIo,
            "cannot write '" + path + "': VTK refused the data; write a .ply file instead"};
  }
  const std::string text = writer->GetOutputString();
  return writeFile(path, text.data(), text.size());
}

}  // namespace pcl_slim
