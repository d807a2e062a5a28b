// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/colour_map.h"

#include <gmock/gmock.h>

#include "bench/gui/presenters/live_feed.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;

TEST(ColourMap, ShowsTheHottestCountWhiteInWhiteHotAndBlackInBlackHot) {
  const cv::Mat1w counts = (cv::Mat1w(1, 3) << 1000, 1500, 2000);

  const QImage white_hot = to_image(counts, {1000, 2000}, ColourMap::white_hot, {});
  const QImage black_hot = to_image(counts, {1000, 2000}, ColourMap::black_hot, {});

  EXPECT_EQ(white_hot.pixel(0, 0), qRgb(0, 0, 0));
  EXPECT_EQ(white_hot.pixel(1, 0), qRgb(128, 128, 128));
  EXPECT_EQ(white_hot.pixel(2, 0), qRgb(255, 255, 255));
  EXPECT_EQ(black_hot.pixel(0, 0), qRgb(255, 255, 255));
}

TEST(ColourMap, MarksSaturatedAndEmptyPixelsInColours) {
  const cv::Mat1w counts = (cv::Mat1w(1, 3) << 0, 8000, 16383);

  const QImage image = to_image(counts, {0, 16383}, ColourMap::white_hot, {.saturated_from = 16383});

  EXPECT_NE(qRed(image.pixel(0, 0)), qBlue(image.pixel(0, 0)));
  EXPECT_EQ(qRed(image.pixel(1, 0)), qBlue(image.pixel(1, 0)));
  EXPECT_NE(qRed(image.pixel(2, 0)), qBlue(image.pixel(2, 0)));
}

TEST(ColourMap, FindsTheLevelOfAPictureWhateverAFewBadPixelsSay) {
  cv::Mat1w counts(100, 100, std::uint16_t{5000});
  counts.rowRange(50, 100) = 5600;
  counts(3, 3) = 0;
  counts(4, 4) = 65535;

  const LevelSpan level = automatic_level(counts, 40);

  EXPECT_EQ(level.low, 5000);
  EXPECT_EQ(level.high, 5600);
}

TEST(ColourMap, CountsEveryPixelInItsHistogramOnce) {
  const cv::Mat1w counts = (cv::Mat1w(1, 5) << 10, 11, 25, 39, 90);

  EXPECT_THAT(histogram(counts, {10, 40}, 3), ElementsAre(2, 1, 2));
}

TEST(ColourMap, RingsAStuckPixelButNoBlurredTriangle) {
  cv::Mat1w counts(20, 20, std::uint16_t{4500});
  counts(5, 5) = 9000;
  // A target smaller than a pixel through optics and detector: a tenth of it reaches the neighbours.
  counts(14, 14) = 6000;
  counts(14, 15) = counts(13, 14) = 4650;

  const auto dead = dead_pixels(counts, 400);

  ASSERT_EQ(dead.size(), 1u);
  EXPECT_EQ(dead.front(), cv::Point(5, 5));
}

Frame frame(std::uint64_t sequence, FrameStatus status) {
  Frame out;
  out.counts = cv::Mat1w(4, 4, static_cast<std::uint16_t>(sequence));
  out.sequence = sequence;
  out.host_time_ns = static_cast<std::int64_t>(sequence) * 20'000'000;
  out.status = status;
  out.scale = std::make_shared<const RadiometricScale>();
  return out;
}

TEST(LiveFeed, CountsWhatItShowsAndWhatItDoesNot) {
  LiveFeed feed;
  SourceInfo info;
  info.width = info.height = 4;
  feed.open(info);

  for (const std::uint64_t sequence : {1, 2, 3}) feed.put(frame(sequence, FrameStatus::complete));
  feed.put(frame(4, FrameStatus::incomplete));
  feed.put(frame(7, FrameStatus::complete));
  const auto latest = feed.take();

  ASSERT_TRUE(latest);
  EXPECT_EQ(latest->frame.sequence, 7u);
  EXPECT_EQ(latest->counters.good, 3u);
  EXPECT_EQ(latest->counters.rejected.at("incomplete"), 1u);
  EXPECT_EQ(latest->counters.rejected.at("gapped"), 1u);  // shown, though
  EXPECT_EQ(latest->counters.lost, 2u);
  // Five frames from 20 ms to 140 ms: four periods in 0.12 s.
  EXPECT_NEAR(latest->counters.rate_hz, 4 / 0.12, 1e-9);
  EXPECT_FALSE(feed.take());
}

}  // namespace
}  // namespace todbench
