// SPDX-License-Identifier: BSD-3-Clause
#include "columns/gzip.h"

#include <zlib.h>

namespace pcl_slim::detail {
namespace {

constexpr int kGzipWindow = 15 + 16;  ///< zlib's largest window, in gzip's frame

/** \brief Runs a zlib stream to its end. \param[in] step deflate or inflate */
template <typename Step>
Error
runStream(z_stream& stream, const std::vector<unsigned char>& bytes,
          std::vector<unsigned char>& out, const Step& step)
{
  unsigned char part[1 << 16];
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  for (;;) {
    stream.next_out = part;
    stream.avail_out = sizeof part;
    const int status = step(&stream, Z_FINISH);
    const std::size_t made = sizeof part - stream.avail_out;
    out.insert(out.end(), part, part + made);
    if (status == Z_STREAM_END) return {};
    if (status != Z_OK && status != Z_BUF_ERROR) break;
    if (made == 0) break;
  }
  return badInput("the page's data are damaged; save the page again");
}

}  // namespace

Result<std::vector<unsigned char>>
gzip(const std::vector<unsigned char>& bytes)
{
  z_stream stream{};
  std::vector<unsigned char> out;
  if (bytes.size() > 0x7fffffff || deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED,
                                                kGzipWindow, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    return badInput("too much data for a page; fit the surface with -compact 1 or a larger error");
  }
  const Error error = runStream(stream, bytes, out, deflate);
  deflateEnd(&stream);
  if (error) return error;
  return out;
}

Result<std::vector<unsigned char>>
gunzip(const std::vector<unsigned char>& bytes)
{
  z_stream stream{};
  std::vector<unsigned char> out;
  if (inflateInit2(&stream, kGzipWindow) != Z_OK) return badInput("out of memory");
  const Error error = runStream(stream, bytes, out, inflate);
  inflateEnd(&stream);
  if (error) return error;
  return out;
}

}  // namespace pcl_slim::detail
