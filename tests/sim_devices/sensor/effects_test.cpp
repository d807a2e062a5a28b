// The stages behind optics, detector and temporal noise; and the same stages in the estimate without frames.
#include <gmock/gmock.h>

#include <cmath>

#include "hvs/shape/gauss_legendre.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/effect_dead_pixels.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_exposure.h"
#include "sim_devices/sensor/effect_motion.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/super_resolution.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tests/sim_devices/prediction/effect_grid.h"

namespace todbench {
namespace {

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

PlateScene scene(double delta_t_k = 3) {
  PlateScene out;
  out.plate.name = "one";
  out.plate.triangles = {{.name = "only", .position_mm = {10, -8}, .size_mm = 9, .apex = Apex::right}};
  out.delta_t_k = delta_t_k;
  out.motion = {.x_mrad_s = 60, .y_mrad_s = -20};
  return out;
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

/// Sum of a picture and the place of its mean.
std::array<double, 3> moments(const cv::Mat1f& picture) {
  double sum = 0, x = 0, y = 0;
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const auto value = static_cast<double>(picture(row, column));
      sum += value, x += value * column, y += value * row;
    }
  }
  return {sum, x / sum, y / sum};
}

// A second way: points spread over the triangle, each moved by the lens and counted by the area that it becomes.
TEST(Effects, DistortionShowsATriangleWhereAndAsLargeAsTheLensDoes) {
  for (const auto& [k1, k2] : {std::pair(6.0, 0.0), std::pair(-6.0, 2.0)}) {
    SensorSpec straight = test::sc2000();
    constexpr int fine = 4;  // samples a pitch: a straight side along the rows aliases at one a pitch
    straight.microscan = fine;
    SensorSpec bent = straight;
    bent.distortion_percent = k1, bent.distortion_r4_percent = k2;
    PlateScene before = scene(1);
    const double mm_per_px = before.distance_m * straight.ifov_mrad();
    before.plate.triangles = {{.name = "far out",
                               .position_mm = {-100 * mm_per_px, 60 * mm_per_px},
                               .size_mm = 20 * mm_per_px,
                               .apex = Apex::up}};
    before.motion = {};
    before.centre_px = {0, 0};
    const auto seen = [&](const SensorSpec& spec) {
      return moments(*SensorModel(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1).unit_signal(before));
    };
    const auto place = [&](cv::Point2d p) {
      const double s = p.dot(p) / 40000;  // half the diagonal of 320 x 240 is 200
      return p * (1 + 0.01 * s * (k1 + s * k2));
    };

    const auto from = seen(straight), to = seen(bent);

    const Polygon outline = triangle(20, Apex::up, {-100, 60});
    double area = 0;
    cv::Point2d middle(0, 0);
    constexpr int steps = 300;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps - i; ++j) {
        const double a = (i + 1.0 / 3) / steps, b = (j + 1.0 / 3) / steps, h = 1e-4;
        const cv::Point2d p = outline[0] + a * (outline[1] - outline[0]) + b * (outline[2] - outline[0]);
        const cv::Point2d dx = (place(p + cv::Point2d(h, 0)) - place(p - cv::Point2d(h, 0))) / (2 * h),
                          dy = (place(p + cv::Point2d(0, h)) - place(p - cv::Point2d(0, h))) / (2 * h);
        const double part = dx.cross(dy);
        area += part, middle += part * place(p);
      }
    }
    middle /= area;
    // Points stand for half of the little triangles: the same share of all, but for 1 / steps of an edge.
    EXPECT_NEAR(to[0] / from[0], area / (0.5 * steps * (steps + 1)), 1e-3) << k1;
    EXPECT_NEAR((to[1] - from[1]) / fine, middle.x + 100, 0.01) << k1;
    EXPECT_NEAR((to[2] - from[2]) / fine, middle.y - 60, 0.01) << k1;
  }
}

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

/// Sums over the pixels of two pictures.
struct Moments {
  double variance = 0, correlation = 0;
};

Moments moments(const cv::Mat1f& a, const cv::Mat1f& b) {
  const double n = static_cast<double>(a.total());
  const double aa = a.dot(a) / n, bb = b.dot(b) / n;
  return {aa, a.dot(b) / n / std::sqrt(aa * bb)};
}

SensorSpec remembering(double rho, int averaged = 1) {
  SensorSpec spec = test::sc2000();
  spec.noise_correlation = rho;
  spec.frames_averaged = averaged;
  return spec;
}

cv::Mat1f noise_of(const SensorSpec& spec, std::uint64_t index) {
  PlateScene still = scene(0);
  still.motion = {};
  return SensorModel(spec, full_plan(spec, {Effect::quantisation}, {}), Accuracy::draft(), 1).picture(still, index);
}

TEST(Effects, NoiseThatRemembersKeepsItsVarianceAndCorrelatesAsFirstOrder) {
  // 76800 pixels: a variance to 0.5 %, a correlation to 0.4 %; four times that.
  for (const double rho : {0.5, 0.8, 0.95}) {
    const SensorSpec spec = remembering(rho);
    const cv::Mat1f first = noise_of(spec, 1000);
    for (const int lag : {1, 2, 8}) {
      const Moments m = moments(first, noise_of(spec, 1000 + static_cast<std::uint64_t>(lag)));

      EXPECT_NEAR(m.variance / std::pow(spec.netd_k, 2), 1, 0.02) << rho;
      EXPECT_NEAR(m.correlation, std::pow(rho, lag), 0.015) << rho << " at lag " << lag;
    }
  }
}

TEST(Effects, AveragingNoiseThatRemembersLeavesTheVarianceThatTheEstimateCountsWith) {
  const SensorSpec spec = remembering(0.8, 4);
  const SensorPlan plan = full_plan(spec, {Effect::quantisation}, {});

  const double variance = moments(noise_of(spec, 3), noise_of(spec, 3)).variance;

  // Of four exposures: (4 + 2 (3 x 0.8 + 2 x 0.64 + 0.512)) / 16.
  EXPECT_NEAR(white_variance_k2(spec, plan, 1) / std::pow(spec.netd_k, 2), (4 + 2 * (2.4 + 1.28 + 0.512)) / 16, 1e-12);
  EXPECT_NEAR(variance / white_variance_k2(spec, plan, 1), 1, 0.02);
}

TEST(Effects, AveragingDividesTemporalAndLineNoiseByTheRootOfTheFrames) {
  SensorSpec spec = test::sc2000();
  spec.row_noise_k = 0.05;
  spec.frames_averaged = 4;
  PlateScene still = scene(0);
  still.motion = {};
  const SensorModel model(spec, full_plan(spec, {Effect::quantisation}, {}), Accuracy::draft(), 1);

  const cv::Mat1f out = model.picture(still, 0);

  cv::Mat1f rows;
  cv::reduce(out, rows, 1, cv::REDUCE_AVG);
  cv::Scalar mean, sd_all, sd_rows;
  cv::meanStdDev(out, mean, sd_all);
  cv::meanStdDev(rows, mean, sd_rows);
  // 240 rows: sd known to 1 / sqrt(480) = 4.6 %; 76 800 samples beside the rows' part.
  EXPECT_NEAR(sd_rows[0], 0.025, 4 * 0.046 * 0.025);
  EXPECT_NEAR(sd_all[0] * sd_all[0] - sd_rows[0] * sd_rows[0], 0.035 * 0.035, 4 * 0.0051 * 0.035 * 0.035);
}

TEST(Effects, DeadDetectorsShowTheMeanOfTheirLiveNeighbours) {
  cv::Mat1f values(3, 3);
  for (int i = 0; i < 9; ++i) values(i / 3, i % 3) = static_cast<float>(i * i);
  cv::Mat1b dead = cv::Mat1b::zeros(3, 3);
  dead(1, 1) = dead(0, 1) = 1;

  replace_dead(values, dead, 1);

  EXPECT_EQ(values(1, 1), (9.0F + 25.0F + 49.0F) / 3);  // left, right, below: above is dead
  EXPECT_EQ(values(0, 1), (0.0F + 4.0F) / 2);
}

TEST(Effects, TheShareOfDeadDetectorsIsTheStatedOne) {
  const cv::Mat1b dead = dead_detectors({320, 240}, 0.01, RandomStream(3, "dead"));
  // 768 expected, binomial sd 27.6.
  EXPECT_NEAR(cv::countNonZero(dead), 768, 4 * 27.6);
}

TEST(Effects, TheDisplayFilterHasTheStatedResponse) {
  SensorSpec spec = test::sc2000();
  spec.display = DisplayReconstruction::bilinear;
  spec.display_blur_samples = 0.3;
  const auto taps = taps_of([&](double f) { return display_response(spec, f); });
  for (const double f : {0.0, 0.1, 0.25, 0.4}) {
    double response = 0;
    for (std::size_t k = 0; k < taps.size(); ++k)
      response += taps[k] * std::cos(2 * std::numbers::pi * f * (static_cast<double>(k) - 8));
    // Cut after eight samples, where taps have fallen to the slope at the band's end over 2 pi^2 k^2: 2e-3 each.
    EXPECT_NEAR(response, display_response(spec, f), 4e-3) << f;
  }
}

TEST(Effects, MotionSmearsAlongItsWayAndLeavesTheCentroid) {
  // exp(-t) behind the target, its mean taken out: variance of the smear squared along the way, none across.
  const double s = 0.7, f = 1e-3;
  const auto h = motion_transfer(f, 0, {s, 0});
  EXPECT_NEAR(std::arg(h), 0, 1e-7);  // third cumulant: 2 (2 pi f s)^3 / 6
  EXPECT_NEAR(std::abs(h), 1 - 2 * std::pow(std::numbers::pi * f * s, 2), 1e-9);
  EXPECT_EQ(motion_transfer(0, f, {s, 0}), std::complex<double>(1, 0));
}

/// A narrow field: 15 um behind 1 m, 0.2 m of aperture.
SensorSpec narrow_field(double cn2) {
  SensorSpec spec = test::sc2000();
  spec.pitch_um = 15;
  spec.detector_um = 14;
  spec.focal_length_mm = 1000;
  spec.f_number = 5;
  spec.turbulence_cn2_m_minus_2_3 = cn2;
  spec.turbulence_path_m = 2000;
  return spec;
}

TEST(Effects, TurbulenceMultipliesTheOpticsByFriedsLongExposure) {
  for (const double cn2 : {1e-15, 1e-14, 1e-13}) {
    const SensorSpec spec = narrow_field(cn2);
    const OpticsMtf with(spec, full_plan(spec, {}, {}), 16);
    const OpticsMtf without(spec, full_plan(spec, {Effect::turbulence}, {}), 16);
    const double wavelength_m = turbulent_path(spec)->wavelength_um * 1e-6;
    const double k = 2 * std::numbers::pi / wavelength_m;
    // Spherical wave, constant Cn2: the weight (z / L)^(5/3) has the mean 3/8 (Fried 1966).
    const double r0_m = std::pow(0.423 * k * k * cn2 * 2000 * 3 / 8, -0.6);
    for (const double per_pitch : {0.05, 0.1, 0.2}) {
      const double cycles_per_rad = per_pitch * 1000 / spec.ifov_mrad();
      EXPECT_NEAR(with(per_pitch),
                  without(per_pitch) * std::exp(-3.44 * std::pow(wavelength_m * cycles_per_rad / r0_m, 5.0 / 3)),
                  1e-12);
    }
  }
}

// A second way: phases along the aperture drawn as sums of waves of random direction whose structure function is
// 6.88 (r / r0)^(5/3), as Kolmogorov's; their mean coherence is the transfer function.
TEST(Effects, TurbulenceIsTheMeanCoherenceOfDrawnPhaseScreens) {
  const SensorSpec spec = narrow_field(2e-14);
  const double wavelength_m = turbulent_path(spec)->wavelength_um * 1e-6;
  const double r0_m = fried_spherical_m(*turbulent_path(spec));
  const OpticsMtf with(spec, full_plan(spec, {Effect::diffraction}, {}), 16);
  constexpr int screens = 2000, waves = 90;
  const std::array separations{0.02, 0.05, 0.1};
  std::array<double, 3> coherence{};
  // Structure function of a plane wave of wave number q and random direction: 2 a^2 (1 - J0(q r)); with powers
  // a^2 = g q^(-5/3) per ln q: 2 g r^(5/3) int x^(-8/3) (1 - J0(x)) dx = 2 g r^(5/3) x 1.1183.
  const double integral = std::pow(2, -5.0 / 3) * 1.2 * std::tgamma(1.0 / 6) / std::tgamma(11.0 / 6) / 2;
  const double g = 6.88 * std::pow(r0_m, -5.0 / 3) / (2 * integral);
  const double lowest = 1e-5, highest = 1e3, step = std::log(highest / lowest) / waves;  // rad/m
  for (int s = 0; s < screens; ++s) {
    const RandomStream random = RandomStream(3, "screens").sub(static_cast<std::uint64_t>(s));
    std::array<double, 3> difference{};
    for (int n = 0; n < waves; ++n) {
      const auto at = static_cast<std::uint64_t>(4 * n);
      const double q = lowest * std::exp(step * (n + random.uniform(at)));
      const double along = q * std::cos(2 * std::numbers::pi * random.uniform(at + 1));
      const double amplitude = std::sqrt(2 * g * std::pow(q, -5.0 / 3) * step);
      const double start = 2 * std::numbers::pi * random.uniform(at + 2);
      for (std::size_t i = 0; i < separations.size(); ++i)
        difference[i] += amplitude * (std::cos(start + along * separations[i]) - std::cos(start));
    }
    for (std::size_t i = 0; i < separations.size(); ++i) coherence[i] += std::cos(difference[i]) / screens;
  }
  for (std::size_t i = 0; i < separations.size(); ++i) {
    const double per_pitch = separations[i] / wavelength_m / 1000 * spec.ifov_mrad();
    // Four standard errors of a mean of cosines, at most 1 / sqrt(2 N).
    EXPECT_NEAR(coherence[i], with(per_pitch), 4 / std::sqrt(2.0 * screens)) << separations[i];
  }
}

TEST(Effects, PicturesThroughTurbulenceAreThoseOfTheInfinitePlane) {
  // Far tails: the same triangle by a lattice and by one twice as long.
  SensorSpec spec = test::sc2000();
  spec.turbulence_cn2_m_minus_2_3 = 1e-11;
  spec.turbulence_path_m = 5000;
  ASSERT_GT(turbulence_strength(spec), 0.5);
  const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::normal());

  const auto plane = chain.infinite_plane(triangle(3, Apex::up), {-4, -4}, 1, {9, 9});

  const cv::Mat1d lattice = chain.image(triangle(3, Apex::up)).sample({-4, -4}, 1, {9, 9});
  EXPECT_LT(cv::norm(plane.values, lattice, cv::NORM_INF), Accuracy::normal().wrap_tolerance);
}

/// A plain sensor of 64 x 48 before the triangle of scene(), and one at rest of which brute force is made.
struct MovingPair {
  SensorSpec spec = test::sc2000();
  PlateScene moving = scene();
  MovingPair() {
    spec.width = 64;
    spec.height = 48;
  }
  [[nodiscard]] cv::Mat1f signal(const PlateScene& shown) const {
    return *SensorModel(spec, full_plan(spec, {}, {}, shown.motion), Accuracy::reference(), 1).unit_signal(shown);
  }
  [[nodiscard]] PlateScene still_at(cv::Point2d moved_px) const {
    PlateScene still = moving;
    still.motion = {};
    still.centre_px += moved_px;
    return still;
  }
};

TEST(Effects, AnExposureIsTheMeanOfWhatIsSeenMeanwhile) {
  MovingPair pair;
  pair.spec.exposure_ms = 20;  // 0.92 and 0.31 pitches
  const cv::Point2d way = exposure_way_pitch(pair.spec, pair.moving.motion);
  ASSERT_NEAR(way.x, 0.917, 1e-3);
  SensorSpec plain = pair.spec;
  plain.exposure_ms = 0;
  const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);
  cv::Mat1d sum(cv::Size(64, 48), 0.0);
  for (const auto& [x, weight] : gauss_legendre(40)) sum += weight / 2 * *still.unit_signal(pair.still_at(x / 2 * way));

  // Single precision and a wrap tolerance of 1.7e-6.
  cv::Mat1d exposed;
  pair.signal(pair.moving).convertTo(exposed, CV_64F);
  EXPECT_LT(cv::norm(exposed, sum, cv::NORM_INF), 1e-5);
  EXPECT_GT(cv::norm(exposed, cv::Mat1d(*still.unit_signal(pair.still_at({0, 0}))), cv::NORM_INF), 0.01);
}

TEST(Effects, RowsThatAreReadOneAfterTheOtherShowTheTargetWhereItIsThen) {
  MovingPair pair;
  pair.spec.row_time_us = 400;
  const cv::Point2d slope = readout_slope(pair.spec, pair.moving.motion);
  SensorSpec plain = pair.spec;
  plain.row_time_us = 0;
  const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);
  const cv::Mat1f by_rows = pair.signal(pair.moving);

  double largest = 0, moved = 0;
  for (int row = 0; row < 48; ++row) {
    const auto then = still.unit_signal(pair.still_at(slope * (row - 23.5)));
    largest = std::max(largest, cv::norm(by_rows.row(row), then->row(row), cv::NORM_INF));
    moved =
        std::max(moved, cv::norm(by_rows.row(row), still.unit_signal(pair.still_at({0, 0}))->row(row), cv::NORM_INF));
  }

  EXPECT_LT(largest, 1e-5);
  EXPECT_GT(moved, 0.01);
}

TEST(Effects, AnEdgeThatIsReadRowByRowLeansByTheSlope) {
  MovingPair pair;
  pair.moving.plate.triangles.clear();
  pair.moving.plate.rectangles = {{.name = "bar", .position_mm = {0, 0}, .size_mm = {40, 40}, .angle_deg = 5}};
  pair.moving.motion = {.x_mrad_s = 330, .y_mrad_s = 0};  // five pitches a frame
  pair.spec.row_time_us = 80;
  const cv::Point2d slope = readout_slope(pair.spec, pair.moving.motion);
  SensorSpec plain = pair.spec;
  plain.row_time_us = 0;
  const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);
  const cv::Mat1f by_rows = pair.signal(pair.moving);

  // Rectangles lean as a whole, their blur does not: a slope of 0.02 changes the width of the blur by its product with
  // the slope of the edge.
  for (int row = 18; row < 30; ++row) {
    const auto then = still.unit_signal(pair.still_at(slope * (row - 23.5)));
    EXPECT_LT(cv::norm(by_rows.row(row), then->row(row), cv::NORM_INF), 0.005) << row;
  }
}

TEST(Effects, TheLagOfTimeConstantAndExposureIsTheirMean) {
  SensorSpec spec = test::sc2000();
  spec.time_constant_ms = 12;
  spec.exposure_ms = 10;
  EXPECT_NEAR(mean_lag_pitch(spec, {.x_mrad_s = 100, .y_mrad_s = 0}).x, 0.1 * 17 / spec.ifov_mrad(), 1e-12);
}

TEST(Effects, SensorsThatExposeOrReadLongerThanAFrameAreRefused) {
  SensorSpec spec = test::sc2000();
  spec.exposure_ms = 20;
  spec.row_time_us = 83;
  EXPECT_TRUE(validate(spec));
  spec.exposure_ms = 20.1;
  EXPECT_FALSE(validate(spec));
  spec.exposure_ms = 0;
  spec.row_time_us = 84;
  EXPECT_FALSE(validate(spec));
}

TEST(Effects, SuperResolutionOfShiftedExposuresIsTheSimulatedPicture) {
  // Four frames displaced by half a pitch, put together by the free function, against the stage of the model.
  SensorSpec spec = test::sc2000();
  spec.width = 64;
  spec.height = 48;
  SensorSpec super = spec;
  super.super_resolution_frames = 4;
  PlateScene still = scene();
  still.motion = {};
  std::vector<cv::Mat1f> frames;
  std::vector<cv::Point2d> shifts;
  const SensorModel plain(spec, full_plan(spec, {}, {}), Accuracy::reference(), 1);
  for (const cv::Point2d shift :
       {cv::Point2d(0.25, 0.25), cv::Point2d(-0.25, 0.25), cv::Point2d(0.25, -0.25), cv::Point2d(-0.25, -0.25)}) {
    PlateScene moved = still;
    moved.centre_px += shift;
    frames.push_back(*plain.unit_signal(moved));
    shifts.push_back(shift);
  }

  const auto put_together = super_resolve(frames, shifts);
  PlateScene fine = still;
  fine.centre_px = 2 * still.centre_px;
  const auto stage = SensorModel(super, full_plan(super, {}, {}), Accuracy::reference(), 1).unit_signal(fine);

  ASSERT_TRUE(put_together.has_value());
  ASSERT_EQ(put_together->picture.size(), stage->size());
  const cv::Rect inside(4, 4, 120, 88);
  // Wrap tolerance 1.7e-6 and single precision.
  EXPECT_LT(cv::norm(put_together->picture(inside), (*stage)(inside), cv::NORM_INF), 5e-6);
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

}  // namespace
}  // namespace todbench
