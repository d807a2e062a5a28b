// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/moved_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

/// A warm square off the middle before a slow slope, with temporal noise.
cv::Mat1w picture(std::uint64_t frame, cv::Size size, double noise = 5, double structure = 1) {
  cv::Mat1w counts(size);
  const RandomStream stream = RandomStream(3, "moved picture").sub(frame);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool warm = y > size.height / 6 && y < size.height / 3 && x > size.width / 5 && x < size.width / 2;
      const double level = 8000 + structure * (0.5 * y + 0.2 * x + (warm ? 60 : 0));
      const auto index = static_cast<std::uint64_t>(y * size.width + x);
      counts(y, x) = static_cast<std::uint16_t>(std::lround(level + noise * stream.normal(index)));
    }
  }
  return counts;
}

cv::Mat1w rows_shifted(const cv::Mat1w& counts, int shift) {
  if (shift == 0) return counts;
  cv::Mat1w out;
  cv::vconcat(counts.rowRange(shift, counts.rows), counts.rowRange(0, shift), out);
  return out;
}

TEST(MovedPicture, IsSeenWhetherRowsAreShiftedRoundOrTheWholeIsTurnedOrMirrored) {
  const cv::Size size(96, 80);
  for (int kind = 0; kind < 5; ++kind) {
    MovedPicture watch;
    for (std::uint64_t frame = 0; frame < 10; ++frame) ASSERT_FALSE(watch.see(picture(frame, size)));
    const cv::Mat1w right = picture(10, size);
    cv::Mat1w moved;
    if (kind == 0) moved = rows_shifted(right, 33);
    if (kind == 1) moved = rows_shifted(right.t(), 20).t();
    if (kind >= 2) cv::flip(right, moved, kind - 3);

    EXPECT_TRUE(watch.see(moved)) << kind;
    EXPECT_FALSE(watch.see(picture(11, size))) << kind;
  }
}

TEST(MovedPicture, IsSeenInASequenceWhoseEveryFrameBeginsElsewhere) {
  MovedPicture watch;
  int seen = 0;
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    const int shift = static_cast<int>(frame * 17 % 80);
    seen += watch.see(rows_shifted(picture(frame, {96, 80}), shift)) ? 1 : 0;
  }
  EXPECT_GE(seen, 9);  // the reference, and shifts near its own, are no evidence
}

/// 40 recordings of 30 frames; none may be taken for moved. With a rate of 1 % a recording, one is expected in 100.
TEST(MovedPicture, IsNotSeenInFlatOrStructuredNoiseNorWhenTheLevelDrifts) {
  for (int kind = 0; kind < 4; ++kind) {
    for (std::uint64_t recording = 0; recording < 10; ++recording) {
      MovedPicture watch;
      for (std::uint64_t frame = 0; frame < 30; ++frame) {
        cv::Mat1w counts = picture(1000 * recording + frame, {80, 80}, kind == 1 ? 0.3 : 5, kind < 2 ? 0 : 1);
        if (kind == 3) counts += static_cast<int>(frame);
        EXPECT_FALSE(watch.see(counts)) << kind << ", frame " << frame;
      }
    }
  }
}

/// Noise of a third of a step changes few pixels, and a row of telemetry changes by thousands of counts.
TEST(MovedPicture, IsNotSeenInNoiseBelowTheStepOfTheCountsNorInARowOfTelemetry) {
  for (const bool telemetry : {false, true}) {
    for (std::uint64_t recording = 0; recording < 10; ++recording) {
      MovedPicture watch;
      for (std::uint64_t frame = 0; frame < 30; ++frame) {
        cv::Mat1w counts = picture(1000 * recording + frame, {160, 120}, telemetry ? 5 : 8, telemetry ? 1 : 0);
        if (telemetry) {
          const RandomStream words(recording, "telemetry");
          for (int x = 0; x < counts.cols; ++x)
            counts(counts.rows - 1, x) =
                static_cast<std::uint16_t>(65535 * words.sub(frame).uniform(static_cast<std::uint64_t>(x)));
        } else {
          for (std::uint16_t& pixel : counts) pixel = static_cast<std::uint16_t>((pixel + 13) / 40 * 40);
        }
        EXPECT_FALSE(watch.see(counts)) << telemetry << ", recording " << recording << ", frame " << frame;
      }
    }
  }
}

}  // namespace
}  // namespace todbench
