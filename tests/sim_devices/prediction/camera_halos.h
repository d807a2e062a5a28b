// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras with and without a halo, for the search for one.
#pragma once

#include <string>
#include <vector>

#include "tests/sim_devices/prediction/optics_sessions.h"

namespace todbench::test {

inline SensorSpec camera_with_halo(double share, double sigma_pitch) {
  return sensor_with([&](SensorSpec& s) { s.halo_share = share, s.halo_sigma_pitch = sigma_pitch; });
}

struct HaloCamera {
  std::string name;
  SensorSpec camera, twin{};
  double f_number_ratio = 1;
};

/// What else spreads light, or has a pattern.
inline std::vector<HaloCamera> cameras_without_halo() {
  const SensorSpec midwave = sensor_with([](SensorSpec& s) {
    s.pitch_um = 15, s.detector_um = 13.5, s.focal_length_mm = 15 / (47.5 / 36.3);
    s.f_number = 4, s.wavelength_min_um = 3, s.wavelength_max_um = 5;
  });
  const SensorSpec microscan = sensor_with([](SensorSpec& s) { s.microscan = 2; });
  return {
      {"equal", SensorSpec{}},
      {"f/2", sensor_with([](SensorSpec& s) { s.f_number = 2; }), {}, 2},
      {"blur of 0.6 pitch", sensor_with([](SensorSpec& s) { s.aberration_sigma_pitch = 0.6; })},
      {"row noise 70 mK", sensor_with([](SensorSpec& s) { s.row_noise_k = 0.07; })},
      {"column noise 70 mK", sensor_with([](SensorSpec& s) { s.column_noise_k = 0.07; })},
      {"fixed pattern 0.3 K", sensor_with([](SensorSpec& s) { s.fixed_pattern_k = 0.3; })},
      {"noise correlation 0.6", sensor_with([](SensorSpec& s) { s.noise_correlation = 0.6; })},
      {"distortion 2 %", sensor_with([](SensorSpec& s) { s.distortion_percent = 2; })},
      {"MWIR, f/4, 15 um", midwave, midwave},
      {"microscan", microscan, microscan},
  };
}

}  // namespace todbench::test
