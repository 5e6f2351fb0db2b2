// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <random>
#include <string>
#include <system_error>

namespace pcl_slim_test {

/** A folder of this test's own, removed with the object. */
class TemporaryFolder {
 public:
  TemporaryFolder()
  {
    std::random_device random;
    path_ = std::filesystem::temp_directory_path() / ("pcl_slim_test_" + std::to_string(random()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder()
  {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  std::size_t numFiles() const
  {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

}  // namespace pcl_slim_test
