// SPDX-License-Identifier: BSD-3-Clause
// Files of one machine, or of alike ones: numbers are stored as in memory, behind a magic word, an identity and
// a checksum.
#include "state/kept_plan.h"

#include <cstring>
#include <type_traits>

#include "pcl_slim/core/file_access.h"

namespace pcl_slim::detail {

namespace {

constexpr char kMagic[] = "pcl_slim tiles 4\n";

using Bytes = std::vector<unsigned char>;

std::uint64_t
checksum(const Bytes& bytes, std::size_t size)
{
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

/** Numbers to bytes, and back: one list of what is kept, for both ways. */
class Writer {
 public:
  template <typename T>
  void operator()(const T& value)
  {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const unsigned char*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  template <typename T>
  void operator()(const std::vector<T>& values)
  {
    (*this)(std::uint64_t{values.size()});
    for (const T& value : values) (*this)(value);
  }
  Bytes bytes;
};

class Reader {
 public:
  Reader(const Bytes& bytes, std::size_t at, std::size_t end) : bytes_(bytes), at_(at), end_(end) {}

  template <typename T>
  void operator()(T& value)
  {
    static_assert(std::is_trivially_copyable_v<T>);
    good = good && end_ - at_ >= sizeof(T);
    if (!good) return;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
  }
  template <typename T>
  void operator()(std::vector<T>& values)
  {
    std::uint64_t count = 0;
    (*this)(count);
    good = good && count <= (end_ - at_) / sizeof(T);
    if (!good) return;
    values.resize(static_cast<std::size_t>(count));
    for (T& value : values) (*this)(value);
  }
  bool good = true;

 private:
  const Bytes& bytes_;
  std::size_t at_, end_;
};

template <typename Plan, typename Visit>
void
visitPlan(Plan& p, Visit& visit)
{
  visit(p.frame.origin);
  visit(p.frame.scale);
  visit(p.frame.diagonal);
  visit(p.frame.bulk_diagonal);
  visit(p.frame.center_grid);
  visit(p.frame.bulk_center);
  visit(p.frame.bulk_reach);
  visit(p.frame.bulk_between);
  visit(p.frame.with_normals);
  visit(p.record.scalar);
  visit(p.record.normals);
  visit(p.traits);
  visit(p.noise.lambda);
  visit(p.noise.noise.patches);
  visit(p.noise.noise.error);
  visit(p.noise.noise.correlation);
  visit(p.noise.noise.correlation_error);
  visit(p.noise.noise.line);
  visit(p.noise.noise.step);
  visit(p.noise.noise.neighbors);
  visit(p.noise.noise.varies);
  visit(p.noise.noise.normal_error);
  visit(p.noise.noise.normals_follow_points);
  visit(p.points);
  visit(p.thinning);
  visit(p.plan.cells);
  visit(p.first_levels);
  visit(p.halos);
  visit(p.balls);
}

/** Puts the magic word and the identity before what is kept, and a checksum behind it. */
Error
saveKept(const std::string& path, const std::string& identity, const Bytes& payload)
{
  Writer out;
  out.bytes.assign(kMagic, kMagic + sizeof(kMagic) - 1);
  out(std::vector<char>(identity.begin(), identity.end()));
  out.bytes.insert(out.bytes.end(), payload.begin(), payload.end());
  out(checksum(out.bytes, out.bytes.size()));
  return writeFile(path, out.bytes.data(), out.bytes.size());
}

/** \\return where what is kept begins, 0 for a file that is not whole or of another identity. */
std::size_t
openKept(const std::string& path, const std::string& identity, Bytes& bytes)
{
  Result<Bytes> read = readFile(path);
  constexpr std::size_t kHead = sizeof(kMagic) - 1;
  if (!read || read->size() < kHead + 2 * sizeof(std::uint64_t)) return 0;
  bytes = std::move(*read);
  const std::size_t end = bytes.size() - sizeof(std::uint64_t);
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + end, sizeof(sum));
  if (std::memcmp(bytes.data(), kMagic, kHead) != 0 || checksum(bytes, end) != sum) return 0;
  std::vector<char> own;
  Reader in(bytes, kHead, end);
  in(own);
  if (!in.good || std::string(own.begin(), own.end()) != identity) return 0;
  return kHead + sizeof(std::uint64_t) + own.size();
}

std::string
planPath(const std::string& folder)
{
  return folder + "/plan";
}

std::string
tilePath(const std::string& folder, std::size_t tile)
{
  return folder + "/tile-" + std::to_string(tile);
}

}  // namespace

Error
savePlan(const std::string& folder, const std::string& identity, const KeptPlan& plan)
{
  Writer out;
  visitPlan(plan, out);
  return saveKept(planPath(folder), identity, out.bytes);
}

bool
loadPlan(const std::string& folder, const std::string& identity, KeptPlan& plan)
{
  Bytes bytes;
  const std::size_t begin = openKept(planPath(folder), identity, bytes);
  if (begin == 0) return false;
  Reader in(bytes, begin, bytes.size() - sizeof(std::uint64_t));
  visitPlan(plan, in);
  return in.good;
}

Error
saveTile(const std::string& folder, const std::string& identity, std::size_t tile,
         const FittedTile& made)
{
  return saveKept(tilePath(folder, tile), identity, packedTile(made));
}

bool
loadTile(const std::string& folder, const std::string& identity, std::size_t tile, FittedTile& made)
{
  Bytes bytes;
  const std::size_t begin = openKept(tilePath(folder, tile), identity, bytes);
  if (begin == 0) return false;
  const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(begin);
  made.kept = !unpackTile({first, bytes.end() - sizeof(std::uint64_t)}, made);
  return made.kept;
}

}  // namespace pcl_slim::detail
