// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/picture_file.h"

#include <gmock/gmock.h>
#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int rows = 3, columns = 4;

/// Value of pixel (y, x) of every picture here; 5 bits.
double value_at(int y, int x) {
  return y * columns + x + 1;
}

template <typename Value>
std::string npy(const std::string& type, char order, bool fortran) {
  std::string header = std::string("{'descr': '") + order + type +
                       "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (3, 4), }";
  header.append(63 - (10 + header.size()) % 64, ' ');
  header.push_back('\n');
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes.push_back(static_cast<char>(header.size() % 256));
  bytes.push_back(static_cast<char>(header.size() / 256));
  bytes += header;
  for (int i = 0; i < rows * columns; ++i) {
    const auto value = static_cast<Value>(fortran ? value_at(i % rows, i / rows) : value_at(i / columns, i % columns));
    char raw[sizeof(Value)];
    std::memcpy(raw, &value, sizeof(Value));
    if (order == '>') std::reverse(raw, raw + sizeof(Value));
    bytes.append(raw, sizeof(Value));
  }
  return bytes;
}

void expect_picture(const Result<PictureFile>& file) {
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->picture.size(), cv::Size(columns, rows));
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) EXPECT_EQ(file->picture(y, x), value_at(y, x));
  }
}

TEST(NpyPicture, IsReadInEveryTypeBothByteOrdersAndBothOrdersOfTheArray) {
  for (const bool fortran : {false, true}) {
    for (const char order : {'<', '>'}) {
      expect_picture(parse_npy(npy<std::uint16_t>("u2", order, fortran)));
      expect_picture(parse_npy(npy<std::int32_t>("i4", order, fortran)));
      expect_picture(parse_npy(npy<float>("f4", order, fortran)));
      expect_picture(parse_npy(npy<double>("f8", order, fortran)));
    }
    expect_picture(parse_npy(npy<std::uint8_t>("u1", '|', fortran)));
  }
  EXPECT_EQ(parse_npy(npy<std::uint16_t>("u2", '<', false))->counts, (std::pair{0.0, 65535.0}));
  EXPECT_FALSE(parse_npy(npy<float>("f4", '<', false))->counts);
}

TEST(NpyPicture, IsRefusedWhenItIsBrokenOrOfAnotherShape) {
  const std::string good = npy<double>("f8", '<', false);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    bytes.replace(bytes.find(from), from.size(), to);
    return parse_npy(bytes);
  };
  EXPECT_FALSE(parse_npy(""));
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(parse_npy(std::string_view(good).substr(0, size)));
  EXPECT_FALSE(parse_npy(good + "x"));
  EXPECT_FALSE(changed("(3, 4)", "(12,) "));
  EXPECT_FALSE(changed("(3, 4)", "(0, 4)"));
  EXPECT_FALSE(changed("(3, 4)", "(-3,4)"));
  EXPECT_FALSE(changed("<f8", "<c8"));
  EXPECT_FALSE(changed("<f8", "|O8"));
  EXPECT_FALSE(changed("False", "Maybe"));
}

template <typename Value>
void write_tiff(const std::filesystem::path& path, int kind, const char* mode, int pages = 1) {
  TIFF* tiff = TIFFOpen(path.c_str(), mode);
  ASSERT_NE(tiff, nullptr);
  for (int page = 0; page < pages; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, columns);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, rows);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sizeof(Value)));
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kind);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    for (int y = 0; y < rows; ++y) {
      Value row[columns];
      for (int x = 0; x < columns; ++x) row[x] = static_cast<Value>(value_at(y, x));
      TIFFWriteScanline(tiff, row, static_cast<std::uint32_t>(y), 0);
    }
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
}

TEST(TiffPicture, IsReadInEveryTypeAndBothByteOrders) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "picture.tiff";
  for (const char* mode : {"wl", "wb"}) {
    write_tiff<std::uint8_t>(path, SAMPLEFORMAT_UINT, mode);
    expect_picture(read_picture(path));
    write_tiff<std::uint16_t>(path, SAMPLEFORMAT_UINT, mode);
    expect_picture(read_picture(path));
    write_tiff<float>(path, SAMPLEFORMAT_IEEEFP, mode);
    expect_picture(read_picture(path));
    write_tiff<double>(path, SAMPLEFORMAT_IEEEFP, mode);
    expect_picture(read_picture(path));
  }
}

TEST(PictureFile, IsRefusedWithItsNameWhenItIsNoPicture) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::filesystem::path& path) {
    const auto file = read_picture(path);
    EXPECT_FALSE(file);
    return file ? "" : file.error().message;
  };
  const std::filesystem::path path = folder.path() / "picture.npy";
  EXPECT_THAT(refused(path), HasSubstr("picture.npy: no such file"));
  EXPECT_THAT(refused(folder.path()), HasSubstr("it is a folder"));
  std::ofstream(path).close();
  EXPECT_THAT(refused(path), HasSubstr("empty"));
  std::ofstream(path) << "size,correct";
  EXPECT_THAT(refused(path), HasSubstr("expected a TIFF or .npy file"));
  std::ofstream(path) << "II*\0 and no more";
  EXPECT_FALSE(refused(path).empty());
  write_tiff<std::uint16_t>(path, SAMPLEFORMAT_UINT, "wl", 2);
  EXPECT_THAT(refused(path), HasSubstr("more than one picture"));
}

}  // namespace
}  // namespace todbench
