// SPDX-License-Identifier: GPL-3.0-or-later
// Image dance of short exposures through turbulent air: the difference between one exposure and the mean of many.
#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <vector>

#include "acquisition/base/rng.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the share of the variance of the image motion that remains between pictures, 0 to 1. The rest is blur within
/// a picture. Displacements at a time difference t have the correlation exp(-t / `turbulence_correlation_ms`) and are
/// averaged over exposure and time constant. Returns 0 if the sensor uses the long-exposure model.
[[nodiscard]] double dance_share(const SensorSpec& spec);
/// Returns the weight of the tilt that is removed from the long exposure: 1 in the near field (aperture >=
/// sqrt(wavelength x path length)), otherwise 1/2 (Fried 1966); 0 without turbulence.
[[nodiscard]] double dance_weight(const SensorSpec& spec);
/// Returns the cut-off frequency of the lens in cycles per pitch, at the wavelength of the turbulent path.
[[nodiscard]] double dance_cut_off(const SensorSpec& spec);
/// Returns the standard deviation of an exposure's displacement per axis, in pitches along x; 0 without turbulence. The
/// variance is 6.88 (D / r0)^(5/3) (lambda / (2 pi D))^2 x dance_weight() x dance_share() (Tatarskii 1961: phase
/// difference across the lens). D: aperture, r0: Fried's diameter, lambda: wavelength.
[[nodiscard]] double dance_sd_pitch(const SensorSpec& spec);
/// Returns the correlation of the displacements of successive exposures, 0 to 1.
[[nodiscard]] double dance_correlation(const SensorSpec& spec);

/// Returns whether this sensor has image dance.
[[nodiscard]] bool lets_dance(const SensorSpec& spec);
/// Returns the bound on the change of ln S75 that a detector causes by averaging the dance over time. `instant`: the
/// same sensor without this average. The bound is 12 / S75^2 times the variance that the average turns from dance into
/// blur. S75: size with 75 % correct answers, `s75_pitch`.
[[nodiscard]] double averaged_dance_bound(const SensorSpec& spec, const SensorSpec& instant, double s75_pitch);

/// Displacements of the exposures by image dance, in pitches of each axis: a first-order autoregressive process.
/// Correlations below 1 % are set to zero. This limits the work for each exposure. Immutable.
class ImageDance {
 public:
  /// Precondition: `spec` is as_planned().
  explicit ImageDance(const SensorSpec& spec);
  [[nodiscard]] bool still() const { return sd_pitch_ == 0; }
  /// Returns the displacement of exposure `exposure` in the sequence that `stream` numbers.
  [[nodiscard]] cv::Point2d displacement_pitch(const RandomStream& stream, std::uint64_t exposure) const;

 private:
  double sd_pitch_ = 0, aspect_ = 1;
  /// Weights of the random numbers of this exposure and of earlier exposures; the squares sum to 1.
  std::vector<double> weights_;
};

/// Returns evenly spread displacements in pitches of each axis for presentation `index`, for estimates without
/// frames. There is one displacement for each exposure that a sample averages.
[[nodiscard]] std::vector<cv::Point2d> spread_dance_pitch(const SensorSpec& spec, std::uint64_t index);
/// Returns the number of displacements (spread_dance_pitch()) that an estimate uses at each sampling phase; 1 without
/// dance. `phases_per_axis`: sampling phases per pitch and axis. The error of the threshold is then some tenths of a
/// per cent with 8 phases and 1 % with 4 phases.
[[nodiscard]] int dances_per_phase(const SensorSpec& spec, int phases_per_axis);

}  // namespace todbench
