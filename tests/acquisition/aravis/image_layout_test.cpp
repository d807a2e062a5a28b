// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/image_layout.h"

#include <gtest/gtest.h>

#include <vector>

namespace todbench {
namespace {

constexpr StatedImage image{.format = PixelFormat::mono14, .width = 10, .height = 4, .x_padding = 6, .y_padding = 3};
constexpr std::size_t image_size = 4 * 26 + 3;

std::vector<std::uint8_t> bytes(std::size_t count) {
  return std::vector<std::uint8_t>(count, 7);
}

void append_tail(std::vector<std::uint8_t>& to, std::uint32_t length, ChunkLayout layout) {
  const bool big = layout == ChunkLayout::big_endian;
  for (int k = 0; k < 4; ++k) to.push_back(0xC5);
  for (unsigned k = 0; k < 4; ++k) to.push_back(static_cast<std::uint8_t>(length >> (8 * (big ? 3 - k : k)) & 0xFFU));
}

TEST(ImageBytes, AreExactlyThoseThatAreStated) {
  EXPECT_EQ(row_bytes(image), 26U);
  for (std::size_t count = 0; count < 2 * image_size; ++count) {
    EXPECT_EQ(image_bytes(bytes(count), image, ChunkLayout::none).has_value(), count == image_size) << count;
  }
}

TEST(ImageBytes, OfAnImpossibleImageAreNone) {
  for (const StatedImage& impossible :
       {StatedImage{.width = 0, .height = 4}, StatedImage{.width = 4, .height = -1},
        StatedImage{.width = 4, .height = 4, .x_padding = -1}, StatedImage{.width = 4, .height = 4, .y_padding = -8}}) {
    EXPECT_FALSE(image_bytes(bytes(32), impossible, ChunkLayout::none));
  }
}

class Chunks : public testing::TestWithParam<ChunkLayout> {};

TEST_P(Chunks, TheImageIsTheFirstChunk) {
  auto received = bytes(image_size);
  append_tail(received, image_size, GetParam());
  received.insert(received.end(), {1, 2, 3, 4});
  append_tail(received, 4, GetParam());

  const auto found = image_bytes(received, image, GetParam());

  ASSERT_TRUE(found);
  EXPECT_EQ(found->size(), image_size);
  EXPECT_EQ(found->data(), received.data());
}

TEST_P(Chunks, MayBeFilledUpToAWholeWord) {
  auto received = bytes(108);
  append_tail(received, 108, GetParam());

  EXPECT_TRUE(image_bytes(received, image, GetParam()));
}

TEST_P(Chunks, ThatHoldMoreOrLessThanTheImageAreRefused) {
  for (std::uint32_t held = 0; held < 2 * image_size; ++held) {
    auto received = bytes(held);
    append_tail(received, held, GetParam());

    const bool right = held == image_size || held == 108 || held == 112;

    EXPECT_EQ(image_bytes(received, image, GetParam()).has_value(), right) << held;
  }
}

TEST_P(Chunks, WhoseLengthsDoNotFillWhatCameAreRefused) {
  for (const std::uint32_t length : {0U, 1U, 106U, 108U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    auto received = bytes(image_size);
    append_tail(received, length, GetParam());

    EXPECT_FALSE(image_bytes(received, image, GetParam())) << length;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Chunks, testing::Values(ChunkLayout::big_endian, ChunkLayout::little_endian));

}  // namespace
}  // namespace todbench
