// SPDX-License-Identifier: GPL-3.0-or-later
// TIFF recordings and pictures as other programs write them.
#include <gmock/gmock.h>
#include <tiffio.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
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
  for (const int compression :
       {COMPRESSION_LZW, COMPRESSION_DEFLATE, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS}) {
    for (const int predictor : {1, 2}) {
      if (predictor == 2 && compression == COMPRESSION_PACKBITS) continue;
      for (const char* mode : {"w", "wb", "w8", "w8b"}) {
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
  // A scale and a number of bits describe the values in the file.
  for (const char* query : {"kelvin_per_count=0.01", "kelvin_per_count=0.01&offset_k=0", "bits=14"}) {
    const auto refused = open_recording(path, query);
    ASSERT_FALSE(refused) << query;
    EXPECT_THAT(refused.error().message, HasSubstr("0 is white"));
  }
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

/// A picture in tiles of 32 x 16, wider and higher than a whole number of them.
void write_tiles(const std::filesystem::path& path, const cv::Mat1w& picture, const char* mode, int compression) {
  constexpr int tile_width = 32, tile_height = 16;
  TIFF* tiff = TIFFOpen(path.c_str(), mode);
  ASSERT_NE(tiff, nullptr);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, picture.cols);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, picture.rows);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, tile_width);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, tile_height);
  for (int y = 0; y < picture.rows; y += tile_height) {
    for (int x = 0; x < picture.cols; x += tile_width) {
      cv::Mat1w tile(tile_height, tile_width, ushort{0});
      const cv::Rect part = cv::Rect(x, y, tile_width, tile_height) & cv::Rect({}, picture.size());
      picture(part).copyTo(tile(cv::Rect({}, part.size())));
      ASSERT_GE(TIFFWriteTile(tiff, tile.data, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, 0), 0);
    }
  }
  TIFFClose(tiff);
}

TEST(TiffStack, InTilesIsReadInBothByteOrdersCompressedAndNot) {
  const TemporaryFolder folder;
  cv::Mat1w picture(50, 70);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) picture(y, x) = static_cast<ushort>(8000 + 100 * y + x);
  }
  for (const char* mode : {"w", "wb", "w8"}) {
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
      const auto path = folder.path() / "tiles.tif";
      write_tiles(path, picture, mode, compression);

      const auto recording = open_tiff_stack(path, {});

      ASSERT_TRUE(recording) << recording.error().message;
      expect_frame(*recording, 0, picture);
      EXPECT_EQ(cv::norm(read_picture(path)->picture, cv::Mat1d(picture), cv::NORM_INF), 0);
    }
  }
}

/// Pages of any type of sample.
void write_values(const std::filesystem::path& path, const std::vector<cv::Mat>& pages, const char* mode,
                  int predictor) {
  TIFF* tiff = TIFFOpen(path.c_str(), mode);
  ASSERT_NE(tiff, nullptr);
  for (const auto& page : pages) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, page.cols);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, page.rows);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * page.elemSize()));
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, page.depth() >= CV_32F ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_INT);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 7);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, predictor > 0 ? COMPRESSION_LZW : COMPRESSION_NONE);
    if (predictor > 0) TIFFSetField(tiff, TIFFTAG_PREDICTOR, predictor);
    for (int y = 0; y < page.rows; ++y) {
      cv::Mat row = page.row(y).clone();
      // The predictor of floating point is the same in both byte orders, but libtiff 4.5 swaps the values before it.
      if (predictor == 3 && TIFFIsByteSwapped(tiff) != 0) {
        if (row.depth() == CV_32F) TIFFSwabArrayOfFloat(row.ptr<float>(), row.cols);
        if (row.depth() == CV_64F) TIFFSwabArrayOfDouble(row.ptr<double>(), row.cols);
      }
      ASSERT_GE(TIFFWriteScanline(tiff, row.data, static_cast<std::uint32_t>(y), 0), 0);
    }
    ASSERT_NE(TIFFWriteDirectory(tiff), 0);
  }
  TIFFClose(tiff);
}

/// A little-endian file whose directory precedes its pixels, as tifffile writes it: one strip of `strip_bytes`.
std::string directory_first(std::uint32_t bits, std::uint32_t kind, std::uint32_t strip_bytes,
                            const std::string& pixels) {
  std::string bytes("II*\0\x08\0\0\0", 8);
  const auto number = [&](std::uint32_t value, int length) {
    for (int k = 0; k < length; ++k) bytes += static_cast<char>(value >> 8 * k & 255);
  };
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> entries{{TIFFTAG_IMAGEWIDTH, stack_columns},
                                                                     {TIFFTAG_IMAGELENGTH, stack_rows},
                                                                     {TIFFTAG_BITSPERSAMPLE, bits},
                                                                     {TIFFTAG_COMPRESSION, COMPRESSION_NONE},
                                                                     {TIFFTAG_PHOTOMETRIC, 1},
                                                                     {TIFFTAG_STRIPOFFSETS, 8 + 2 + 10 * 12 + 4},
                                                                     {TIFFTAG_SAMPLESPERPIXEL, 1},
                                                                     {TIFFTAG_ROWSPERSTRIP, stack_rows},
                                                                     {TIFFTAG_STRIPBYTECOUNTS, strip_bytes},
                                                                     {TIFFTAG_SAMPLEFORMAT, kind}};
  number(static_cast<std::uint32_t>(entries.size()), 2);
  for (const auto& [tag, value] : entries) {
    number(tag, 2);
    number(TIFF_LONG, 2);
    number(1, 4);
    number(value, 4);
  }
  number(0, 4);
  return bytes + pixels;
}

TEST(TiffStack, ThatWasTruncatedBehindItsDirectoryIsRefusedWhenItIsOpened) {
  const TemporaryFolder folder;
  for (const auto& [bits, kind, query] : {std::tuple(16U, 1U, ""), std::tuple(32U, 3U, "unit=kelvin")}) {
    const std::uint32_t strip = bits / 8 * stack_rows * stack_columns;
    std::string pixels;
    for (std::uint32_t k = 0; k < stack_rows * stack_columns; ++k)
      pixels += bits == 16 ? std::string("\x10\x20") : std::string("\0\0\x96\x43", 4);  // 300 as a float

    const auto whole = open_recording(folder.write("a.tif", directory_first(bits, kind, strip, pixels)), query);
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_TRUE(whole->read(0));
    // Some programs state a strip that reaches to the end of the file and beyond.
    const auto longer = open_recording(folder.write("a.tif", directory_first(bits, kind, strip + 64, pixels)), query);
    EXPECT_TRUE(longer) << longer.error().message;
    for (const std::size_t missing : {std::size_t{1}, std::size_t{500}, pixels.size()}) {
      pixels.resize(strip - missing);
      const auto cut = open_recording(folder.write("a.tif", directory_first(bits, kind, strip, pixels)), query);
      ASSERT_FALSE(cut);
      EXPECT_EQ(cut.error().code, ErrorCode::invalid_input);
      EXPECT_THAT(cut.error().message, HasSubstr("the file is truncated"));
    }
  }
}

TEST(TiffStack, OfHalfPrecisionIsRefusedByName) {
  const TemporaryFolder folder;
  const std::uint32_t strip = 2 * stack_rows * stack_columns;

  const auto half = open_recording(folder.write("a.tif", directory_first(16, 3, strip, std::string(strip, 'A'))), "");

  ASSERT_FALSE(half);
  EXPECT_THAT(half.error().message, HasSubstr("1 sample of 16 bits floating point"));
}

TEST(TiffStack, OfFloatingPointTemperaturesHasNoCountThatLooksSaturated) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.tif";
  for (int k = 0; k < 40; ++k) {
    cv::Mat1d page(8, 8, 301.0);
    page(1, 1) = 300 + k * 0.7e-5;
    page(2, 2) = page(1, 1) + 65533e-4;
    write_values(path, {page}, "w", 0);

    const auto recording = open_recording(path, "unit=kelvin");

    ASSERT_TRUE(recording) << recording.error().message;
    const cv::Mat1w counts = recording->read(0)->counts;
    EXPECT_GT(counts(1, 1), 0) << k;
    EXPECT_LT(counts(2, 2), 65535) << k;
  }
}

TEST(RecordingKeys, RefuseAnOffsetWithoutAScale) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.tif";
  write(path, {frame(0)}, "w", [](TIFF*) {});

  const auto refused = open_recording(path, "offset_k=10");

  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("offset_k is stated without kelvin_per_count"));
}

TEST(TiffStack, OfFloatingPointTemperaturesHasThemToToHalfAStepInTheStatedUnit) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.tif";
  const std::vector<cv::Mat1w> counts{frame(0), frame(1)};
  for (const int depth : {CV_32F, CV_64F}) {
    for (const int predictor : {0, 3}) {
      for (const char* mode : {"w", "wb", "w8"}) {
        std::vector<cv::Mat> pages(2);
        // 0.01 K a count: 280 to 283 K.
        for (std::size_t k = 0; k < 2; ++k) counts[k].convertTo(pages[k], depth, 0.01, 210);
        write_values(path, pages, mode, predictor);

        const auto kelvin = open_recording(path, "unit=kelvin"), celsius = open_recording(path, "unit=celsius");

        ASSERT_TRUE(kelvin) << kelvin.error().message;
        ASSERT_TRUE(celsius) << celsius.error().message;
        ASSERT_EQ(kelvin->frame_count, 2u);
        // 3 K in 65532 steps: the smallest step of the series, 0.1 mK. Rounding of the file's numbers: below 0.02 mK.
        const LinearScale* line = kelvin->info.scale.straight_line();
        ASSERT_NE(line, nullptr);
        EXPECT_DOUBLE_EQ(line->kelvin_per_count, 1e-4);
        for (std::size_t k = 0; k < 2; ++k) {
          const auto read = kelvin->read(k);
          ASSERT_TRUE(read) << read.error().message;
          for (int y = 0; y < stack_rows; y += 5) {
            for (int x = 0; x < stack_columns; x += 3) {
              const double expected = 210 + 0.01 * counts[k](y, x),
                           seen = kelvin->info.scale.kelvin(read->counts(y, x)).value();
              EXPECT_NEAR(seen, expected, 0.7e-4);
              EXPECT_NEAR(celsius->info.scale.kelvin(celsius->read(k)->counts(y, x)).value(), expected + 273.15,
                          0.7e-4);
            }
          }
        }
      }
    }
  }
  EXPECT_THAT(open_recording(path, "").error().message, HasSubstr("floating point: state ?unit=kelvin"));
  EXPECT_THAT(open_recording(path, "unit=fahrenheit").error().message, HasSubstr("counts or kelvin or celsius"));
  EXPECT_THAT(open_recording(path, "unit=counts").error().message, HasSubstr("is no whole count"));
}

TEST(TiffStack, OfFloatingPointValuesThatNoScaleHoldsIsRefused) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.tif";
  const auto refused = [&](float low, float high) {
    cv::Mat1f page(8, 8, 300.0F);
    page(1, 1) = low;
    page(2, 2) = high;
    write_values(path, {page}, "w", 0);
    const auto recording = open_recording(path, "unit=kelvin");
    return recording ? "read" : recording.error().message;
  };

  EXPECT_EQ(refused(1, 6500), "read");
  EXPECT_THAT(refused(1, 6600), HasSubstr("no step up to 0.1 K"));
  EXPECT_THAT(refused(-20, 300), HasSubstr("is no temperature in kelvin"));
  EXPECT_THAT(refused(300, std::numeric_limits<float>::quiet_NaN()), HasSubstr("a value is not a number"));
}

TEST(TiffStack, OfSignedValuesKeepsTheStatedScaleOfThem) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "s.tif";
  cv::Mat1s page(8, 8, short{-100});
  page(0, 0) = -32768;
  page(7, 7) = 32767;
  for (const char* mode : {"w", "wb"}) {
    write_values(path, {page}, mode, 2);

    const auto counts = open_recording(path, "unit=counts"),
               scaled = open_recording(path, "kelvin_per_count=0.01&offset_k=290");

    ASSERT_TRUE(counts) << counts.error().message;
    ASSERT_TRUE(scaled) << scaled.error().message;
    const cv::Mat1w read = counts->read(0)->counts;
    EXPECT_EQ(read(0, 0), 0);
    EXPECT_EQ(read(3, 3), 32668);
    EXPECT_EQ(read(7, 7), 65535);
    EXPECT_FALSE(counts->info.scale.calibrated());
    EXPECT_NEAR(scaled->info.scale.kelvin(32668).value(), 289, 1e-9);
  }
  EXPECT_THAT(open_recording(path, "").error().message, HasSubstr("signed: state ?unit=counts"));
}

TEST(RawFile, IsReadInTheStatedByteOrderAndSign) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.raw", std::string("\x12\x34\xff\x9c", 4));
  const auto read = [&](const std::string& more) {
    const auto recording = open_recording(path, "width=2&height=1" + more);
    EXPECT_TRUE(recording) << recording.error().message;
    const cv::Mat1w counts = recording->read(0)->counts;
    return std::pair(int{counts(0, 0)}, int{counts(0, 1)});
  };

  EXPECT_EQ(read(""), std::pair(0x3412, 0x9cff));
  EXPECT_EQ(read("&byte_order=little&signed=no"), std::pair(0x3412, 0x9cff));
  EXPECT_EQ(read("&byte_order=big"), std::pair(0x1234, 0xff9c));
  EXPECT_EQ(read("&byte_order=big&signed=yes"), std::pair(0x1234 + 32768, 32768 - 100));
  const auto scaled =
      open_recording(path, "width=2&height=1&byte_order=big&signed=yes&kelvin_per_count=0.01&offset_k=273.15");
  EXPECT_NEAR(scaled->info.scale.kelvin(32768 - 100).value(), 272.15, 1e-9);
  EXPECT_EQ(scaled->info.settings.at("ByteOrder"), "big-endian");
  EXPECT_THAT(open_recording(path, "width=2&height=1&byte_order=middle").error().message, HasSubstr("little or big"));
  EXPECT_THAT(open_recording(path, "width=2&height=1&unit=kelvin").error().message, HasSubstr("raw values are counts"));
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
