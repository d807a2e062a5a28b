// SPDX-License-Identifier: GPL-3.0-or-later
// Files in folders that a stranger filled.
#include "acquisition/base/safe_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/tiff_stack.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using testing::content_of;
using testing::TemporaryFolder;

class FilesOfAStranger : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_symlink(victim_, link_); }
  void make_pipe(const std::filesystem::path& path) { ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0); }

  TemporaryFolder folder_;
  std::filesystem::path victim_ = folder_.write("victim", "precious");
  std::filesystem::path link_ = folder_.path() / "link", pipe_ = folder_.path() / "pipe";
};

TEST_F(FilesOfAStranger, AnEmptyFileReplacesALinkAndDoesNotFollowIt) {
  const auto made = make_empty_file(link_);

  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(::write(*made, "x", 1), 1);
  ::close(*made);
  EXPECT_EQ(content_of(victim_), "precious");
  EXPECT_FALSE(std::filesystem::is_symlink(link_));
  EXPECT_EQ(content_of(link_), "x");
}

TEST_F(FilesOfAStranger, NothingIsAppendedThroughALink) {
  EXPECT_FALSE(open_to_append(link_));
  EXPECT_FALSE(open_to_append(folder_.path() / "nowhere" / "file"));
  std::filesystem::create_symlink(folder_.path() / "made", folder_.path() / "dangling");
  EXPECT_FALSE(open_to_append(folder_.path() / "dangling"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "made"));
}

TEST_F(FilesOfAStranger, ANewFileHasANameThatNobodyGuesses) {
  const auto one = make_file_beside(victim_), other = make_file_beside(victim_);

  ASSERT_TRUE(one && other);
  ::close(one->descriptor), ::close(other->descriptor);
  EXPECT_NE(one->path, other->path);
  EXPECT_TRUE(is_name_of_a_part(one->path)) << one->path;
  EXPECT_FALSE(is_name_of_a_part(victim_));
  EXPECT_FALSE(is_name_of_a_part(".victim.part"));
  const auto longest = make_file_beside(folder_.path() / std::string(255, 'n'));
  ASSERT_TRUE(longest) << longest.error().message;
  ::close(longest->descriptor);
}

// A writer or reader that waited would hold this test until its time limit.
TEST_F(FilesOfAStranger, NobodyWaitsForAPipe) {
  make_pipe(pipe_);
  EXPECT_FALSE(open_to_read(pipe_));
  EXPECT_FALSE(open_to_append(pipe_));
  EXPECT_FALSE(make_empty_file(pipe_));
  EXPECT_FALSE(open_frame_stream(pipe_));
  EXPECT_FALSE(is_frame_stream(pipe_));
  std::filesystem::create_directory(folder_.path() / "stack");
  make_pipe(folder_.path() / "stack" / "1.tif");
  EXPECT_FALSE(open_tiff_stack(folder_.path() / "stack", {}));
}

TEST_F(FilesOfAStranger, ARecordingReplacesALink) {
  StreamHeader header;
  header.info.width = header.info.height = 4;
  const auto writer = FrameStreamWriter::create(link_, header);

  ASSERT_TRUE(writer) << writer.error().message;
  EXPECT_EQ(content_of(victim_), "precious");
}

}  // namespace
}  // namespace todbench
