// What a simulated sensor is: the numbers of a data sheet.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "sim_devices/module/module_plan.h"
#include "sim_devices/scene/scene_motion.h"

namespace todbench {

/// How the display makes a picture of samples.
enum class DisplayReconstruction {
  sample_and_hold,  ///< squares of one sample: what observers assume
  bilinear,         ///< interpolated: the squares averaged over another sample
};
[[nodiscard]] std::string_view to_string(DisplayReconstruction reconstruction);

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
  double turbulence_cn2_m_minus_2_3 = 0;  ///< structure parameter of the air before the lens; 0: none
  double turbulence_path_m = 1000;        ///< along which it acts
  double turbulence_correlation_ms = 0;   ///< of the dance of short frames; 0: every frame is the mean of many
  double optics_transmission = 0.8;       ///< normalised out of the signal: NETD is referred to the scene
  double aberration_sigma_pitch = 0;  ///< Gaussian blur of the lens beyond diffraction, per axis, in detector pitches
  double distortion_percent = 0;      ///< radial, at the corner of the picture: third power; positive: pincushion
  double distortion_r4_percent = 0;   ///< fifth power
  double netd_k = 0.07;               ///< temporal noise per sample
  double noise_correlation = 0;       ///< of a sample's temporal noise in successive exposures
  double fixed_pattern_k = 0;         ///< sd of the fixed offset per detector
  double time_constant_ms = 0;        ///< of the bolometer; 0: a detector without memory
  double exposure_ms = 0;             ///< of a detector that integrates and holds; 0: short against all motion
  double row_time_us = 0;             ///< from the sampling of one row of detectors to that of the next; 0: all at once
  double row_noise_k = 0;             ///< sd of an offset per detector row, new in every exposure
  double column_noise_k = 0;          ///< the same per column
  double dead_pixel_share = 0;        ///< of the detectors; the camera shows the mean of the live neighbours instead
  double defective_pixel_share = 0;   ///< of the detectors: stuck, hot, noisy or blinking (pixel_faults.h), not hidden
  int defect_seed = 1;                ///< says which: of the array, not of the run
  int frames_averaged = 1;            ///< exposures averaged into one frame
  int super_resolution_frames = 0;    ///< exposures, displaced by half a pitch, on a grid twice as fine; multiple of 4
  DisplayReconstruction display = DisplayReconstruction::sample_and_hold;
  double display_blur_samples = 0;  ///< Gaussian blur of the display per axis, in displayed samples
  int microscan = 1;                ///< n: array displaced n x n times per picture, n^2 as many samples, same detectors
  int bits = 14;                    ///< significant bits of a count
  double kelvin_per_count = 0.01;   ///< linear temperature output
  double offset_k = 250;            ///< temperature of count 0
  double frame_rate_hz = 50;
  /// Programs behind the sensor, picture to picture. SensorModel and estimates do not run them.
  std::vector<ModulePlan> modules{};
  double scene_temperature_k = 300;  ///< of the surround; sets the spectral weighting dL/dT

  [[nodiscard]] double ifov_mrad() const { return pitch_um / focal_length_mm; }
  /// Displayed samples per detector pitch and axis.
  [[nodiscard]] int samples_per_pitch() const { return microscan * (super_resolution_frames > 0 ? 2 : 1); }
  /// Exposures that are averaged in each displayed sample.
  [[nodiscard]] int exposures_per_sample() const {
    return frames_averaged * (super_resolution_frames > 0 ? super_resolution_frames / 4 : 1);
  }
  [[nodiscard]] double detector_pitch_ratio() const { return detector_um / pitch_um; }
  bool operator==(const SensorSpec&) const = default;
};

/// `invalid_input` with one sentence for a sensor that cannot exist (negative aperture, detector larger than pitch,
/// zero focal length, ...).
[[nodiscard]] Result<void> validate(const SensorSpec& spec);

}  // namespace todbench
