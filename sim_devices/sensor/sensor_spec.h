// SPDX-License-Identifier: GPL-3.0-or-later
// Description of a simulated sensor: the numbers of a data sheet.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/module/module_plan.h"
#include "sim_devices/scene/scene_motion.h"

namespace todbench {

/// Reconstruction of the displayed picture from samples.
enum class DisplayReconstruction {
  sample_and_hold,  ///< squares of one sample, as observers assume
  bilinear,         ///< linear interpolation: the squares averaged over one more sample
};
/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(DisplayReconstruction reconstruction);

/// Axis of the array: along rows or along columns.
enum class PitchAxis { x, y };

/// A staring thermal camera: rectangular detectors on a rectangular lattice. Names state the units. Lengths in pitches
/// are in pitches along x. Positions and displacements in the picture are in pitches of each axis.
struct SensorSpec {
  std::string name;
  std::string description;
  int width = 320, height = 240;  ///< number of detectors
  double pitch_um = 47.5;         ///< between the centres of neighbouring detectors, along x, and along y by default
  double pitch_y_um = 0;          ///< the same along y; 0: pitch_um
  double detector_um = 42.5;      ///< side of the sensitive area along x, and along y by default; at most the pitch
  double detector_y_um = 0;       ///< side of the sensitive area along y; 0: detector_um
  double focal_length_mm = 36.3;
  double f_number = 1;
  double wavelength_min_um = 7.5, wavelength_max_um = 13;
  double turbulence_cn2_m_minus_2_3 = 0;  ///< structure parameter Cn2 of the air; 0: no turbulence
  double turbulence_path_m = 1000;        ///< length of the turbulent path
  double turbulence_correlation_ms = 0;   ///< correlation time of the image dance; 0: every frame is the long exposure
  double optics_transmission = 0.8;       ///< not included in the signal: NETD is referred to the scene
  double aberration_sigma_pitch = 0;  ///< Gaussian blur of the lens beyond diffraction, per axis, in detector pitches
  double halo_share = 0;  ///< share of the light that is spread into a wide Gaussian round every point; 0: no halo
  double halo_sigma_pitch = 0;       ///< sigma of that Gaussian per axis
  double distortion_percent = 0;     ///< radial, third power, at the corner of the picture; positive: pincushion
  double distortion_r4_percent = 0;  ///< radial, fifth power, at the corner
  double netd_k = 0.07;              ///< temporal noise per sample
  double noise_correlation = 0;      ///< correlation of the temporal noise of a sample between successive exposures
  double fixed_pattern_k = 0;        ///< sd of the fixed offset per detector
  double time_constant_ms = 0;       ///< time constant of the bolometer; 0: none
  double exposure_ms = 0;            ///< exposure of a detector that integrates and holds; 0: instantaneous
  double row_time_us = 0;            ///< time between successive rows of detectors; 0: all rows sample at the same time
  double field_delay_ms = 0;         ///< time from the even to the odd rows of an interlaced frame; 0: progressive
  double row_noise_k = 0;            ///< sd of an offset per detector row, new in every exposure
  double column_noise_k = 0;         ///< sd of an offset per detector column, new in every exposure
  double dead_pixel_share = 0;       ///< share of dead detectors; the camera shows the mean of their live neighbours
  /// Share of the detectors that are stuck, hot, noisy or blinking, not hidden (pixel_faults.h).
  double defective_pixel_share = 0;
  int defect_seed = 1;      ///< selects the defective detectors of the array; independent of the run
  int frames_averaged = 1;  ///< exposures averaged into one frame
  /// Exposures, displaced by half a pitch, that form a picture of twice the sampling; a multiple of 4; 0: none.
  int super_resolution_frames = 0;
  DisplayReconstruction display = DisplayReconstruction::sample_and_hold;
  double display_blur_samples = 0;  ///< Gaussian blur of the display per axis, in displayed samples
  /// Strength b of the camera's edge filter, taps -b, 1 + 2 b, -b along each axis, after all noise; 0: none.
  double edge_boost = 0;
  int microscan = 1;               ///< n: n x n displacements per picture, n^2 as many samples
  int bits = 14;                   ///< significant bits of a count
  double kelvin_per_count = 0.01;  ///< linear temperature output
  double offset_k = 250;           ///< temperature of count 0
  double frame_rate_hz = 50;
  /// User's programs after the sensor; each receives a picture and returns a picture. SensorModel and estimates do not
  /// run them.
  std::vector<ModulePlan> modules{};
  double scene_temperature_k = 300;  ///< temperature of the surround; sets the spectral weighting dL/dT

  [[nodiscard]] double pitch_along(PitchAxis axis) const {
    return axis == PitchAxis::y && pitch_y_um > 0 ? pitch_y_um : pitch_um;
  }
  /// Returns the ratio of the pitch along y to the pitch along x.
  [[nodiscard]] double pitch_aspect() const { return pitch_along(PitchAxis::y) / pitch_um; }
  [[nodiscard]] double ifov_mrad(PitchAxis axis = PitchAxis::x) const { return pitch_along(axis) / focal_length_mm; }
  /// Returns the number of displayed samples per detector pitch and axis.
  [[nodiscard]] int samples_per_pitch() const { return microscan * (super_resolution_frames > 0 ? 2 : 1); }
  /// Returns the number of exposures averaged in each displayed sample.
  [[nodiscard]] int exposures_per_sample() const {
    return frames_averaged * (super_resolution_frames > 0 ? super_resolution_frames / 4 : 1);
  }
  [[nodiscard]] double detector_along(PitchAxis axis) const {
    return axis == PitchAxis::y && detector_y_um > 0 ? detector_y_um : detector_um;
  }
  [[nodiscard]] double detector_pitch_ratio(PitchAxis axis = PitchAxis::x) const {
    return detector_along(axis) / pitch_along(axis);
  }
  /// Returns whether lattice and sensitive area are the same along both axes.
  [[nodiscard]] bool square_detector() const {
    return pitch_aspect() == 1 && (detector_y_um == 0 || detector_y_um == detector_um);
  }
  bool operator==(const SensorSpec&) const = default;
};

/// Fails with `invalid_input` for an impossible sensor (negative aperture, detector larger than pitch, zero focal
/// length, ...).
[[nodiscard]] Result<void> validate(const SensorSpec& spec);

/// Fails with `invalid_input` for a sensor with different pitches along x and y, which `task` ("identification") does
/// not support.
[[nodiscard]] Result<void> require_square_pixels(const SensorSpec& spec, std::string_view task);

/// Fails with `invalid_input` if the pictures of a simulated camera need more than `memory_bytes`: one copy in kelvin,
/// one in counts, and the intermediate pictures.
[[nodiscard]] Result<void> check_picture_memory(const SensorSpec& spec, double memory_bytes);

}  // namespace todbench
