// The noise of recordings, as a user asks for it.
#include <cmath>

#include "tests/support/source_file.h"
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
  EXPECT_THAT(keys_of(json), UnorderedElementsAre("recording", "unit", "width", "height", "blocks", "block_frames",
                                                  "usable_share", "temporal_noise", "components", "correlation_x",
                                                  "correlation_y", "observer", "sensor", "verdict", "points"));
  EXPECT_EQ(json["verdict"], "ok");
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
  EXPECT_NEAR(std::sqrt(variance), json["temporal_noise"].get<double>(), 0.02 * std::sqrt(variance));
}

TEST(NoiseCommand, WithholdsTheAcuityWhereTheSceneMoved) {
  const Ended ended = todbench({"noise", recordings + "flir_sc660.seq", "--json"});

  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("this is not the camera's noise"));
  const Json json = one_object(ended);
  EXPECT_EQ(json["verdict"], "scene_moved");
  EXPECT_EQ(json["points"].size(), 0u);
}

TEST(NoiseCommand, RefusesWhatIsNoRecording) {
  expect_refused(todbench({"noise", "none.seq"}), 2, "none.seq");
  expect_refused(todbench({"noise", recordings + "flir_sc660.seq", "--sensor", "nothing"}), 2, "nothing");
  expect_refused(todbench({"noise", recordings + "flir_sc660.seq", "--block-frames", "1"}), 2, "block-frames");
}

}  // namespace
}  // namespace todbench::testing
