// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds of the observer with an eye behind the SC2000.
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "hvs/observer/open_parameters.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// hvs-2 at a display whose samples are `arcmin`, with a background of 50 cd/m2.
TemplateObserverSpec viewer(double arcmin) {
  return {.name = "hvs-2",
          .internal_noise = 0,
          .sensor_noise_factor = 1.75,
          .eye = EyeParameters{},
          .window_margin_arcmin = 6,
          .display = ViewedDisplay{.pixel_pitch_mm = 1000 * 2 * std::tan(arcmin / 120 * std::numbers::pi / 180),
                                   .viewing_distance_m = 1,
                                   .luminance_white_cd_m2 = 100}};
}

std::vector<DirectPoint> estimated(const SensorSpec& sensor, const TemplateObserverSpec& spec,
                                   const std::vector<double>& contrasts, Accuracy accuracy = Accuracy::normal()) {
  TemplateObserver observer(spec, triangle_alternatives());
  const auto points = direct_estimate(sensor, full_plan(sensor, {}, {}), observer, contrasts, {.accuracy = accuracy});
  EXPECT_TRUE(points.has_value()) << points.error().message;
  return points.value_or(std::vector<DirectPoint>(contrasts.size()));
}

TEST(EyeEstimate, HasTheThresholdsOfThePrototype) {
  // A prototype of the model in another language; one run of it scatters by 0.7, 2.3 and 3.9 % at the three contrasts.
  const std::vector<double> contrasts{16.9, 1.93, 0.23};
  const double scatter[] = {0.007, 0.023, 0.039};
  const struct {
    double arcmin;
    double s75_pitch[3];
  } prototype[] = {{1, {3.242, 3.240, 4.452}}, {1.5, {2.426, 2.453, 4.086}}, {2, {2.092, 2.115, 3.816}},
                   {3, {1.827, 1.846, 3.650}}, {4, {1.787, 1.804, 3.604}},   {6, {1.691, 1.721, 3.589}},
                   {9, {1.707, 1.781, 3.679}}};
  double sum[3] = {};
  for (const auto& [arcmin, expected] : prototype) {
    const auto points = estimated(test::sc2000(), viewer(arcmin), contrasts);
    for (std::size_t i = 0; i < contrasts.size(); ++i) {
      const double relative = points[i].standard_error_pitch / points[i].s75_pitch;
      const double difference = points[i].s75_pitch / expected[i] - 1;
      std::printf("%g arcmin, %g K: S75 = %.3f +- %.3f pitch, prototype %.3f\n", arcmin, contrasts[i],
                  points[i].s75_pitch, points[i].standard_error_pitch, expected[i]);
      sum[i] += difference;
      // Three standard errors of both; the prototype's own simulator differs by up to 1.2 % for hvs-1.
      EXPECT_NEAR(difference, 0, 0.012 + 3 * std::hypot(relative, scatter[i])) << arcmin << ' ' << contrasts[i];
    }
  }
  // Each angle is one run of the prototype: a bias would remain in the mean. At 6 arcmin alone S75 is larger at all
  // contrasts (1.2, 2.3 and 1.1 %), at 4 arcmin smaller (3.2 % at 16.9 K), by the scatter of single runs.
  const auto angles = static_cast<double>(std::size(prototype));
  for (std::size_t i = 0; i < contrasts.size(); ++i)
    EXPECT_NEAR(sum[i] / angles, 0, 3 * scatter[i] / std::sqrt(angles)) << contrasts[i];
}

TEST(EyeEstimate, ApproachesTheSamplingLimitOfAPerfectEye) {
  // Without noise of eye and sensor the display's gain no longer matters, and the samples limit.
  TemplateObserverSpec spec = viewer(3);
  spec.sensor_noise_factor = 1;
  spec.eye->contrast_noise = 0;
  spec.eye->sensitivity = 1e7;
  const double limit = estimated(test::sc2000(), spec, {1e4}, Accuracy::draft())[0].s75_pitch;
  spec.display->contrast = 0.05;

  EXPECT_NEAR(estimated(test::sc2000(), spec, {1e4}, Accuracy::draft())[0].s75_pitch, limit, 1e-3 * limit);
  EXPECT_LT(limit, estimated(test::sc2000(), viewer(3), {1e4}, Accuracy::draft())[0].s75_pitch);
}

TEST(EyeEstimate, FallsWithLightContrastAndSampleAngle) {
  const auto at = [](auto change) {
    TemplateObserverSpec spec = viewer(2);
    change(*spec.display);
    return estimated(test::sc2000(), spec, {16.9}, Accuracy::draft())[0].s75_pitch;
  };
  const double usual = at([](ViewedDisplay&) {});
  EXPECT_GT(at([](ViewedDisplay& d) { d.luminance_white_cd_m2 = 5; }), usual);
  EXPECT_GT(at([](ViewedDisplay& d) { d.contrast = 0.1; }), usual);
  EXPECT_GT(at([](ViewedDisplay& d) { d.viewing_distance_m = 2; }), usual);
  EXPECT_GT(at([](ViewedDisplay& d) { d.spot_mm = 0.4 * d.pixel_pitch_mm; }), usual);
}

TEST(EyeEstimate, IsMonotoneInEachOpenParameterSoThatTheEndsHoldAll) {
  for (const double contrast_k : {16.9, 0.23}) {
    const auto of = [&](const TemplateObserverSpec& spec) {
      return estimated(test::sc2000(), spec, {contrast_k}, Accuracy::draft())[0].s75_pitch;
    };
    const TemplateObserverSpec usual = viewer(3);
    const OpenParameterRange range = open_parameter_range(usual).value();
    const double low = of(range.best), middle = of(usual), high = of(range.worst);
    EXPECT_LT(low, middle);
    EXPECT_LT(middle, high);
    // One parameter of the four at one end; estimates of draft accuracy differ by up to 2 %.
    constexpr double scatter = 0.02;
    for (int parameter = 0; parameter < 4; ++parameter) {
      const auto at_end = [&](const TemplateObserverSpec& end) {
        TemplateObserverSpec spec = usual;
        if (parameter == 0) spec.eye->sensitivity = end.eye->sensitivity;
        if (parameter == 1) spec.eye->uncertainty_channels = end.eye->uncertainty_channels;
        if (parameter == 2) spec.eye->contrast_noise = end.eye->contrast_noise;
        if (parameter == 3) spec.sensor_noise_factor = end.sensor_noise_factor;
        return of(spec);
      };
      const double better = at_end(range.best), worse = at_end(range.worst);
      std::printf("%g K, parameter %d: %.3f < %.3f < %.3f\n", contrast_k, parameter, better, middle, worse);
      EXPECT_LT(better, middle * (1 + scatter)) << parameter;
      EXPECT_GT(worse, middle * (1 - scatter)) << parameter;
      EXPECT_GT(better, low * (1 - scatter)) << parameter;
      EXPECT_LT(worse, high * (1 + scatter)) << parameter;
    }
  }
}

}  // namespace
}  // namespace todbench
