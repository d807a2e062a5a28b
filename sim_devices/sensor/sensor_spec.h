// What a simulated sensor is: the numbers of a data sheet.
#pragma once

#include <string>

#include "acquisition/core/result.h"

namespace todbench {

/// A staring thermal camera. Lengths in the unit of the name; square detectors.
struct SensorSpec {
  std::string name;
  std::string description;
  int width = 320, height = 240;  ///< detectors
  double pitch_um = 47.5;         ///< centre to centre
  double detector_um = 42.5;      ///< sensitive side; <= pitch
  double focal_length_mm = 36.3;
  double f_number = 1;
  double wavelength_min_um = 7.5, wavelength_max_um = 13;
  double optics_transmission = 0.8;   ///< normalised out of the signal: NETD is referred to the scene
  double aberration_sigma_pitch = 0;  ///< Gaussian blur of the lens beyond diffraction, per axis, in detector pitches
  double netd_k = 0.07;               ///< temporal noise per sample
  double fixed_pattern_k = 0;         ///< sd of the fixed offset per detector
  int microscan = 1;               ///< n: array displaced n x n times per picture, n^2 as many samples, same detectors
  int bits = 14;                   ///< significant bits of a count
  double kelvin_per_count = 0.01;  ///< linear temperature output
  double offset_k = 250;           ///< temperature of count 0
  double frame_rate_hz = 50;
  double scene_temperature_k = 300;  ///< of the surround; sets the spectral weighting dL/dT

  [[nodiscard]] double ifov_mrad() const { return pitch_um / focal_length_mm; }
  [[nodiscard]] double detector_pitch_ratio() const { return detector_um / pitch_um; }
};

/// `invalid_input` with one sentence for a sensor that cannot exist (negative aperture, detector larger than pitch,
/// zero focal length, ...).
[[nodiscard]] Result<void> validate(const SensorSpec& spec);

}  // namespace todbench
