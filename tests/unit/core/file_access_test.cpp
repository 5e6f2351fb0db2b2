// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/file_access.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "support/sphere_surface.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

TEST(FileAccess, WritesAndReadsBack) {
  const TemporaryFolder folder;
  const std::string path = folder / "a file";
  ASSERT_FALSE(writeFile(path, "abc", 3));
  ASSERT_FALSE(writeFile(path, "xy", 2));
  const auto bytes = readFile(path);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(std::string(bytes->begin(), bytes->end()), "xy");
  EXPECT_EQ(folder.numFiles(), 1u);
}

TEST(FileAccess, FollowsLinksAndKeepsThem) {
  const TemporaryFolder folder;
  writeText(folder / "real", "old");
  std::filesystem::create_symlink("real", folder / "link");
  ASSERT_FALSE(writeFile(folder / "link", "new", 3));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(fileBytes(folder / "real").size(), 3u);
  EXPECT_EQ(fileBytes(folder / "real")[0], 'n');
}

TEST(FileAccess, FollowsLinksToWhereNothingIsYet) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  fs::create_symlink("real", folder / "second");
  fs::create_symlink("second", folder / "first");
  ASSERT_FALSE(checkWritable(folder / "first"));
  ASSERT_FALSE(writeFile(folder / "first", "new", 3));
  EXPECT_TRUE(fs::is_symlink(folder / "first"));
  EXPECT_TRUE(fs::is_symlink(folder / "second"));
  EXPECT_EQ(fileBytes(folder / "real").size(), 3u);
}

TEST(FileAccess, KeepsLinksThatLeadToThemselves) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("round", folder / "round");
  EXPECT_EQ(checkWritable(folder / "round").code, ErrorCode::kIo);
  EXPECT_EQ(writeFile(folder / "round", "new", 3).code, ErrorCode::kIo);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "round"));
}

TEST(FileAccess, OnePlaceHasOneName) {
  const TemporaryFolder folder;
  const std::string place = placeOf(folder / "absent");
  std::filesystem::create_symlink("absent", folder / "link");
  EXPECT_EQ(placeOf(folder / "./absent"), place);
  EXPECT_EQ(placeOf(folder / "link"), place);
  EXPECT_EQ(placeOf("absent"), placeOf("./absent"));
  EXPECT_NE(placeOf(folder / "other"), place);
}

TEST(FileTransaction, FilesAppearTogether) {
  const TemporaryFolder folder;
  writeText(folder / "a", "old");
  FileTransaction files;
  ASSERT_FALSE(writeFile(folder / "a", "new", 3));
  ASSERT_FALSE(writeFile(folder / "b", "new", 3));
  EXPECT_EQ(fileBytes(folder / "a")[0], 'o');
  EXPECT_FALSE(std::filesystem::exists(folder / "b"));
  ASSERT_FALSE(files.commit());
  EXPECT_EQ(fileBytes(folder / "a")[0], 'n');
  EXPECT_EQ(fileBytes(folder / "b")[0], 'n');
  EXPECT_EQ(folder.numFiles(), 2u);
}

TEST(FileTransaction, LeavesNothingUnlessCommitted) {
  const TemporaryFolder folder;
  writeText(folder / "a", "old");
  {
    const FileTransaction files;
    ASSERT_FALSE(writeFile(folder / "a", "new", 3));
    FileTransaction inner;
    ASSERT_FALSE(writeFile(folder / "b", "new", 3));
    ASSERT_FALSE(inner.commit());
  }
  EXPECT_EQ(fileBytes(folder / "a")[0], 'o');
  EXPECT_EQ(folder.numFiles(), 2u);
  ASSERT_FALSE(writeFile(folder / "a", "new", 3));
  EXPECT_EQ(fileBytes(folder / "a")[0], 'n');
}

TEST(FileTransaction, ToldWhenAPlaceHasGone) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  fs::create_directory(folder / "gone");
  FileTransaction files;
  ASSERT_FALSE(writeFile(folder / "gone/a", "new", 3));
  ASSERT_FALSE(writeFile(folder / "b", "new", 3));
  fs::remove_all(folder / "gone");
  const Error error = files.commit();
  EXPECT_EQ(error.code, ErrorCode::kIo);
  EXPECT_NE(error.message.find("gone/a"), std::string::npos) << error.message;
  EXPECT_EQ(folder.numFiles(), 0u);
}

TEST(FileAccess, WritesDevicesDirectly) {
  EXPECT_FALSE(writeFile("/dev/null", "abc", 3));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(FileAccess, NamesWhatCannotBeUsed) {
  const TemporaryFolder folder;
  EXPECT_EQ(readFile(folder / "absent").error().code, ErrorCode::kIo);
  EXPECT_EQ(readFile(folder / "").error().code, ErrorCode::kIo);
  for (const std::string& path : {folder / "absent/file", folder / "", std::string()}) {
    EXPECT_EQ(writeFile(path, "abc", 3).code, ErrorCode::kIo) << path;
    EXPECT_EQ(checkWritable(path).code, ErrorCode::kIo) << path;
  }
  EXPECT_FALSE(checkWritable(folder / "file"));
  EXPECT_EQ(folder.numFiles(), 0u);
}

TEST(FileAccess, TakesNamesOfFullLength) {
  const TemporaryFolder folder;
  const std::string path = folder / std::string(255, 'x');
  ASSERT_FALSE(checkWritable(path));
  ASSERT_FALSE(writeFile(path, "abc", 3));
  EXPECT_EQ(fileBytes(path).size(), 3u);
  EXPECT_EQ(folder.numFiles(), 1u);
}

TEST(FileAccess, ReplacesNoReadOnlyFile) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  writeText(folder / "kept", "old");
  fs::permissions(folder / "kept", fs::perms::owner_read | fs::perms::others_read);
  EXPECT_EQ(checkWritable(folder / "kept").code, ErrorCode::kIo);
  const Error error = writeFile(folder / "kept", "new", 3);
  EXPECT_NE(error.message.find("read-only"), std::string::npos) << error.message;
  EXPECT_EQ(fileBytes(folder / "kept")[0], 'o');
}

TEST(FileAccess, ReplacedFilesKeepTheirPermissions) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  writeText(folder / "a", "old");
  const fs::perms before = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read;
  fs::permissions(folder / "a", before);
  ASSERT_FALSE(writeFile(folder / "a", "new", 3));
  EXPECT_EQ(fs::status(folder / "a").permissions(), before);
}

TEST(FileAccess, ReadsNoEndlessDevice) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/zero", folder / "scan.pcd");
  const auto bytes = readFile(folder / "scan.pcd");
  ASSERT_FALSE(bytes);
  EXPECT_NE(bytes.error().message.find("device"), std::string::npos) << bytes.error().message;
}

TEST(FileAccess, RemovesWhatKilledProcessesHaveLeft) {
  const TemporaryFolder folder;
  char host[64] = {};
  gethostname(host, sizeof(host) - 1);
  const pid_t child = fork();
  if (child == 0) _exit(0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);  // no process has this number now
  const auto named = [&](const std::string& where, long process) {
    return folder / (".pcl_slim_" + where + "_" + std::to_string(process) + "_7.part");
  };
  const std::string dead = named(host, child), alive = named(host, getpid()),
                    elsewhere = named(std::string(host) + "x", child),
                    others = folder / ".other_1_2.part";
  for (const std::string& path : {dead, alive, elsewhere, others}) writeText(path, "half");
  ASSERT_FALSE(writeFile(folder / "a", "abc", 3));
  EXPECT_FALSE(std::filesystem::exists(dead));
  for (const std::string& path : {alive, elsewhere, others})
    EXPECT_TRUE(std::filesystem::exists(path)) << path;
}

TEST(FileAccess, KnowsWhatIsReadOnce) {
  const TemporaryFolder folder;
  writeText(folder / "file", "abc");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(isStream(folder / "pipe"));
  EXPECT_TRUE(isStream("/dev/stdin"));
  EXPECT_TRUE(isStream("/dev/fd/63"));
  for (const char* name : {"file", "missing", "."}) EXPECT_FALSE(isStream(folder / name)) << name;
}

TEST(FileAccess, ExtensionsAreLowerCase) {
  EXPECT_EQ(lowerExtension("a.b/Scan.PcD"), ".pcd");
  EXPECT_EQ(lowerExtension("a.b/scan"), "");
}

}  // namespace
}  // namespace pcl_slim
