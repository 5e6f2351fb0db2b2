// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/web/web_surface.h"

#include "columns/gzip.h"
#include "columns/web_columns.h"

namespace pcl_slim {

Result<std::vector<unsigned char>>
encodeWebSurface(const SLIMSurface& surface, double precision)
{
  if (precision != 0.0 && !(precision >= 16.0 && precision <= 65536.0)) {
    return Error{ErrorCode::kBadArgument, "the precision must be 0 or 16 to 65536 steps"};
  }
  if (Error error = surface.validate()) return error;
  return detail::gzip(detail::packColumns(surface, precision));
}

Result<WebSurface>
decodeWebSurface(const std::vector<unsigned char>& bytes)
{
  const auto columns = detail::gunzip(bytes);
  if (!columns) return columns.error();
  return detail::unpackColumns(*columns);
}

}  // namespace pcl_slim
