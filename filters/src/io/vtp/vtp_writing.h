// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkDataSetAttributes.h>
#include <vtkNew.h>

#include <cstddef>
#include <string>

#include "pcl_slim/core/error.h"

class vtkPolyData;

namespace pcl_slim {

/** Adds an array of type Array, whose component k of tuple i is value(i, k). */
template <typename Array, typename Value>
void
addArray(vtkDataSetAttributes* data, const char* name, std::size_t count, int components,
         const Value& value)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < components; ++k) {
      array->SetComponent(static_cast<vtkIdType>(i), k,
                          static_cast<double>(value(i, static_cast<std::size_t>(k))));
    }
  }
  data->AddArray(array);
}

/** Writes VTK's data as .vtp. */
Error
writeVtp(const std::string& path, vtkPolyData* data);

}  // namespace pcl_slim
