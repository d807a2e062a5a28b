// SPDX-License-Identifier: GPL-3.0-or-later
// Corrections that a camera does not announce, seen in its pictures: what is seen, and how often it is seen wrongly.
#include "acquisition/core/correction_watch.h"

#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/base/rng.h"
#include "acquisition/recording/raw_recording.h"
#include "tests/support/source_file.h"

namespace todbench {
namespace {

/// A camera with temporal noise, a fixed pattern and a plate of warm squares.
struct Camera {
  double noise = 8;          ///< counts
  double pattern_scale = 8;  ///< counts
  std::uint64_t pattern = 0;
  int level = 7000;
  double contrast = 400;
  std::uint64_t index = 0;

  Frame expose() {
    Frame frame;
    frame.counts.create(120, 160);
    frame.sequence = index;
    const RandomStream temporal = RandomStream(1, "temporal").sub(index), fixed(pattern, "pattern");
    std::uint64_t i = 0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x, ++i) {
        const double warm = x % 40 < 10 && y % 40 < 10 ? contrast : 0;
        const double value = level + warm + noise * temporal.normal(i) + pattern_scale * fixed.normal(i);
        frame.counts(y, x) = static_cast<std::uint16_t>(std::lround(value));
      }
    }
    ++index;
    return frame;
  }
};

/// Shows `count` undisturbed frames and expects that nothing is seen.
void watch_undisturbed(CorrectionWatch& watch, Camera& camera, int count) {
  for (int i = 0; i < count; ++i) EXPECT_EQ(watch.see(camera.expose()), std::nullopt) << i;
}

TEST(CorrectionWatch, SeesNothingInHundredsOfUndisturbedFrames) {
  CorrectionWatch watch({});
  Camera camera;

  watch_undisturbed(watch, camera, 300);
}

TEST(CorrectionWatch, SeesAChangeOfTheFixedPatternByOneAndAHalfStandardDeviationsOfTheNoise) {
  int seen = 0;
  for (std::uint64_t trial = 1; trial <= 50; ++trial) {
    CorrectionWatch watch({});
    Camera camera;
    // A new pattern of the same size differs by sqrt(2) of it: a ratio of sqrt(1 + 1.5^2 / 2) = 1.46.
    camera.pattern_scale = 1.5 * camera.noise / std::sqrt(2.0);
    watch_undisturbed(watch, camera, 20);
    camera.pattern = trial;
    seen += watch.see(camera.expose()) == CorrectionSign::pattern_change ? 1 : 0;
  }

  EXPECT_EQ(seen, 50);
}

TEST(CorrectionWatch, SeesAJumpOfTheLevel) {
  CorrectionWatch watch({});
  Camera camera;
  watch_undisturbed(watch, camera, 20);

  camera.level -= 25;

  EXPECT_EQ(watch.see(camera.expose()), CorrectionSign::level_jump);
  watch_undisturbed(watch, camera, 5);
}

TEST(CorrectionWatch, SeesAShutterOfTheTemperatureOfTheScene) {
  CorrectionWatch watch({});
  Camera camera;
  watch_undisturbed(watch, camera, 20);

  camera.contrast = 0;

  EXPECT_EQ(watch.see(camera.expose()), CorrectionSign::shutter);
}

TEST(CorrectionWatch, TakesThreeEqualFramesForAShutterAndTwoForAStuckTransfer) {
  CorrectionWatch watch({});
  Camera camera;
  watch_undisturbed(watch, camera, 3);

  EXPECT_EQ(watch.see_frozen(), std::nullopt);
  EXPECT_EQ(watch.see_frozen(), CorrectionSign::frozen_picture);
  watch_undisturbed(watch, camera, 3);
  EXPECT_EQ(watch.see_frozen(), std::nullopt);
}

TEST(CorrectionWatch, TakesAnotherSceneForNoCorrection) {
  CorrectionWatch watch({});
  Camera camera;
  watch_undisturbed(watch, camera, 20);

  camera.contrast = -900;
  camera.level += 300;
  watch.scene_changed();

  watch_undisturbed(watch, camera, 20);
}

TEST(CorrectionWatch, TakesAPlateThatTremblesForNoCorrection) {
  CorrectionWatch watch({});
  Camera camera;
  camera.pattern_scale = 0;
  for (int i = 0; i < 200; ++i) {
    Frame frame = camera.expose();
    // The whole picture moves by one pixel every second frame: the edges of the squares, 3 % of the pixels, change.
    if (i % 2 == 1) frame.counts = cv::Mat1w(frame.counts(cv::Rect(1, 0, 159, 120))).clone();
    if (i % 2 == 0) frame.counts = cv::Mat1w(frame.counts(cv::Rect(0, 0, 159, 120))).clone();

    EXPECT_EQ(watch.see(frame), std::nullopt) << i;
  }
}

// What two real cameras of this class send without a correction in between: 100 + 102 frames, one of them of a scene
// with something moving in it.
TEST(CorrectionWatch, SeesNothingInRecordingsOfRealCamerasWithoutCorrection) {
  for (const char* name : {"lepton_a_160x120_u16le.raw", "lepton_b_160x120_u16le.raw"}) {
    const auto recording = open_raw_recording(source_file("tests/golden/real/") + name,
                                              {.width = 160, .height = 120, .significant_bits = 14});
    ASSERT_TRUE(recording.has_value());
    CorrectionWatch watch({});
    for (std::uint64_t i = 0; i < recording->frame_count; ++i) {
      Frame frame;
      frame.counts = recording->read(i)->counts;

      const auto seen = watch.see(frame);
      EXPECT_EQ(seen, std::nullopt) << name << ", frame " << i << ": " << (seen ? to_string(*seen) : "");
    }
  }
}

}  // namespace
}  // namespace todbench
