// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/pixel_formats/pixel_formats.h"

#include <gmock/gmock.h>

#include "acquisition/base/rng.h"
#include "tests/support/parameter_names.h"

namespace todbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Random counts that use every bit of the format.
cv::Mat1w random_picture(PixelFormat format, int width, int height, std::uint64_t seed) {
  const RandomStream random(seed, "pixels");
  const std::uint64_t values = std::uint64_t{1} << significant_bits(format);
  cv::Mat1w picture(height, width);
  std::uint64_t index = 0;
  for (auto& pixel : picture) pixel = static_cast<std::uint16_t>(random.below(values, index++));
  return picture;
}

bool equal(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

std::vector<std::uint16_t> decoded_row(std::vector<std::uint8_t> bytes, PixelFormat format, ByteOrder order,
                                       int width) {
  const auto picture = decode_pixels(bytes, {.format = format, .order = order, .width = width, .height = 1});
  EXPECT_TRUE(picture.has_value());
  return picture ? std::vector<std::uint16_t>(picture->begin(), picture->end()) : std::vector<std::uint16_t>();
}

std::vector<PixelFormat> all_formats() {
  std::vector<PixelFormat> formats;
  for (const auto& facts : pixel_format_table) formats.push_back(facts.format);
  return formats;
}

class EveryPixelFormat : public testing::TestWithParam<PixelFormat> {};

std::string format_name(const testing::TestParamInfo<PixelFormat>& info) {
  return std::string(to_string(info.param));
}
INSTANTIATE_TEST_SUITE_P(PixelFormats, EveryPixelFormat, testing::ValuesIn(all_formats()), format_name);

TEST_P(EveryPixelFormat, DecodesWhatItEncodedForAnySizeOrderAndPadding) {
  const PixelFormat format = GetParam();
  const RandomStream random(7, to_string(format));
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    PixelLayout layout;
    layout.format = format;
    layout.order = random.below(2, 4 * trial) == 0 ? ByteOrder::little_endian : ByteOrder::big_endian;
    layout.width = 1 + static_cast<int>(random.below(40, 4 * trial + 1));
    layout.height = 1 + static_cast<int>(random.below(12, 4 * trial + 2));
    const auto one_row = picture_bytes({.format = format, .width = layout.width, .height = 1});
    ASSERT_TRUE(one_row.has_value());
    if (trial % 2 == 1) layout.row_bytes = *one_row + random.below(9, 4 * trial + 3);
    const cv::Mat1w picture = random_picture(format, layout.width, layout.height, trial);

    const auto bytes = encode_pixels(picture, layout);
    ASSERT_TRUE(bytes.has_value()) << bytes.error().message;
    const auto decoded = decode_pixels(*bytes, layout);

    ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
    EXPECT_EQ(bytes->size(), *picture_bytes(layout));
    EXPECT_TRUE(equal(*decoded, picture)) << layout.width << " x " << layout.height << ", rows of " << layout.row_bytes;
  }
}

TEST_P(EveryPixelFormat, RefusesEveryLengthThatIsTooShort) {
  const PixelLayout layout{.format = GetParam(), .width = 7, .height = 5};
  const std::size_t needed = *picture_bytes(layout);
  const std::vector<std::uint8_t> bytes(needed, 0xa5);

  for (std::size_t length = 0; length < needed; ++length) {
    const auto picture = decode_pixels(std::span(bytes).first(length), layout);
    ASSERT_FALSE(picture.has_value()) << length;
    EXPECT_EQ(picture.error().code, ErrorCode::invalid_input);
  }
  EXPECT_TRUE(decode_pixels(bytes, layout).has_value());
}

TEST_P(EveryPixelFormat, IsFoundByItsCode) {
  EXPECT_EQ(pixel_format_of_pfnc(pfnc_code(GetParam())), GetParam());
}

TEST_P(EveryPixelFormat, KeepsTheCountsOfItsFullScale) {
  const PixelLayout layout{.format = GetParam(), .width = 3, .height = 2};
  const auto full_scale = static_cast<std::uint16_t>((1u << significant_bits(GetParam())) - 1u);
  const cv::Mat1w picture(2, 3, full_scale);

  const auto bytes = encode_pixels(picture, layout);

  ASSERT_TRUE(bytes.has_value());
  EXPECT_TRUE(equal(*decode_pixels(*bytes, layout), picture));
}

TEST(PixelFormats, PutBitsWhereTheNamingConventionsDrawThem) {
  const auto little = ByteOrder::little_endian, big = ByteOrder::big_endian;

  EXPECT_THAT(decoded_row({0x12, 0x34}, PixelFormat::mono8, little, 2), ElementsAre(0x12, 0x34));
  EXPECT_THAT(decoded_row({0x34, 0x12, 0x78, 0x56}, PixelFormat::mono16, little, 2), ElementsAre(0x1234, 0x5678));
  EXPECT_THAT(decoded_row({0x12, 0x34, 0x56, 0x78}, PixelFormat::mono16, big, 2), ElementsAre(0x1234, 0x5678));
  EXPECT_THAT(decoded_row({0x11, 0x80, 0x22, 0x7f}, PixelFormat::yuyv, little, 2), ElementsAre(0x11, 0x22));
}

// The bytes are drawn in PFNC 2.4 (Mono10p, Mono12p) and GigE Vision 1.2 (Mono10Packed, Mono12Packed).
TEST(PixelFormats, PutPackedBitsWhereTheirStandardsDrawThem) {
  const auto order = ByteOrder::little_endian;

  EXPECT_THAT(decoded_row({0x21, 0x43, 0x65}, PixelFormat::mono12p, order, 2), ElementsAre(0x321, 0x654));
  EXPECT_THAT(decoded_row({0x01, 0x08, 0x30, 0x00, 0x01}, PixelFormat::mono10p, order, 4), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(decoded_row({0xff, 0x03, 0x00, 0x00, 0xff}, PixelFormat::mono10p, order, 4),
              ElementsAre(0x3ff, 0, 0, 0x3fc));
  EXPECT_THAT(decoded_row({0xab, 0x6c, 0x45}, PixelFormat::mono12_packed, order, 2), ElementsAre(0xabc, 0x456));
  EXPECT_THAT(decoded_row({0xab, 0x21, 0x45}, PixelFormat::mono10_packed, order, 2), ElementsAre(0x2ad, 0x116));
}

TEST(PixelFormats, KeepBitsThatAFormatDoesNotHaveForTheGateToSee) {
  EXPECT_THAT(decoded_row({0x01, 0xff}, PixelFormat::mono14, ByteOrder::little_endian, 1), ElementsAre(0xff01));
}

TEST(PixelFormats, RefuseToEncodeCountsThatDoNotFit) {
  const auto bytes =
      encode_pixels(cv::Mat1w(1, 2, std::uint16_t{4096}), {.format = PixelFormat::mono12, .width = 2, .height = 1});

  ASSERT_FALSE(bytes.has_value());
  EXPECT_THAT(bytes.error().message, HasSubstr("4096 counts do not fit into Mono12"));
}

TEST(PixelFormats, RefuseImpossibleSizes) {
  for (const PixelLayout& layout :
       {PixelLayout{.width = 0, .height = 5}, PixelLayout{.width = 5, .height = -1},
        PixelLayout{.width = 65536, .height = 5}, PixelLayout{.width = 5, .height = 5, .row_bytes = 9},
        PixelLayout{.width = 5, .height = 5, .row_bytes = std::size_t{1} << 62}}) {
    const auto bytes = picture_bytes(layout);

    ASSERT_FALSE(bytes.has_value());
    EXPECT_EQ(bytes.error().code, ErrorCode::invalid_input);
  }
}

TEST(PixelFormats, KnowTheFourCharacterCodesOfTheKernel) {
  const auto code = [](const char* text) {
    return static_cast<std::uint32_t>(text[0]) | static_cast<std::uint32_t>(text[1]) << 8 |
           static_cast<std::uint32_t>(text[2]) << 16 | static_cast<std::uint32_t>(text[3]) << 24;
  };

  EXPECT_EQ(format_of_fourcc(code("Y16 ")), (FourccFormat{PixelFormat::mono16, ByteOrder::little_endian}));
  EXPECT_EQ(format_of_fourcc(code("Y16 ") | 0x80000000u), (FourccFormat{PixelFormat::mono16, ByteOrder::big_endian}));
  EXPECT_EQ(format_of_fourcc(code("Y14 ")), (FourccFormat{PixelFormat::mono14, ByteOrder::little_endian}));
  EXPECT_EQ(format_of_fourcc(code("GREY"))->format, PixelFormat::mono8);
  EXPECT_EQ(format_of_fourcc(code("YUYV"))->format, PixelFormat::yuyv);
  EXPECT_EQ(format_of_fourcc(code("MJPG")), std::nullopt);
}

TEST(RadiometricRows, AreReadFromTheLowerHalfOfAYuyvFrame) {
  // 256 x 384 YUYV: rows 0 ... 191 for people, 192 ... 383 temperatures of 16 bits.
  const int width = 256, rows = 192;
  const cv::Mat1w luma = random_picture(PixelFormat::yuyv, width, rows, 1);
  const cv::Mat1w kelvin_64 = random_picture(PixelFormat::mono16, width, rows, 2);
  auto frame = *encode_pixels(luma, {.format = PixelFormat::yuyv, .width = width, .height = rows});
  const auto lower = *encode_pixels(kelvin_64, {.format = PixelFormat::mono16, .width = width, .height = rows});
  frame.insert(frame.end(), lower.begin(), lower.end());

  const auto section = section_bytes(frame, 2 * width, {.first = rows, .count = rows});
  ASSERT_TRUE(section.has_value()) << section.error().message;
  const auto counts = decode_pixels(*section, {.format = PixelFormat::mono16, .width = width, .height = rows});

  ASSERT_TRUE(counts.has_value());
  EXPECT_TRUE(equal(*counts, kelvin_64));
}

TEST(RadiometricRows, AreRefusedOutsideTheFrame) {
  const std::vector<std::uint8_t> frame(10 * 8);

  EXPECT_TRUE(section_bytes(frame, 8, {.first = 9, .count = 1}).has_value());
  for (const RowSection& section : {RowSection{9, 2}, RowSection{-1, 2}, RowSection{11, 1}, RowSection{0, 0}}) {
    EXPECT_FALSE(section_bytes(frame, 8, section).has_value());
  }
  EXPECT_FALSE(section_bytes(frame, 0, {.first = 0, .count = 1}).has_value());
}

}  // namespace
}  // namespace todbench
