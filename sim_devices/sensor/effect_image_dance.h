// The dance of short frames behind turbulent air: where one exposure shows what many show in the mean.
#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <vector>

#include "acquisition/core/rng.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Share of the dance's variance that a picture keeps, 0 to 1: angles of arrival remember exp(-t / tau_c), tau_c
/// `turbulence_correlation_ms`, and are averaged over exposure and time constant; the rest of the variance is blur
/// within the picture. 0 for the long exposure.
[[nodiscard]] double dance_share(const SensorSpec& spec);
/// What a lens of this aperture leaves out of the long exposure when its tilt is taken out: 1 in the near field, where
/// it is at least sqrt(lambda L) wide, 1/2 beyond (Fried 1966).
[[nodiscard]] double dance_weight(const SensorSpec& spec);
/// Frequency in cycles per pitch at which the lens ends, at the wavelength of the turbulent path.
[[nodiscard]] double dance_cut_off(const SensorSpec& spec);
/// Of the displacement of an exposure, per axis and in pitches: 6.88 (D / r0)^(5/3) (lambda / (2 pi D))^2 times weight
/// and share (Tatarskii 1961: the difference of phase across the aperture). 0 without turbulence.
[[nodiscard]] double dance_sd_pitch(const SensorSpec& spec);
/// Of successive exposures, 0 to 1.
[[nodiscard]] double dance_correlation(const SensorSpec& spec);

/// Whether short frames would dance.
[[nodiscard]] bool lets_dance(const SensorSpec& spec);
/// A bound on the change of ln S75 when what a detector averages of the dance in time is taken for that of `instant`,
/// the same sensor without: the variance that is blur in one and dance in the other, 12 times over S squared.
[[nodiscard]] double averaged_dance_bound(const SensorSpec& spec, const SensorSpec& instant, double s75_pitch);

/// Displacements of exposures, in pitches: of first order from exposure to exposure, cut off where 1 % is left of its
/// memory, so that every exposure takes bounded work. Immutable.
class ImageDance {
 public:
  /// `spec` as planned.
  explicit ImageDance(const SensorSpec& spec);
  [[nodiscard]] bool still() const { return sd_pitch_ == 0; }
  [[nodiscard]] double sd_pitch() const { return sd_pitch_; }
  /// Of exposure `exposure` of the sequence that `stream` numbers.
  [[nodiscard]] cv::Point2d displacement_pitch(const RandomStream& stream, std::uint64_t exposure) const;

 private:
  double sd_pitch_ = 0;
  std::vector<double> weights_;  ///< of the numbers of this exposure and of those before it; squares sum to 1
};

/// Displacements of the exposures of presentation `index`, in pitches and evenly spread: for estimates
/// without frames. As many as a sample averages.
[[nodiscard]] std::vector<cv::Point2d> spread_dance_pitch(const SensorSpec& spec, std::uint64_t index);
/// Of them, how many an estimate with so many sampling phases per pitch and axis takes at each of its phases, so that
/// its threshold is off by some tenths of a per cent with 8 phases and 1 % with 4. 1 without dance.
[[nodiscard]] int dances_per_phase(const SensorSpec& spec, int phases_per_axis);

}  // namespace todbench
