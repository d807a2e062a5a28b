// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/picture_files/encoded_picture.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <span>

#include "acquisition/base/rng.h"
#include "acquisition/recording/picture_file.h"
#include "tests/support/read_png.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using testing::read_png;
using ::testing::StartsWith;
using testing::TemporaryFolder;

cv::Mat some_numbers(cv::Size size, int type) {
  cv::Mat out(size, type);
  const RandomStream stream(1, "encoded_picture");
  std::uint64_t drawn = 0;
  for (int y = 0; y < out.rows; ++y)
    for (std::size_t k = 0; k < static_cast<std::size_t>(out.cols) * out.elemSize(); ++k)
      out.ptr(y)[k] = static_cast<unsigned char>(stream.uniform(drawn++) * 256);
  return out;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(EncodedPicture, PngHoldsEveryNumber) {
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 3), cv::Size(320, 240)}) {
      const cv::Mat picture = some_numbers(size, type);
      const auto png = png_of(picture);
      ASSERT_TRUE(png.has_value()) << png.error().message;
      EXPECT_THAT(*png, StartsWith("\x89PNG\r\n\x1a\n"));
      EXPECT_TRUE(same(read_png(*png), picture)) << type << ", " << size;
    }
  }
}

TEST(EncodedPicture, PngOfAPartOfAPictureIsThatPart) {
  const cv::Mat whole = some_numbers({20, 10}, CV_16UC1);
  const cv::Mat part = whole(cv::Rect(3, 2, 5, 4));
  const auto png = png_of(part);
  ASSERT_TRUE(png.has_value());
  EXPECT_TRUE(same(read_png(*png), part));
}

TEST(EncodedPicture, PngIsByteForByteTheSame) {
  const cv::Mat picture = some_numbers({64, 48}, CV_8UC1);
  EXPECT_EQ(*png_of(picture), *png_of(picture));
}

TEST(EncodedPicture, TiffHoldsEveryNumber) {
  const TemporaryFolder folder;
  cv::Mat1f picture(5, 7);
  RandomStream(2, "encoded_picture").fill_normal(std::span(picture.ptr<float>(), picture.total()));
  picture += 300;
  picture(1, 2) = std::numeric_limits<float>::quiet_NaN();
  picture(4, 6) = -0.0F;
  for (const cv::Mat1f& shown : {picture, cv::Mat1f(picture(cv::Rect(1, 1, 4, 3)))}) {
    const auto tiff = tiff_of(shown);
    ASSERT_TRUE(tiff.has_value()) << tiff.error().message;
    const auto path = folder.path() / "p.tiff";
    std::ofstream(path, std::ios::binary) << *tiff;
    const auto read = read_picture(path);
    ASSERT_TRUE(read.has_value()) << read.error().message;
    EXPECT_FALSE(read->counts.has_value());
    ASSERT_EQ(read->picture.size(), shown.size());
    for (int y = 0; y < shown.rows; ++y) {
      for (int x = 0; x < shown.cols; ++x) {
        const auto value = static_cast<float>(read->picture(y, x));
        EXPECT_TRUE(value == shown(y, x) || (std::isnan(value) && std::isnan(shown(y, x)))) << y << ' ' << x;
      }
    }
  }
}

TEST(EncodedPicture, OthersAreRefused) {
  EXPECT_EQ(png_of({}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(png_of(cv::Mat1f(3, 3, 1.0F)).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(png_of(cv::Mat(3, 3, CV_16UC3)).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(tiff_of({}).error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
