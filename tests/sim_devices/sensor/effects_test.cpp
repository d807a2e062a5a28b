// SPDX-License-Identifier: GPL-3.0-or-later
// The stages behind optics, detector and temporal noise; and the same stages in the estimate without frames.
#include "sim_devices/sensor/effect_row.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/prediction/effect_grid.h"
#include "tests/sim_devices/sensor/effect_scene.h"

namespace todbench {
namespace {

using test::scene;

SensorSpec small(int microscan = 1) {
  SensorSpec spec = test::sensor_with_everything(3, microscan);
  spec.width = 64;
  spec.height = 48;
  spec.turbulence_cn2_m_minus_2_3 = 1e-13;
  spec.turbulence_path_m = 3000;
  spec.exposure_ms = 6;
  spec.row_time_us = 120;
  spec.distortion_percent = -2;
  spec.distortion_r4_percent = 0.5;
  return spec;
}

cv::Mat1f picture(const SensorSpec& spec, const std::vector<Effect>& skip, const std::vector<Effect>& force = {},
                  std::uint64_t index = 5) {
  return SensorModel(spec, full_plan(spec, skip, force, scene().motion), Accuracy::normal(), 1).picture(scene(), index);
}

bool same(const cv::Mat1f& a, const cv::Mat1f& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

std::vector<Effect> effects_with(bool (*wanted)(const EffectRow&)) {
  std::vector<Effect> found;
  for (const Effect effect : all_effects) {
    if (wanted(row_of(effect))) found.push_back(effect);
  }
  return found;
}

/// A sensor whose effects have parameters drawn from their ranges, in the part of them in which cameras are.
SensorSpec drawn_sensor(const RandomStream& stream) {
  SensorSpec spec = small();
  std::uint64_t at = 0;
  do {
    for (const Effect effect : all_effects) {
      const EffectRow& row = row_of(effect);
      if (row.neutralise == nullptr) continue;  // the optics stay those of the sensor
      for (const SensorKey& key : row.keys) {
        const double width = key.range.high - key.range.low;
        if (const auto* number = std::get_if<double SensorSpec::*>(&key.member))
          spec.*(*number) = key.range.low + stream.uniform(at++) * (width > 1e6 ? 0.1 : width / 100);
        if (const auto* whole = std::get_if<int SensorSpec::*>(&key.member))
          spec.*(*whole) = static_cast<int>(key.range.low) + static_cast<int>(stream.below(5, at++));
        if (const auto* display = std::get_if<DisplayReconstruction SensorSpec::*>(&key.member))
          spec.*(*display) =
              stream.below(2, at++) == 0 ? DisplayReconstruction::sample_and_hold : DisplayReconstruction::bilinear;
      }
    }
  } while (!validate(spec));
  return spec;
}

class EveryEffect : public testing::TestWithParam<Effect> {};

TEST_P(EveryEffect, HasARowThatIsWhole) {
  const EffectRow& row = row_of(GetParam());

  EXPECT_FALSE(row.title.empty());
  EXPECT_EQ(effect_from(to_string(GetParam())), GetParam());
  EXPECT_EQ(row.is_neutral == nullptr, row.neutralise == nullptr);
  EXPECT_EQ(row.neutral.empty(), row.neutralise == nullptr);
  EXPECT_TRUE(row.bound != nullptr || !row.always.empty());
  EXPECT_FALSE(row.keys.empty());
  for (const SensorKey& key : row.keys) EXPECT_FALSE(key.meaning.empty()) << key.name;
  const auto* noise = std::get_if<stage::Noise>(&row.stage);
  EXPECT_EQ(noise != nullptr && noise->colour == stage::Colour::coloured, row.coloured_variance != nullptr);
}

INSTANTIATE_TEST_SUITE_P(Effects, EveryEffect, testing::ValuesIn(all_effects),
                         [](const auto& effect) { return std::string(to_string(effect.param)); });

class EffectWithANeutralValue : public testing::TestWithParam<Effect> {};

TEST_P(EffectWithANeutralValue, IsNeutralOnceNeutralised) {
  SensorSpec spec = small();
  row_of(GetParam()).neutralise(spec);

  EXPECT_TRUE(is_neutral(spec, GetParam(), scene().motion));
}

TEST_P(EffectWithANeutralValue, SkippedEqualsItsNeutralValueBitForBit) {
  for (std::uint64_t draw = 0; draw < 4; ++draw) {
    const SensorSpec spec = drawn_sensor(RandomStream(17, to_string(GetParam())).sub(draw));
    SensorSpec neutral = spec;
    row_of(GetParam()).neutralise(neutral);

    EXPECT_TRUE(same(picture(spec, {GetParam()}), picture(neutral, {}, {GetParam()}))) << draw;
  }
}

INSTANTIATE_TEST_SUITE_P(Effects, EffectWithANeutralValue, testing::ValuesIn(effects_with([](const EffectRow& row) {
                           return row.neutralise != nullptr;
                         })),
                         [](const auto& effect) { return std::string(to_string(effect.param)); });

TEST(Effects, EveryOneChangesThePicture) {
  const SensorSpec spec = small(2);
  for (const Effect effect : all_effects) {
    if (is_neutral(spec, effect, scene().motion)) continue;
    // Counts would hide what is far below their step.
    std::vector<Effect> others;
    if (effect != Effect::quantisation) others.push_back(Effect::quantisation);
    std::vector<Effect> skipped = others;
    skipped.push_back(effect);
    EXPECT_FALSE(same(picture(spec, skipped), picture(spec, others))) << to_string(effect);
  }
}

TEST(Effects, LeavingOneOutLeavesTheNoiseOfTheOthers) {
  // What is linear and additive: the difference to the picture without another noise is that noise alone.
  SensorSpec spec = small();
  const std::vector<Effect> plain{Effect::quantisation, Effect::dead_pixels, Effect::display};
  const auto noises =
      effects_with([](const EffectRow& row) { return std::holds_alternative<stage::Noise>(row.stage); });
  ASSERT_GE(noises.size(), 3U);
  for (const Effect out : noises) {
    for (const Effect other : noises) {
      if (out == other) continue;
      const auto skipping = [&](std::vector<Effect> effects) {
        for (const Effect effect : plain) effects.push_back(effect);
        return picture(spec, effects);
      };
      const cv::Mat1f with = skipping({}) - skipping({other});
      const cv::Mat1f without = skipping({out}) - skipping({other, out});
      EXPECT_LT(cv::norm(with, without, cv::NORM_INF), 2e-6) << to_string(out);  // rounding of sums near 3 K
    }
  }
}

TEST(Effects, FramesEqualTheRoundedPictureWithAllStages) {
  const SensorSpec spec = small(2);
  const SensorModel model(spec, full_plan(spec, {}, {}, scene().motion), Accuracy::draft(), 1);

  const cv::Mat1w counts = model.expose(scene(), 5);
  const cv::Mat1f kelvin = model.picture(scene(), 5);

  for (int row = 0; row < counts.rows; ++row) {
    for (int column = 0; column < counts.cols; ++column)
      EXPECT_NEAR(spec.offset_k + spec.kelvin_per_count * counts(row, column) - 300,
                  static_cast<double>(kelvin(row, column)), 1e-4);
  }
}

TEST(Effects, TheQuantiserRoundsHalvesUpAndClipsCountsOnly) {
  SensorSpec spec = test::sc2000();
  spec.kelvin_per_count = 0.25;
  spec.offset_k = 300;
  spec.bits = 8;
  const Quantiser quantiser(spec, 300);

  EXPECT_EQ(quantiser.count(0.125F), 1);
  EXPECT_EQ(quantiser.count(0.124F), 0);
  EXPECT_EQ(quantiser.rounded(-0.125F), 0.0F);
  EXPECT_EQ(quantiser.rounded(-0.126F), -0.25F);
  EXPECT_EQ(quantiser.count(-5), 0);
  EXPECT_EQ(quantiser.count(1000), 255);
  EXPECT_EQ(quantiser.rounded(1000), 1000.0F);
}

TEST(Effects, APictureOfAnotherSignalHasTheSameStages) {
  const SensorSpec spec = small(2);
  const SensorModel model(spec, full_plan(spec, {}, {}, scene().motion), Accuracy::draft(), 1);

  const cv::Mat1f direct = model.picture(*model.unit_signal(scene()), scene().delta_t_k, scene().background_k, 5);

  EXPECT_TRUE(same(direct, model.picture(scene(), 5)));
}

TEST(Effects, TheEstimateWithoutFramesSeesThemInTheirDirection) {
  const SensorSpec plain = test::sc2000();
  TemplateObserver observer({}, triangle_alternatives());
  DirectEstimateOptions options;
  options.accuracy = Accuracy::draft();
  const auto s75 = [&](const SensorSpec& spec, double contrast, SceneMotion motion = {}) {
    options.motion = motion;
    return direct_estimate(spec, full_plan(spec, {}, {}, motion), observer, {contrast}, options).value()[0].s75_pitch;
  };
  SensorSpec averaged = plain, pattern = plain, blurred = plain, moving = plain, super = plain, scanned = plain;
  averaged.frames_averaged = 16;
  pattern.fixed_pattern_k = 0.07;
  blurred.aberration_sigma_pitch = 0.25;
  moving.time_constant_ms = 10;
  super.super_resolution_frames = 64;
  scanned.microscan = 2;
  const double low = s75(plain, 0.23);

  // Published changes of acuity at 0.23 K, read with the same noise: 49.8, -22.2, -8.1 and -10.6 %; here within 5 %.
  EXPECT_NEAR(100 * (low / s75(averaged, 0.23) - 1), 49.8, 5);
  EXPECT_NEAR(100 * (low / s75(pattern, 0.23) - 1), -22.2, 5);
  EXPECT_NEAR(100 * (low / s75(blurred, 0.23) - 1), -8.1, 5);
  const SceneMotion half_a_pitch{.x_mrad_s = 0.5 * plain.ifov_mrad() / 0.01, .y_mrad_s = 0};
  EXPECT_NEAR(100 * (low / s75(moving, 0.23, half_a_pitch) - 1), -10.6, 5);
  // Super-resolution samples as microscan does, and averages sixteen exposures in each sample.
  EXPECT_NEAR(s75(super, 16.9) / s75(scanned, 16.9), 1, 0.02);
  EXPECT_LT(s75(super, 0.23), 0.8 * s75(scanned, 0.23));
}

TEST(PictureMemory, IsRefusedIfTheMachineHasLess) {
  SensorSpec spec = test::sc2000();
  spec.width = spec.height = 16384;
  spec.microscan = 4;
  constexpr double gib = 1 << 30;

  const auto refused = check_picture_memory(spec, 24 * gib);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_NE(refused.error().message.find("pictures of 65536 x 65536 samples need about 160 GiB"), std::string::npos)
      << refused.error().message;
  EXPECT_TRUE(check_picture_memory(test::sc2000(), gib));
}

}  // namespace
}  // namespace todbench
