// SPDX-License-Identifier: GPL-3.0-or-later
// Which rows of a video frame are measured, and how they are read.
#include "acquisition/v4l2/video_layout.h"

#include <gmock/gmock.h>

#include "acquisition/core/control_text.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t code(const char (&text)[5]) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(text[i]) << (8 * i);
  return value;
}
constexpr auto y16 = code("Y16 "), y14 = code("Y14 "), grey = code("GREY"), yuyv = code("YUYV"), mjpg = code("MJPG");

TEST(VideoLayout, PrefersTheFormatWithMostBits) {
  const auto layout =
      choose_layout({{mjpg, 640, 480}, {grey, 640, 512}, {y14, 320, 256}, {y16, 320, 256}}, VideoFamily::plain, {});

  ASSERT_TRUE(layout) << layout.error().message;
  EXPECT_EQ(layout->mode, (VideoMode{y16, 320, 256}));
  EXPECT_EQ(layout->pixel_format, "Mono16");
}

TEST(VideoLayout, ChoosesTheFormatThatIsWanted) {
  const auto layout = choose_layout({{y14, 320, 256}, {y16, 320, 256}}, VideoFamily::plain, {.pixel_format = "Mono14"});

  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->mode.fourcc, y14);
  EXPECT_EQ(layout->significant_bits, 14);
}

TEST(VideoLayout, TemperaturesAreTheLowerHalfOfTheDoubleFrame) {
  const auto layout = choose_layout({{yuyv, 256, 192}, {yuyv, 256, 384}}, VideoFamily::temperature_rows, {});

  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->mode, (VideoMode{yuyv, 256, 384}));
  EXPECT_EQ(layout->picture, cv::Rect(0, 192, 256, 192));
  EXPECT_EQ(layout->kelvin_per_count, 1.0 / 64);
}

TEST(VideoLayout, APictureForPeopleIsNotMeasured) {
  const auto webcam = choose_layout({{yuyv, 640, 480}, {mjpg, 640, 480}}, VideoFamily::plain, {});
  const auto tiny1_without_double = choose_layout({{yuyv, 256, 192}}, VideoFamily::temperature_rows, {});

  ASSERT_FALSE(webcam);
  EXPECT_EQ(webcam.error().code, ErrorCode::not_found);
  EXPECT_THAT(webcam.error().message, HasSubstr("YUYV 640x480"));
  EXPECT_FALSE(tiny1_without_double);
}

TEST(VideoLayout, ALeptonIsReadWithItsTelemetry) {
  const auto layout = choose_layout({{y16, 160, 120}, {y16, 160, 122}, {y16, 80, 60}, {y16, 80, 63}, {yuyv, 160, 120}},
                                    VideoFamily::lepton, {});

  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->mode.height, 122);
  EXPECT_EQ(layout->picture, cv::Rect(0, 0, 160, 120));
  EXPECT_EQ(layout->telemetry_rows, 2);
}

TEST(VideoLayout, OfAPlainCameraHasNoPictureInTheFewRowsThatOneOfTwoSizesHasMore) {
  const auto layout = choose_layout({{y16, 160, 120}, {y16, 160, 122}}, VideoFamily::plain, {});

  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->mode.height, 120);
}

TEST(VideoLayout, OfABosonIsItsPictureAndTelemetryIsCutOffWhereItsSizeIsWanted) {
  const std::vector<VideoMode> modes{{y16, 640, 514}, {y16, 640, 512}, {grey, 640, 512}};

  EXPECT_EQ(choose_layout(modes, VideoFamily::boson, {})->mode, (VideoMode{y16, 640, 512}));
  const auto higher = choose_layout(modes, VideoFamily::boson, {.frame = frame_size_of("640x514")});
  ASSERT_TRUE(higher);
  EXPECT_EQ(higher->mode.height, 514);
  EXPECT_EQ(higher->picture.height, 512);
  EXPECT_EQ(higher->foreign_rows, 2);
  const auto alone = choose_layout({{y16, 320, 258}}, VideoFamily::boson, {});
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->picture.height, 256);
}

TEST(VideoLayout, OfASizeThatIsNotOfferedNamesThoseThatAre) {
  const auto layout = choose_layout({{y16, 640, 512}}, VideoFamily::plain, {.frame = cv::Size(320, 256)});

  ASSERT_FALSE(layout);
  EXPECT_THAT(layout.error().message, HasSubstr("320x256; the camera offers Y16  640x512"));
  EXPECT_FALSE(frame_size_of("640"));
  EXPECT_FALSE(frame_size_of("640x512 "));
  EXPECT_FALSE(frame_size_of("0x512"));
}

TEST(VideoLayout, OfADoubleFrameWithRowsBetweenItsHalvesHasHalvesOf192Rows) {
  const auto layout = choose_layout({{yuyv, 256, 386}}, VideoFamily::temperature_rows, {});

  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->picture, cv::Rect(0, 192, 256, 192));
  EXPECT_EQ(layout->foreign_rows, 2);
}

/// Rows of 16-bit words, low byte first.
std::vector<std::uint8_t> bytes_of(const cv::Mat1w& words) {
  std::vector<std::uint8_t> bytes;
  for (const auto word : words) {
    bytes.push_back(static_cast<std::uint8_t>(word & 255));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  }
  return bytes;
}

/// A double frame: luma above, temperatures near 300 K below, with a warm square in both.
cv::Mat1w double_frame(int between) {
  cv::Mat1w words(384 + between, 256);
  for (int y = 0; y < words.rows; ++y) {
    for (int x = 0; x < words.cols; ++x) {
      const int row = y < 192 ? y : y - 192 - between;
      const bool warm = row > 60 && row < 100 && x > 80 && x < 140;
      const int ripple = (x * 7 + row * 13) % 5;
      words(y, x) = static_cast<std::uint16_t>(y < 192   ? 0x8000 + 90 + ripple + (warm ? 100 : 0)
                                               : row < 0 ? 0
                                                         : 19200 + ripple + (warm ? 900 : 0));
    }
  }
  return words;
}

TEST(VideoFrames, RowsThatAreNoPictureAreLeftOutAboveOrBelow) {
  const auto boson = choose_layout({{y16, 640, 514}}, VideoFamily::boson, {}).value();
  for (const int first : {0, 2}) {
    cv::Mat1w words(514, 640, std::uint16_t{8000});
    words.rowRange(first == 0 ? 512 : 0, first == 0 ? 514 : 2).setTo(3);

    const auto picture = read_video_frame(bytes_of(words), boson);

    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->counts.rows, 512);
    EXPECT_EQ(cv::countNonZero(picture->counts != 8000), 0) << first;
  }
  const auto tiny1 = choose_layout({{yuyv, 256, 386}}, VideoFamily::temperature_rows, {}).value();
  const cv::Mat1w words = double_frame(2);
  EXPECT_EQ(cv::norm(read_video_frame(bytes_of(words), tiny1)->counts, words.rowRange(194, 386), cv::NORM_INF), 0);
}

TEST(VideoFrames, ThatBeginInTheMiddleOfThePictureAreTold) {
  const auto layout = choose_layout({{yuyv, 256, 384}}, VideoFamily::temperature_rows, {}).value();
  const cv::Mat1w words = double_frame(0);

  EXPECT_FALSE(read_video_frame(bytes_of(words), layout)->begins_in_the_middle);
  for (const int shift : {1, 40, 100, 191, 192 + 7, 383}) {
    cv::Mat1w shifted;
    cv::vconcat(words.rowRange(shift, 384), words.rowRange(0, shift), shifted);
    EXPECT_TRUE(read_video_frame(bytes_of(shifted), layout)->begins_in_the_middle) << shift;
  }
}

TEST(VideoLayout, WithoutModesSaysSo) {
  EXPECT_THAT(choose_layout({}, VideoFamily::plain, {}).error().message, HasSubstr("offers none"));
}

TEST(VideoFamilies, AreToldByTheirUsbNumbers) {
  EXPECT_EQ(video_family(0x1e4e, 0x0100), VideoFamily::lepton);
  EXPECT_EQ(video_family(0x0bda, 0x5830), VideoFamily::temperature_rows);
  EXPECT_EQ(video_family(0x09cb, 0x4007), VideoFamily::boson);
  EXPECT_EQ(video_family(0x046d, 0x0825), VideoFamily::plain);
}

TEST(VideoFrames, RowsWithPaddingAreReadWithoutIt) {
  auto layout = choose_layout({{y16, 2, 2}}, VideoFamily::plain, {}).value();
  layout.row_bytes = 6;
  const std::vector<std::uint8_t> bytes{1, 0, 2, 0, 9, 9, 3, 0, 4, 1, 9, 9};

  const auto picture = read_video_frame(bytes, layout);

  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(cv::countNonZero(picture->counts != (cv::Mat1w(2, 2) << 1, 2, 3, 260)), 0);
}

TEST(VideoFrames, BigEndianCountsAreTurned) {
  const auto layout = choose_layout({{y16 | 1U << 31U, 2, 1}}, VideoFamily::plain, {}).value();
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4};

  EXPECT_EQ(read_video_frame(bytes, layout)->counts(0, 1), 0x0304);
}

TEST(VideoFrames, TemperaturesAreReadBelowThePictureLowByteFirst) {
  const auto layout = choose_layout({{yuyv, 2, 4}}, VideoFamily::temperature_rows, {}).value();
  const std::vector<std::uint8_t> bytes{200,  128,  201,  128,  202,  128,  203,  128,
                                        0x10, 0x4A, 0x11, 0x4A, 0x12, 0x4A, 0x13, 0x4B};

  const auto picture = read_video_frame(bytes, layout);

  ASSERT_TRUE(picture);
  EXPECT_EQ(cv::countNonZero(picture->counts != (cv::Mat1w(2, 2) << 0x4A10, 0x4A11, 0x4A12, 0x4B13)), 0);
}

TEST(VideoFrames, WithTooFewBytesAreRefused) {
  const auto layout = choose_layout({{y16, 160, 120}, {y16, 160, 122}}, VideoFamily::lepton, {}).value();

  EXPECT_EQ(read_video_frame(std::vector<std::uint8_t>(2 * 160 * 122 - 1), layout).error().code,
            ErrorCode::invalid_input);
  EXPECT_FALSE(read_video_frame({}, layout));
  EXPECT_TRUE(read_video_frame(std::vector<std::uint8_t>(2 * 160 * 122), layout));
}

TEST(VideoFrames, WithMoreBytesThanRowsAreRefusedUnlessTheDriverFillsPages) {
  auto layout = choose_layout({{y16, 160, 120}}, VideoFamily::plain, {}).value();
  const std::size_t rows = 2 * 160 * 120;

  for (const std::size_t more : {1U, 2U, 120U, 1920U, 2560U})
    EXPECT_FALSE(read_video_frame(std::vector<std::uint8_t>(rows + more), layout)) << more;

  layout.filler_bytes = 2560;
  EXPECT_TRUE(read_video_frame(std::vector<std::uint8_t>(rows + 2560), layout));
  EXPECT_FALSE(read_video_frame(std::vector<std::uint8_t>(rows + 1920), layout));
}

TEST(VideoFrames, WithoutTelemetryInItsRowsAreStillPictures) {
  const auto layout = choose_layout({{y16, 160, 120}, {y16, 160, 122}}, VideoFamily::lepton, {}).value();

  EXPECT_EQ(read_video_frame(std::vector<std::uint8_t>(2 * 160 * 122), layout)->telemetry, std::nullopt);
}

}  // namespace
}  // namespace todbench
