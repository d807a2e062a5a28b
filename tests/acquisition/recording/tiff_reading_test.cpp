// SPDX-License-Identifier: GPL-3.0-or-later
// TIFF recordings and pictures as other programs write them.
#include <gmock/gmock.h>
#include <tiffio.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "acquisition/recording/picture_file.h"
#include "acquisition/recording/recording_backend.h"
#include "acquisition/recording/tiff_stack.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int stack_rows = 48, stack_columns = 64;

cv::Mat1w frame(int index) {
  cv::Mat1w counts(stack_rows, stack_columns);
  for (int y = 0; y < stack_rows; ++y) {
    for (int x = 0; x < stack_columns; ++x)
      counts(y, x) = static_cast<std::uint16_t>(7000 + 100 * index + 3 * y + x % 7);
  }
  return counts;
}

using Tags = std::function<void(TIFF*)>;

/// Pages as another program stores them.
void write(const std::filesystem::path& path, const std::vector<cv::Mat1w>& pages, const char* mode, const Tags& tags) {
  TIFF* tiff = TIFFOpen(path.c_str(), mode);
  ASSERT_NE(tiff, nullptr);
  for (const auto& page : pages) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, page.cols);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, page.rows);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 5);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    tags(tiff);
    for (int y = 0; y < page.rows; ++y) {
      cv::Mat1w row = page.row(y).clone();  // libtiff swaps and compresses in place
      ASSERT_GE(TIFFWriteScanline(tiff, row.ptr(), static_cast<std::uint32_t>(y), 0), 0);
    }
    ASSERT_NE(TIFFWriteDirectory(tiff), 0);
  }
  TIFFClose(tiff);
}

void expect_frame(const Recording& recording, std::uint64_t index, const cv::Mat1w& expected) {
  const auto read = recording.read(index);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->counts.size(), expected.size());
  EXPECT_EQ(cv::norm(read->counts, expected, cv::NORM_INF), 0) << index;
}

TEST(TiffStack, IsReadInEveryLosslessCompressionWithAndWithoutPredictorInAnyOrder) {
  const TemporaryFolder folder;
  const std::vector<cv::Mat1w> frames{frame(0), frame(1), frame(2)};
  for (const int compression : {COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS}) {
    for (const int predictor : {1, 2}) {
      if (predictor == 2 && compression == COMPRESSION_PACKBITS) continue;
      for (const char* mode : {"w", "wb"}) {
        const auto path = folder.path() / "stack.tif";
        write(path, frames, mode, [&](TIFF* tiff) {
          TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
          if (predictor == 2) TIFFSetField(tiff, TIFFTAG_PREDICTOR, 2);
        });

        const auto recording = open_tiff_stack(path, {});

        ASSERT_TRUE(recording) << recording.error().message;
        ASSERT_EQ(recording->frame_count, 3u);
        for (const std::uint64_t index : {2U, 0U, 1U}) expect_frame(*recording, index, frames[index]);
      }
    }
  }
}

TEST(TiffStack, OfImageJWithOneDirectoryHasAllItsImagesInBothByteOrders) {
  const TemporaryFolder folder;
  for (const char* mode : {"wl", "wb"}) {
    const auto path = folder.path() / "imagej.tif";
    write(path, {frame(0)}, mode, [](TIFF* tiff) {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, stack_rows);
      TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, "ImageJ=1.53t\nimages=3\nframes=3\nloop=false\n");
    });
    // The directory stands behind the first picture: the further ones have to be where the first one goes on.
    std::uint64_t offset = 0;
    {
      const TIFF* probe = TIFFOpen(path.c_str(), "r");
      std::uint64_t* offsets = nullptr;
      ASSERT_NE(TIFFGetField(const_cast<TIFF*>(probe), TIFFTAG_STRIPOFFSETS, &offsets), 0);
      offset = offsets[0];
      TIFFClose(const_cast<TIFF*>(probe));
    }
    std::string bytes;
    {
      std::ifstream in(path, std::ios::binary);
      bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    const std::size_t picture_bytes = std::size_t{2} * stack_rows * stack_columns;
    // The directory is moved behind the pictures by moving its offset in the header and those of its long values: both
    // are relative to the file, so two pictures are put before everything behind the first one only in a file whose
    // strips come last. Here the pictures are appended and the strip is pointed at them.
    std::string pictures;
    for (int k = 0; k < 3; ++k) {
      for (const auto count : frame(k)) {
        const char low = static_cast<char>(count & 255), high = static_cast<char>(count >> 8);
        pictures += mode[1] == 'l' ? std::string{low, high} : std::string{high, low};
      }
    }
    const auto appended = static_cast<std::uint32_t>(bytes.size());
    std::string old(4, '\0'), fresh(4, '\0');
    for (unsigned k = 0; k < 4; ++k) {
      const unsigned shift = mode[1] == 'l' ? 8 * k : 24 - 8 * k;
      old[k] = static_cast<char>(offset >> shift & 255);
      fresh[k] = static_cast<char>(appended >> shift & 255);
    }
    const std::string tag = mode[1] == 'l' ? std::string("\x11\x01\x04\x00\x01\x00\x00\x00", 8)
                                           : std::string("\x01\x11\x00\x04\x00\x00\x00\x01", 8);
    const std::size_t entry = bytes.find(tag + old, picture_bytes);
    ASSERT_NE(entry, std::string::npos);
    bytes.replace(entry + 8, 4, fresh);
    folder.write("imagej.tif", bytes + pictures);

    const auto recording = open_tiff_stack(path, {});

    ASSERT_TRUE(recording) << recording.error().message;
    ASSERT_EQ(recording->frame_count, 3u) << mode;
    for (const std::uint64_t index : {0U, 2U, 1U}) expect_frame(*recording, index, frame(static_cast<int>(index)));

    folder.write("imagej.tif", bytes + pictures.substr(0, 2 * picture_bytes));
    const auto cut = open_tiff_stack(path, {});
    ASSERT_FALSE(cut);
    EXPECT_THAT(cut.error().message, HasSubstr("ImageJ states 3 images"));
  }
}

TEST(TiffStack, IsTurnedAsItsOrientationSaysAndTurnedRoundWhereZeroIsWhite) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "turned.tif";
  const cv::Mat1w shown = frame(0);
  cv::Mat1w upside, mirrored, both;
  cv::flip(shown, upside, 0);
  cv::flip(shown, mirrored, 1);
  cv::flip(shown, both, -1);
  const cv::Mat1w t = shown.t();
  cv::Mat1w t_rows, t_columns, t_both;
  cv::flip(t, t_rows, 0);
  cv::flip(t, t_columns, 1);
  cv::flip(t, t_both, -1);
  // What is stored at (row r, column c) under each orientation of TIFF 6.0, section "Orientation".
  const std::vector<std::pair<int, cv::Mat1w>> cases{{ORIENTATION_TOPLEFT, shown},   {ORIENTATION_TOPRIGHT, mirrored},
                                                     {ORIENTATION_BOTRIGHT, both},   {ORIENTATION_BOTLEFT, upside},
                                                     {ORIENTATION_LEFTTOP, t},       {ORIENTATION_RIGHTTOP, t_rows},
                                                     {ORIENTATION_RIGHTBOT, t_both}, {ORIENTATION_LEFTBOT, t_columns}};
  for (const auto& [orientation, stored] : cases) {
    write(path, {stored}, "w", [o = orientation](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_ORIENTATION, o); });

    const auto recording = open_tiff_stack(path, {});

    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_EQ(recording->info.width, stack_columns);
    expect_frame(*recording, 0, shown);
    const auto picture = read_picture(path);
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_EQ(cv::norm(picture->picture, cv::Mat1d(shown), cv::NORM_INF), 0) << orientation;
  }
  write(path, {cv::Mat1w(~shown)}, "w",
        [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISWHITE); });
  expect_frame(open_tiff_stack(path, {}).value(), 0, shown);
  EXPECT_EQ(cv::norm(read_picture(path)->picture, cv::Mat1d(shown), cv::NORM_INF), 0);
}

TEST(TiffStack, OfAFolderIsReadInTheOrderOfTheNumbersInItsNames) {
  const TemporaryFolder folder;
  for (int k = 0; k < 12; ++k)
    write(folder.path() / ("f_" + std::to_string(k) + ".TIF"), {frame(k)}, "w", [](TIFF*) {});

  const auto recording = open_recording(folder.path(), "");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 12u);
  for (int k = 0; k < 12; ++k) expect_frame(*recording, static_cast<std::uint64_t>(k), frame(k));
  EXPECT_THAT(recording->info.warnings, ::testing::ElementsAre(HasSubstr("f_0.TIF first, f_11.TIF last")));
}

TEST(TiffStack, OfAFolderWithLeadingZerosGivesNoWarning) {
  const TemporaryFolder folder;
  for (const char* name : {"a_009.tif", "a_010.tif"}) write(folder.path() / name, {frame(0)}, "w", [](TIFF*) {});

  EXPECT_THAT(open_recording(folder.path(), "")->info.warnings, ::testing::IsEmpty());
}

TEST(TiffPicture, WhoseBytesAreExchangedIsRefused) {
  const TemporaryFolder folder;
  cv::Mat1w swapped = frame(0);
  for (auto& count : swapped) count = static_cast<std::uint16_t>(count << 8 | count >> 8);
  write(folder.path() / "p.tif", {swapped}, "w", [](TIFF*) {});

  const auto picture = read_picture(folder.path() / "p.tif");

  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, ErrorCode::integrity);
  EXPECT_THAT(picture.error().message, HasSubstr("bytes of its pixels are swapped"));
}

TEST(TiffPicture, InBigEndianOrderThatItStatesIsRead) {
  const TemporaryFolder folder;
  write(folder.path() / "p.tif", {frame(3)}, "wb", [](TIFF*) {});

  EXPECT_EQ(cv::norm(read_picture(folder.path() / "p.tif")->picture, cv::Mat1d(frame(3)), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace todbench
