// SPDX-License-Identifier: GPL-3.0-or-later
// The noise of recordings, as a user asks for it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::string recordings = source_file("tests/golden/real/");

TEST(NoiseCommand, TellsTheAcuityUnderARealCamerasNoiseFromThatUnderWhiteNoise) {
  const std::string lepton = recordings + "lepton_a_160x120_u16le.raw?width=160&height=120";

  const Ended ended = todbench({"noise", lepton, "--contrast-over-noise", "8", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_THAT(
      keys_of(json),
      UnorderedElementsAre("recording", "unit", "width", "height", "blocks", "block_frames", "frames_repeated",
                           "usable_share", "pixels_left_out", "temporal_noise", "lag1_correlation",
                           "structure_function", "whole_to_successive", "block_noise", "components", "correlation_x",
                           "correlation_y", "observer", "sensor", "byte_order", "verdict", "points"));
  EXPECT_EQ(json["unit"], "counts");
  EXPECT_EQ(json["width"], 160);
  EXPECT_EQ(json["blocks"], 10);  // 100 frames
  ASSERT_EQ(json["points"].size(), 1u);
  const Json& point = json["points"][0];
  const double ratio = point["acuity_ratio"];
  EXPECT_NEAR(ratio, point["s75_white_pitch"].get<double>() / point["s75_pitch"].get<double>(), 1e-9);
  EXPECT_LE(point["acuity_ratio_ci95"][0].get<double>(), ratio);
  EXPECT_GE(point["acuity_ratio_ci95"][1].get<double>(), ratio);
  // Low frequencies disturb triangles of two pitches less than white noise does: r below 1, acuity above.
  EXPECT_LT(point["template_noise_ratio"], 1);
  EXPECT_GT(ratio, 1);
  // Shares add up to r^2.
  const double r = point["template_noise_ratio"];
  double sum = 0;
  for (const char* part : {"pixel_share", "row_share", "column_share", "correlated_share"})
    sum += point[part].get<double>();
  EXPECT_NEAR(sum, r * r, 1e-9);
  // Temporal variance is that of its four components.
  const Json& c = json["components"];
  double variance = 0;
  for (const char* part : {"tvh", "tv", "th", "t"}) variance += std::pow(c[part].get<double>(), 2);
  EXPECT_NEAR(std::sqrt(variance), json["block_noise"].get<double>(), 0.02 * std::sqrt(variance));
}

TEST(NoiseCommand, GivesTemporalNoiseThatNoBlockLengthEntersAndSaysThatItRemembers) {
  const std::string lepton = recordings + "lepton_b_160x120_u16le.raw?width=160&height=120";
  std::vector<double> noise;
  for (const char* block : {"2", "10", "50"}) {
    const Ended ended = todbench({"noise", lepton, "--block-frames", block, "--contrast-over-noise", "28", "--json"});

    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("the noise is correlated in time"));
    const Json json = one_object(ended);
    EXPECT_EQ(json["verdict"], "correlated");
    noise.push_back(json["temporal_noise"]);
    const Json& structure = json["structure_function"];
    EXPECT_EQ(structure["lags"][0], 1);
    EXPECT_EQ(structure["lags"][7], 8);
    EXPECT_EQ(structure["lags"].size(), 64u);
    EXPECT_EQ(structure["values"][0], json["temporal_noise"]);
    // Computed by hand over pixels whose mean square differences at lags 1 and 8 are below four times the median's.
    EXPECT_NEAR(structure["values"][0].get<double>(), 0.834, 0.005);
    EXPECT_NEAR(structure["values"][7].get<double>(), 2.074, 0.01);
    EXPECT_GT(json["lag1_correlation"], 0.85);
    EXPECT_LT(json["points"][0]["memory_acuity_ratio"], 1);
  }
  EXPECT_EQ(noise[0], noise[1]);
  EXPECT_EQ(noise[0], noise[2]);
}

struct Faults {
  double dead_share = 0;  ///< of the pixels: always 0
  double bounce = 0;      ///< standard deviation of an offset of each whole frame
  double jump = 0;        ///< of all frames from the 21st on
};

/// 40 frames of 80 x 60 pixels with white noise of so many counts, cut off above.
std::string white_frames(double level, double sd, double most = 65535, const Faults& faults = {}) {
  std::string frames;
  const RandomStream stream(5, "white recording");
  const RandomStream dead(5, "dead pixels"), bounce(5, "bounce");
  std::vector<float> z(80 * 60);
  for (std::uint64_t frame = 0; frame < 40; ++frame) {
    stream.sub(frame).fill_normal(z);
    const double whole = level + faults.bounce * bounce.normal(frame) + (frame >= 20 ? faults.jump : 0);
    for (std::size_t i = 0; i < z.size(); ++i) {
      const bool lives = dead.uniform(i) >= faults.dead_share;
      const auto count = static_cast<std::uint16_t>(lives ? std::lround(std::min(most, whole + sd * z[i])) : 0);
      frames += {static_cast<char>(count & 255), static_cast<char>(count >> 8)};
    }
  }
  return frames;
}

/// The same frames with counts rounded to multiples of a step, as of a camera that fills its words with zeros.
std::string in_steps(std::string frames, int step) {
  for (std::size_t i = 0; i + 1 < frames.size(); i += 2) {
    const int count = static_cast<unsigned char>(frames[i]) + 256 * static_cast<unsigned char>(frames[i + 1]);
    const int rounded = (count + step / 2) / step * step;
    frames[i] = static_cast<char>(rounded & 255), frames[i + 1] = static_cast<char>(rounded >> 8);
  }
  return frames;
}

TEST(NoiseCommand, StatesTheNoiseOfCountsInStepsWhichItSpreads) {
  const TemporaryFolder folder;
  const std::string file =
      folder.write("padded.raw", in_steps(white_frames(8000, 20), 16)).string() + "?width=80&height=60";

  const Ended ended = todbench({"noise", file, "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  // Noise of 20 counts, rounded to 16.
  EXPECT_NEAR(one_object(ended)["temporal_noise"].get<double>(), std::hypot(20, 16 / std::sqrt(12)), 0.1);
}

TEST(NoiseCommand, StatesNoNoiseOfCountsThatHoldNone) {
  const TemporaryFolder folder;
  const std::string coarse = folder.write("coarse.raw", white_frames(8000, 0.3)).string() + "?width=80&height=60",
                    cut =
                        folder.write("cut.raw", white_frames(4090, 10, 4095)).string() + "?width=80&height=60&bits=12",
                    below = folder.write("below.raw", white_frames(8000, 10, 8005)).string() + "?width=80&height=60",
                    padded = folder.write("padded.raw", in_steps(white_frames(8000, 4.8), 16)).string() +
                             "?width=80&height=60",
                    still = folder.write("still.raw", white_frames(8000, 0)).string() + "?width=80&height=60";

  for (const auto& [file, verdict] : {std::pair{coarse, "too_coarse"},
                                      {coarse + "&kelvin_per_count=0.1&offset_k=-500", "too_coarse"},
                                      {cut, "saturated"},
                                      {below, "saturated"},
                                      {padded, "too_coarse"}}) {
    const Ended ended = todbench({"noise", file, "--contrast-over-noise", "8", "--json"});

    EXPECT_EQ(ended.code, 3) << ended.err;
    const Json json = one_object(ended);
    EXPECT_EQ(json["verdict"], verdict);
    EXPECT_TRUE(json["temporal_noise"].is_null()) << json["temporal_noise"];
    EXPECT_EQ(json["points"].size(), 0u);
    EXPECT_TRUE(json["components"].is_null());
    EXPECT_TRUE(json["block_noise"].is_null());

    const Ended only = todbench({"noise", file, "--components-only", "--json"});
    EXPECT_EQ(only.code, 3) << only.err;
    EXPECT_EQ(one_object(only)["verdict"], verdict);
    EXPECT_TRUE(one_object(only)["variances"]["tvh"].is_null());
  }
  for (const auto& words : {std::vector<std::string>{"noise", still}, {"noise", still, "--components-only"}}) {
    expect_refused(todbench(words), 2, "at least two different frames");
    expect_refused(todbench(words), 2, "39 frames repeat the frame before bit for bit (frozen)");
  }
}

/// Frames of 80 x 60 pixels, each changed by its number.
template <typename Change>
std::string changed_frames(Change change) {
  constexpr std::size_t frame_bytes = std::size_t{2} * 80 * 60;
  std::string frames = white_frames(8000, 5);
  std::string out;
  for (std::size_t k = 0; k * frame_bytes < frames.size(); ++k)
    out += change(k, frames.substr(k * frame_bytes, frame_bytes));
  return out;
}

TEST(NoiseCommand, RefusesFramesThatAreByteSwappedRotatedOrRepeated) {
  const TemporaryFolder folder;
  const auto swapped = [](std::size_t, std::string frame) {
    for (std::size_t i = 0; i < frame.size(); i += 2) std::swap(frame[i], frame[i + 1]);
    return frame;
  };
  // A warm half makes the rows tell where they belong.
  const auto rotated = [](std::size_t k, std::string frame) {
    for (std::size_t i = 0; i < frame.size() / 2; i += 2) frame[i + 1] = static_cast<char>(frame[i + 1] + 1);
    const std::size_t shift = k % 4 == 3 ? std::size_t{2} * 80 * 17 : 0;
    return frame.substr(shift) + frame.substr(0, shift);
  };
  std::vector<std::string> seen;
  const auto repeated = [&](std::size_t k, const std::string& frame) {
    seen.push_back(frame);
    return k >= 30 ? seen[k - 4] : frame;
  };
  for (const auto& [frames, sentence] :
       {std::pair{changed_frames(swapped), "40 of 40 frames have the two bytes of their pixels swapped"},
        {changed_frames(rotated), "10 of 40 frames are oriented or shifted differently from the frames before them"},
        {changed_frames(repeated), "repeat an earlier frame"}}) {
    const std::string file = folder.write("damaged.raw", frames).string() + "?width=80&height=60";
    expect_refused(todbench({"noise", file}), 5, sentence);
    expect_refused(todbench({"noise", file, "--components-only"}), 5, sentence);
  }
}

TEST(NoiseCommand, NamesTheFramesThatAreFrozen) {
  const TemporaryFolder folder;
  std::string last;
  const auto frozen = [&](std::size_t k, const std::string& frame) { return last = k < 5 ? frame : last; };
  const std::string file = folder.write("frozen.raw", changed_frames(frozen)).string() + "?width=80&height=60";

  const Ended ended = todbench({"noise", file, "--contrast-over-noise", "8", "--json"});

  EXPECT_EQ(one_object(ended)["frames_repeated"], 35);
  EXPECT_THAT(ended.err, HasSubstr("35 frames repeat the frame before bit for bit (frozen) and are left out"));
  EXPECT_THAT(ended.err, HasSubstr("the recording has 5 usable frames"));
}

TEST(NoiseCommand, SaysThatCountsOfOneByteDoNotShowTheirByteOrder) {
  const TemporaryFolder folder;
  const std::string low = white_frames(100, 3);
  std::string swapped = low;
  for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
  for (const auto& [frames, byte] : {std::pair{low, "high"}, {swapped, "low"}}) {
    const std::string file = folder.write("low.raw", frames).string() + "?width=80&height=60";
    const std::string copy = (folder.path() / "copy.todrec").string();
    for (const Ended& ended : {todbench({"noise", file, "--contrast-over-noise", "8", "--json"}),
                               todbench({"noise", file, "--components-only", "--json"}),
                               todbench({"record", "file:" + file, "--out", copy, "--force", "--json"})}) {
      EXPECT_EQ(one_object(ended)["byte_order"], "undecided");
      EXPECT_THAT(ended.err, HasSubstr("the " + std::string(byte) + " byte of every count is zero"));
    }
  }
  const std::string usual = folder.write("usual.raw", white_frames(8000, 5)).string() + "?width=80&height=60";
  const Ended ended = todbench({"noise", usual, "--components-only", "--json"});
  EXPECT_EQ(one_object(ended)["byte_order"], "as_stated");
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("byte order")));
}

TEST(RecordCommand, EndsWithFiveForFramesThatAreByteSwappedOrRepeatedAndKeepsThem) {
  const TemporaryFolder folder;
  const auto swapped = [](std::size_t, std::string frame) {
    for (std::size_t i = 0; i < frame.size(); i += 2) std::swap(frame[i], frame[i + 1]);
    return frame;
  };
  const auto same = [](std::size_t, const std::string& frame) { return frame; };
  std::vector<std::string> seen;
  const auto repeated = [&](std::size_t k, const std::string& frame) {
    seen.push_back(frame);
    return k >= 30 ? seen[k - 4] : frame;
  };
  for (const auto& [frames, code, sentence] :
       {std::tuple{changed_frames(swapped), 5, "40 of 40 frames have the two bytes of their pixels swapped"},
        {changed_frames(repeated), 5, "repeat an earlier frame"},
        {changed_frames(same), 0, ""}}) {
    const std::string file = folder.write("frames.raw", frames).string() + "?width=80&height=60";
    const Ended ended =
        todbench({"record", "file:" + file, "--out", (folder.path() / "copy.todrec").string(), "--force", "--json"});

    EXPECT_EQ(ended.code, code) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(sentence));
    EXPECT_EQ(one_object(ended)["frames"], 40);
  }
}

TEST(NoiseCommand, NamesStatementsThatContradictTheFile) {
  const TemporaryFolder folder;
  const std::string around_zero = folder
                                      .write("a.raw", changed_frames([](std::size_t, std::string frame) {
                                               for (std::size_t i = 0; i < frame.size(); i += 2) {
                                                 const int count = static_cast<unsigned char>(frame[i]) +
                                                                   256 * static_cast<unsigned char>(frame[i + 1]);
                                                 const auto less = static_cast<std::uint16_t>(count - 8000);
                                                 frame[i] = static_cast<char>(less & 255);
                                                 frame[i + 1] = static_cast<char>(less >> 8);
                                               }
                                               return frame;
                                             }))
                                      .string() +
                                  "?width=80&height=60";
  const std::string unsigned_frames = folder.write("b.raw", white_frames(8000, 5)).string() + "?width=80&height=60";

  expect_refused(todbench({"noise", around_zero}), 2, "state signed=yes");
  expect_refused(todbench({"noise", around_zero + "&signed=yes&kelvin_per_count=0.01"}), 2, "offset_k");
  EXPECT_EQ(todbench({"noise", around_zero + "&signed=yes", "--contrast-over-noise", "8"}).code, 0);
  expect_refused(todbench({"noise", unsigned_frames + "&bits=10"}), 2, "bits=10 is stated, but a count is 80");
}

TEST(NoiseCommand, TakesEachExposureOnceOfACameraThatSendsItTwice) {
  const TemporaryFolder folder;
  const auto twice = [](std::size_t, const std::string& frame) { return frame + frame; };
  const std::string file = folder.write("twice.raw", changed_frames(twice)).string() + "?width=80&height=60";

  const Ended ended = todbench({"noise", file, "--contrast-over-noise", "8", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("sends each exposure 2 times"));
  EXPECT_NEAR(one_object(ended)["temporal_noise"].get<double>() / std::sqrt(25 + 1.0 / 12), 1, 0.012);
}

TEST(NoiseCommand, FindsNothingWrongWithWhiteNoise) {
  const TemporaryFolder folder;
  const std::string file = folder.write("white.raw", white_frames(8000, 5)).string();

  const Ended ended = todbench({"noise", file + "?width=80&height=60", "--contrast-over-noise", "8", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["verdict"], "ok");
  // 39 differences of 4800 pixels: 0.3 %, four times that; rounding adds 1/12.
  EXPECT_NEAR(json["temporal_noise"].get<double>() / std::sqrt(25 + 1.0 / 12), 1, 0.012);
  EXPECT_NEAR(json["lag1_correlation"].get<double>(), 0, 0.02);
}

TEST(NoiseCommand, TakesTheSamePixelsForAllNumbersWhereAThirdIsDead) {
  const TemporaryFolder folder;
  const std::string file =
      folder.write("dead.raw", white_frames(8000, 5, 65535, {.dead_share = 0.33, .bounce = 5})).string();

  const Ended ended = todbench({"noise", file + "?width=80&height=60", "--contrast-over-noise", "8", "--json"});

  // No window of the observer is without dead pixels: the noise is stated, no acuity.
  EXPECT_EQ(ended.code, 3) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["verdict"], "ok");
  EXPECT_EQ(json["points"].size(), 0u);
  EXPECT_NEAR(json["temporal_noise"].get<double>(), std::sqrt(50), 4 * 0.14 * 5);
  // Of 4800 pixels, four standard deviations of the share.
  EXPECT_NEAR(json["pixels_left_out"].get<double>() / 4800, 0.33, 4 * std::sqrt(0.33 * 0.67 / 4800));
  EXPECT_NEAR(json["usable_share"].get<double>(), 1 - json["pixels_left_out"].get<double>() / 4800, 1e-12);
  EXPECT_THAT(ended.err, HasSubstr("all results exclude them"));
  // The pixels' part is known to 0.3 %, that of 40 whole frames to 11 %: the frames are the same in both.
  const Json& c = json["components"];
  EXPECT_NEAR(c["tvh"].get<double>() / std::sqrt(25 + 1.0 / 12), 1, 0.02);
  EXPECT_NEAR(c["t"].get<double>(), 5, 4 * 5 / std::sqrt(2 * 36.0));
  EXPECT_LT(c["vh"].get<double>(), 0.5);
  const double sum = std::hypot(c["tvh"].get<double>(), c["t"].get<double>());
  EXPECT_NEAR(json["block_noise"].get<double>() / sum, 1, 0.03);
}

TEST(NoiseCommand, TellsABounceOfWholeFramesFromACorrection) {
  const TemporaryFolder folder;
  const auto noise_of = [&](const Faults& faults) {
    const std::string file = folder.write("frames.raw", white_frames(8000, 5, 65535, faults)).string();
    return one_object(todbench({"noise", file + "?width=80&height=60", "--contrast-over-noise", "8", "--json"}));
  };

  const Json bounced = noise_of({.bounce = 10}), corrected = noise_of({.jump = 50});

  // 39 differences of the frames with a memory of one: 14 %.
  EXPECT_NEAR(bounced["temporal_noise"].get<double>(), std::hypot(5, 10), 4 * 0.14 * 10);
  EXPECT_EQ(bounced["blocks"], 4);
  EXPECT_NEAR(corrected["temporal_noise"].get<double>() / std::sqrt(25 + 1.0 / 12), 1, 0.012);
}

TEST(NoiseCommand, SaysThatComponentsKnowNoMemory) {
  const TemporaryFolder folder;
  const std::string white = folder.write("white.raw", white_frames(8000, 5)).string();

  const Ended lepton = todbench({"noise", recordings + "lepton_b_160x120_u16le.raw?width=160&height=120",
                                 "--components-only", "--across-corrections", "--json"}),
              none = todbench({"noise", white + "?width=80&height=60", "--components-only", "--json"});

  ASSERT_EQ(lepton.code, 0) << lepton.err;
  EXPECT_THAT(lepton.err, HasSubstr("correlated in time"));
  ASSERT_EQ(none.code, 0) << none.err;
  EXPECT_EQ(none.err, "");
}

TEST(NoiseCommand, SaysThatTheNoiseOfAComponentsCubeChanges) {
  const TemporaryFolder folder;
  const std::string quiet = white_frames(8000, 2), noisy = white_frames(8000, 8);
  const std::string file =
      folder.write("frames.raw", noisy.substr(0, noisy.size() / 2) + quiet.substr(quiet.size() / 2)).string();

  expect_refused(todbench({"noise", file + "?width=80&height=60", "--components-only"}), 2,
                 "the noise changes within the recording, or the scene moves");

  // The median difference is one of the noisy half.
  const std::string rising =
      folder.write("rising.raw", quiet.substr(0, quiet.size() / 2 - 80 * 60 * 2) + noisy.substr(noisy.size() / 2))
          .string();
  expect_refused(todbench({"noise", rising + "?width=80&height=60", "--components-only"}), 2,
                 "the noise changes within the recording");
  const Ended plain = todbench({"noise", rising + "?width=80&height=60", "--json"});
  EXPECT_EQ(plain.code, 3) << plain.err;
  EXPECT_THAT(plain.err, HasSubstr("the noise changes within the recording"));
  EXPECT_EQ(one_object(plain)["verdict"], "unsteady");
  EXPECT_EQ(one_object(plain)["points"].size(), 0u);
}

TEST(NoiseCommand, RefusesComponentsOfARowOfTelemetry) {
  const TemporaryFolder folder;
  std::string frames;
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    const RandomStream stream = RandomStream(1, "telemetry").sub(frame);
    for (std::uint64_t i = 0; i < 81 * 60; ++i) {
      const double count = i < 80 * 60 ? 8000 + 5 * stream.normal(i) : 65535 * stream.uniform(i);
      const auto word = static_cast<unsigned>(std::lround(count));
      frames += static_cast<char>(word & 0xFFU);
      frames += static_cast<char>(word >> 8U);
    }
  }
  const std::string name = folder.write("telemetry.raw", frames).string() + "?width=60&height=81";

  expect_refused(todbench({"noise", name, "--components-only"}), 2, "row 81 of 81 is no part of the picture");
  const Ended plain = todbench({"noise", name, "--contrast-over-noise", "8", "--json"});
  EXPECT_EQ(plain.code, 0) << plain.err;
  EXPECT_NEAR(one_object(plain)["temporal_noise"].get<double>(), 5, 0.1);
}

TEST(NoiseCommand, WithholdsTheAcuityWhereTheSceneMoved) {
  const Ended ended = todbench({"noise", recordings + "flir_sc660.seq", "--json"});

  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("this is not the noise of the camera"));
  const Json json = one_object(ended);
  EXPECT_EQ(json["verdict"], "scene_moved");
  EXPECT_EQ(json["points"].size(), 0u);
}

TEST(NoiseCommand, RefusesWhatIsNoRecording) {
  expect_refused(todbench({"noise", "none.seq"}), 2, "none.seq");
  expect_refused(todbench({"noise", recordings + "flir_sc660.seq", "--sensor", "nothing"}), 2, "nothing");
  expect_refused(todbench({"noise", recordings + "flir_sc660.seq", "--block-frames", "1"}), 2, "block-frames");
  for (const char* list : {"1,,2", ",2", "2,"})
    expect_refused(todbench({"noise", recordings + "flir_sc660.seq", "--contrast-over-noise", list}), 2, list);
}

}  // namespace
}  // namespace todbench::testing
