// SPDX-License-Identifier: GPL-3.0-or-later
// Seek's protocol as pure functions: what bytes mean, which pixels are dead, how a picture is corrected.
#include "acquisition/usb/seek_protocol.h"

#include <gmock/gmock.h>

#include <numeric>
#include <random>

#include "tests/support/parameter_names.h"

namespace todbench {
namespace {

class EverySeekModel : public testing::TestWithParam<SeekModel> {
 protected:
  [[nodiscard]] const SeekGeometry& g() const { return geometry(GetParam()); }
  /// A frame whose word k is k modulo 2^16.
  [[nodiscard]] std::vector<std::uint8_t> counting_frame() const {
    std::vector<std::uint8_t> bytes;
    for (std::size_t k = 0; k < g().frame_words(); ++k) {
      bytes.push_back(static_cast<std::uint8_t>(k & 0xFFU));
      bytes.push_back(static_cast<std::uint8_t>(k >> 8U & 0xFFU));
    }
    return bytes;
  }
};

TEST_P(EverySeekModel, PutsEveryPixelWhereItWasInTheRawFrame) {
  const auto frame = parse_seek_frame(counting_frame(), GetParam());

  ASSERT_TRUE(frame) << frame.error().message;
  ASSERT_EQ(frame->picture.size(), g().picture.size());
  for (int y = 0; y < frame->picture.rows; ++y) {
    for (int x = 0; x < frame->picture.cols; ++x) {
      const int word = (g().picture.y + y) * g().raw_width + g().picture.x + x;
      ASSERT_EQ(frame->picture(y, x), word & 0xFFFF);
    }
  }
}

TEST_P(EverySeekModel, ReadsKindCounterAndTemperatureInTheHeader) {
  const auto frame = parse_seek_frame(counting_frame(), GetParam());

  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->kind, g().kind_word);
  EXPECT_EQ(frame->counter, g().counter_word);
  EXPECT_EQ(frame->temperature_word, g().temperature_word);
}

TEST_P(EverySeekModel, RefusesFramesOfEveryOtherLength) {
  const auto bytes = counting_frame();
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, bytes.size() - 2, bytes.size() - 1}) {
    EXPECT_EQ(parse_seek_frame(std::span(bytes).first(size), GetParam()).error().code, ErrorCode::invalid_input);
  }
  auto longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(parse_seek_frame(longer, GetParam()));
}

TEST_P(EverySeekModel, KnowsTheCounterOfAFrameAsSoonAsItIsThere) {
  const auto bytes = counting_frame();
  const std::size_t enough = 2 * g().counter_word + 2;

  EXPECT_EQ(seek_counter(std::span(bytes).first(enough), GetParam()), g().counter_word);
  EXPECT_EQ(seek_counter(std::span(bytes).first(enough - 1), GetParam()), std::nullopt);
}

TEST_P(EverySeekModel, StaysInsideTheBytesWhateverTheyAre) {
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes(g().frame_bytes());
  for (int k = 0; k < 20; ++k) {
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const auto frame = parse_seek_frame(bytes, GetParam());
    ASSERT_TRUE(frame);
    const SeekDeadPixels dead(frame->picture);
    const cv::Mat1w corrected = corrected_seek_picture(frame->picture, frame->picture, dead);
    ASSERT_EQ(corrected.size(), frame->picture.size());
  }
}

TEST_P(EverySeekModel, BeginsWithThePlatformAndEndsAwake) {
  const auto transfers = seek_initialisation(GetParam());

  ASSERT_FALSE(transfers.empty());
  EXPECT_EQ(transfers.front().request, SeekRequest::target_platform);
  const auto wakes = std::find_if(transfers.rbegin(), transfers.rend(),
                                  [](const auto& t) { return t.request == SeekRequest::set_operation_mode; });
  EXPECT_EQ(wakes->data, (std::vector<std::uint8_t>{1, 0}));
}

INSTANTIATE_TEST_SUITE_P(Every, EverySeekModel, testing::Values(SeekModel::compact, SeekModel::compact_pro),
                         [](const auto& model) { return std::string(to_string(model.param)); });

TEST(SeekProtocol, AsksForThePublishedNumberOfWords) {
  // 208 x 156 = 32448 = 0x7EC0, the bytes that the camera's own software sends.
  EXPECT_EQ(seek_frame_request(SeekModel::compact).data, (std::vector<std::uint8_t>{0xC0, 0x7E, 0, 0}));
}

TEST(SeekProtocol, KnowsCamerasByVendorAndProduct) {
  EXPECT_EQ(seek_model(0x289D, 0x0010), SeekModel::compact);
  EXPECT_EQ(seek_model(0x289D, 0x0011), SeekModel::compact_pro);
  EXPECT_EQ(seek_model(0x289D, 0x0012), std::nullopt);
  EXPECT_EQ(seek_model(0x1E4E, 0x0010), std::nullopt);
}

TEST(SeekDeadPixelsAre, ThoseThatAreZeroOrBelowHalfOfTheMedian) {
  cv::Mat1w calibration(4, 5, std::uint16_t{1000});
  calibration(0, 0) = 0;
  calibration(1, 2) = 499;
  calibration(2, 2) = 500;

  EXPECT_EQ(SeekDeadPixels(calibration).count(), 2U);
}

TEST(SeekDeadPixelsAre, FilledWithTheMeanOfTheirLivingNeighbours) {
  cv::Mat1w calibration(3, 3, std::uint16_t{1000});
  calibration(1, 1) = 0;
  cv::Mat1w picture = (cv::Mat1w(3, 3) << 1, 10, 1, 20, 9999, 30, 1, 43, 1);

  SeekDeadPixels(calibration).fill(picture);

  EXPECT_EQ(picture(1, 1), (10 + 20 + 30 + 43) / 4);
}

TEST(SeekDeadPixelsAre, FilledFromTheRimInwardsInLargeDefects) {
  cv::Mat1w calibration(1, 7, std::uint16_t{1000});
  for (int x = 1; x <= 5; ++x) calibration(0, x) = 0;
  cv::Mat1w picture = (cv::Mat1w(1, 7) << 100, 0, 0, 0, 0, 0, 300);

  SeekDeadPixels(calibration).fill(picture);

  EXPECT_EQ(cv::countNonZero(picture != (cv::Mat1w(1, 7) << 100, 100, 100, 200, 300, 300, 300)), 0);
}

TEST(SeekDeadPixelsAre, FilledFromTheOnlyOneThatLives) {
  cv::Mat1w calibration = cv::Mat1w::zeros(5, 4);
  calibration(2, 1) = 1000;
  cv::Mat1w picture(5, 4, std::uint16_t{0});
  picture(2, 1) = 123;

  const SeekDeadPixels dead(calibration);
  dead.fill(picture);

  EXPECT_EQ(dead.count(), 19U);
  EXPECT_EQ(cv::countNonZero(picture != 123), 0);
}

TEST(SeekDeadPixelsAre, LeftAloneWhenNoPixelLives) {
  cv::Mat1w picture(2, 2, std::uint16_t{7});

  const SeekDeadPixels dead(cv::Mat1w::zeros(2, 2));
  dead.fill(picture);

  EXPECT_EQ(dead.count(), 4U);
  EXPECT_EQ(cv::countNonZero(picture != 7), 0);
}

TEST(SeekDeadPixelsAre, FilledUpToATenthOfThePictureAndTwoPixelsDeep) {
  const cv::Size size(207, 154);
  cv::Mat1w by_design(size, std::uint16_t{8000});
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if ((x + 4 * y) % 15 == 0) by_design(y, x) = 0;
    }
  }
  EXPECT_TRUE(SeekDeadPixels(by_design).check());
  EXPECT_TRUE(SeekDeadPixels(cv::Mat1w(size, std::uint16_t{8000})).check());
  EXPECT_TRUE(SeekDeadPixels().check());

  cv::Mat1w fifth(size, std::uint16_t{8000}), deep = fifth.clone();
  for (int x = 2; x < size.width; x += 5) fifth.col(x).setTo(0);
  deep(cv::Rect(50, 50, 5, 5)).setTo(0);
  for (const cv::Mat1w& calibration : {fifth, deep, cv::Mat1w(cv::Mat1w::zeros(size))}) {
    const auto checked = SeekDeadPixels(calibration).check();
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::calibration);
  }
}

TEST(SeekCorrection, TakesTheOffsetsOfTheShutterAway) {
  const cv::Mat1w shutter = (cv::Mat1w(1, 3) << 0x4000, 0x4010, 0x3FF0);
  const cv::Mat1w picture = (cv::Mat1w(1, 3) << 0x4005, 0x4015, 0x3FF5);

  const cv::Mat1w corrected = corrected_seek_picture(picture, shutter, SeekDeadPixels());

  EXPECT_EQ(cv::countNonZero(corrected != 0x4005), 0);
}

TEST(SeekCorrection, ClipsAndKeepsSaturatedPixelsSaturated) {
  const cv::Mat1w shutter = (cv::Mat1w(1, 4) << 0x4100, 0x3F00, 0xFFFF, 0x0001);
  const cv::Mat1w picture = (cv::Mat1w(1, 4) << 0, 0xFFFF, 0x0001, 0xFFFE);

  const cv::Mat1w corrected = corrected_seek_picture(picture, shutter, SeekDeadPixels());

  EXPECT_EQ(cv::countNonZero(corrected != (cv::Mat1w(1, 4) << 0, 0xFFFF, 0, 0xFFFF)), 0);
}

}  // namespace
}  // namespace todbench
