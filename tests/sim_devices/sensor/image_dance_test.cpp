// SPDX-License-Identifier: GPL-3.0-or-later
// Short frames behind turbulent air: sharper, displaced, and in the mean the long exposure.
#include "sim_devices/sensor/effect_image_dance.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "sim_devices/atmosphere/turbulence.h"
#include "sim_devices/sensor/effect_turbulence.h"
#include "sim_devices/sensor/sensor_model.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tests/sim_devices/atmosphere/short_exposure.h"
#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

constexpr double pi = std::numbers::pi;

/// A narrow field: 15 um behind 1 m, 0.2 m of aperture, whose lens ends at 0.29 cycles a pitch; the near field ends at
/// 3.9 km.
SensorSpec dancing(double path_m = 2000) {
  SensorSpec spec = test::sc2000();
  spec.width = 24;
  spec.height = 24;
  spec.pitch_um = 15;
  spec.detector_um = 14;
  spec.focal_length_mm = 1000;
  spec.f_number = 5;
  spec.turbulence_cn2_m_minus_2_3 = 4e-13;
  spec.turbulence_path_m = path_m;
  spec.turbulence_correlation_ms = 10;
  return spec;
}

SensorSpec long_exposure(SensorSpec spec) {
  spec.turbulence_correlation_ms = 0;
  return spec;
}

SensorSpec without_noise(SensorSpec spec) {
  spec.netd_k = 0;
  spec.kelvin_per_count = 1e-4;
  return spec;
}

OpticsMtf optics(const SensorSpec& spec) {
  return {spec, full_plan(spec, {}, {}), 16};
}

TEST(ImageDance, TimesTheShortExposureIsTheLongOne) {
  for (const double path_m : {2000.0, 8000.0}) {
    for (const double exposure_ms : {0.0, 5.0, 18.0}) {
      for (const double time_constant_ms : {0.0, 10.0, 12.0}) {
        SensorSpec spec = dancing(path_m);
        spec.exposure_ms = exposure_ms;
        spec.time_constant_ms = time_constant_ms;
        const OpticsMtf still = optics(spec), mean = optics(long_exposure(spec));
        const double sd = dance_sd_pitch(spec);
        for (const double rho : {0.05, 0.1, 0.2, 0.25})
          EXPECT_NEAR(still(rho) * std::exp(-2 * std::pow(pi * sd * rho, 2)), mean(rho), 1e-12) << path_m << " " << rho;
      }
    }
  }
}

// Fried (1966): the exponent times 1 - a (lambda nu / D)^(1/3), a = 1 in the near and 1/2 in the far field.
TEST(ImageDance, OfAnInstantLeavesFriedsShortExposure) {
  for (const auto& [path_m, field] :
       {std::pair(2000.0, PropagationField::near_field), std::pair(8000.0, PropagationField::far_field)}) {
    const SensorSpec spec = dancing(path_m);
    const OpticsMtf still = optics(spec);
    const OpticsMtf calm(spec, full_plan(spec, {Effect::turbulence, Effect::image_dance}, {}), 16);
    for (const double rho : {0.05, 0.2, 0.25}) {
      const auto published = short_exposure_mtf(*turbulent_path(spec), 0.2, field, rho / spec.ifov_mrad());
      ASSERT_TRUE(published);
      EXPECT_NEAR(still(rho) / calm(rho), *published, 1e-10) << path_m << " " << rho;
    }
  }
}

TEST(ImageDance, HasTheVarianceOfThePublishedAngleOfArrival) {
  const SensorSpec spec = dancing();
  const TurbulentPath path = *turbulent_path(spec);
  const double lambda_m = path.wavelength_um * 1e-6, d_m = 0.2;
  const double in_r0 = std::pow(d_m / fried_spherical_m(path), 5.0 / 3) * std::pow(lambda_m / d_m, 2);
  // Tatarskii (1961): D_phase(D) / (k D)^2. Noll's tilt over the aperture is 0.182 in place of 0.1743.
  const double sd_mrad = 1000 * std::sqrt(6.88 / (4 * pi * pi) * in_r0);
  EXPECT_NEAR(dance_sd_pitch(spec) * spec.ifov_mrad(), sd_mrad, 1e-9 * sd_mrad);
  EXPECT_NEAR(sd_mrad / tilt_sd_mrad(path, d_m), 1, 0.022);

  const ImageDance dance(spec);
  const RandomStream stream(3, "sensor.dance");
  constexpr int frames = 40000;
  double squares = 0, successive = 0, across = 0;
  cv::Point2d before = dance.displacement_pitch(stream, 0);
  for (int k = 1; k <= frames; ++k) {
    const cv::Point2d now = dance.displacement_pitch(stream, static_cast<std::uint64_t>(k));
    squares += now.dot(now) / 2;
    successive += now.dot(before) / 2;
    across += now.x * now.y;
    before = now;
  }
  const double variance = squares / frames * spec.ifov_mrad() * spec.ifov_mrad();
  EXPECT_NEAR(variance / (sd_mrad * sd_mrad), 1, 0.03);  // 4 standard errors: 40000 frames of correlation 0.14
  // 50 Hz and a memory of 10 ms.
  EXPECT_NEAR(successive / squares, std::exp(-2.0), 0.02);
  EXPECT_NEAR(across / squares, 0, 0.02);
}

TEST(ImageDance, FramesOfAPresentationDanceTogetherWhereTheAirIsSlow) {
  SensorSpec spec = dancing();
  const auto largest_step = [&](double correlation_ms) {
    spec.turbulence_correlation_ms = correlation_ms;
    const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::draft(), 1);
    double largest = 0;
    for (std::uint64_t k = 1; k < 16; ++k)
      largest = std::max(largest, cv::norm(model.displacements_px(k)[0] - model.displacements_px(k - 1)[0]));
    return largest / dance_sd_pitch(spec);
  };

  EXPECT_LT(largest_step(10000), 0.3);
  EXPECT_GT(largest_step(1), 1.5);
}

// The mean over exposure and time constant of an angle that remembers exp(-t / a), by sums.
TEST(ImageDance, KeepsTheShareThatExposureAndTimeConstantLeave) {
  SensorSpec spec = dancing();
  for (const auto& [exposure_ms, time_constant_ms] :
       {std::pair(15.0, 0.0), std::pair(0.0, 12.0), std::pair(8.0, 4.0), std::pair(8.0, 10.0)}) {
    spec.exposure_ms = exposure_ms;
    spec.time_constant_ms = time_constant_ms;
    // Weights of what was seen so long ago: a box, convolved with a decay.
    constexpr double step_ms = 0.05;
    std::vector<double> weights;
    double sum = 0;
    for (double ago = step_ms / 2; ago < exposure_ms + 14 * time_constant_ms + step_ms; ago += step_ms) {
      double weight = 0;
      if (time_constant_ms == 0) {
        weight = ago < exposure_ms ? 1 : 0;
      } else if (exposure_ms == 0) {
        weight = std::exp(-ago / time_constant_ms);
      } else {
        weight = std::exp(-std::max(0.0, ago - exposure_ms) / time_constant_ms) - std::exp(-ago / time_constant_ms);
      }
      weights.push_back(weight);
      sum += weight;
    }
    // Of first order: the variance of the weighted sum by its recursion.
    const double memory = std::exp(-step_ms / spec.turbulence_correlation_ms);
    double variance = 0, earlier = 0;
    for (const double weight : weights) {
      variance += weight * (weight + 2 * earlier);
      earlier = memory * (earlier + weight);
    }
    EXPECT_NEAR(dance_share(spec), variance / (sum * sum), 2e-4) << exposure_ms << " " << time_constant_ms;
  }
}

TEST(ImageDance, InTheMeanOfManyFramesIsThePictureOfTheLongExposure) {
  for (const int exposures : {1, 3}) {
    SensorSpec spec = without_noise(dancing());
    spec.turbulence_cn2_m_minus_2_3 = 2e-14;
    spec.turbulence_correlation_ms = 2;
    spec.frames_averaged = exposures;
    PlateScene scene;
    scene.plate.name = "one";
    scene.distance_m = 1000;
    scene.plate.triangles = {
        {.name = "only", .position_mm = {3, -2}, .size_mm = 6 * 1000 * spec.ifov_mrad(), .apex = Apex::right}};
    scene.delta_t_k = 1;
    const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
    const SensorModel mean(long_exposure(spec), full_plan(long_exposure(spec), {}, {}), Accuracy::normal(), 1);
    const cv::Mat1f expected = *mean.unit_signal(scene);
    ASSERT_GT(dance_sd_pitch(spec), 0.4);
    EXPECT_GT(cv::norm(*model.unit_signal(scene), expected, cv::NORM_INF), 0.03);

    const int frames = 800 / exposures;
    cv::Mat1d sum(model.size(), 0.0);
    cv::Point2d mean_px{0, 0};
    for (int k = 0; k < frames; ++k) {
      sum += cv::Mat1d(model.picture(scene, static_cast<std::uint64_t>(k)));
      for (const cv::Point2d& moved : model.displacements_px(static_cast<std::uint64_t>(k)))
        mean_px += moved / (frames * exposures);
    }
    // So many frames are not quite where the mean of all is: 4 standard errors. There the pictures are compared.
    EXPECT_LT(std::max(std::abs(mean_px.x), std::abs(mean_px.y)),
              4 * dance_sd_pitch(spec) / std::sqrt(frames * exposures));
    scene.centre_px += mean_px;
    const cv::Mat1f there = *mean.unit_signal(scene);

    EXPECT_LT(cv::norm(sum / frames, cv::Mat1d(there), cv::NORM_INF), 0.02);
    EXPECT_LT(cv::norm(sum / frames, cv::Mat1d(there), cv::NORM_L2) / cv::norm(there, cv::NORM_L2), 0.01);
    EXPECT_GT(cv::norm(model.picture(scene, 0), model.picture(scene, 1), cv::NORM_INF), 0.05);
  }
}

}  // namespace
}  // namespace todbench
