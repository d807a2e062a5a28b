// SPDX-License-Identifier: GPL-3.0-or-later
// Contrast sensitivity of the eye in absolute units. The model is a linear filter H followed by white noise of 1 per
// square degree. docs/method/observer.md names the source of every parameter.
#pragma once

#include "acquisition/base/result.h"

namespace todbench {

/// Parameters of a person's eye. The default values are those of hvs-2.
struct EyeParameters {
  double sensitivity = 1202;            ///< K: d' per unit contrast per degree, detection
  double photon_noise_td = 575;         ///< E0: retinal illuminance at which photon noise equals neural noise
  double inhibition_per_degree = 7.36;  ///< u0: highest frequency of lateral inhibition, cycles per degree
  double critical_cycles = 3.44;        ///< n_c: detection sums over the area pi (n_c / u)^2 at frequency u
  double area_exponent = 0.284;         ///< gamma: growth of the effective area beyond the critical area
  double uncertainty_channels = 500;    ///< M: number of channels among which the person searches for the relevant one
  double contrast_noise = 0.03;         ///< kappa: noise proportional to the response to the target
  double age_years = 30;
  double field_deg2 = 30;  ///< area of the adapting field, from which the pupil size is computed
  bool operator==(const EyeParameters&) const = default;
};

/// Checks the parameters. Error: `invalid_input`, with the name of the parameter that is out of range.
[[nodiscard]] Result<void> validate(const EyeParameters& eye);

/// Returns the d' at which a detector with `channels` equally sensitive channels has 84 % correct answers in a
/// two-alternative forced choice. The detector chooses the largest response (Pelli 1985). The result is 1.41 for one
/// channel and 3.73 for 500 channels. `channels` may be fractional, at least 1. The numerical error is about 1e-6.
[[nodiscard]] double detection_d_prime(double channels);

/// The filter H of an eye adapted to a luminance. Immutable, thread-safe.
class EyeFilter {
 public:
  /// Precondition: validate(eye) succeeds, luminance above 0.
  EyeFilter(const EyeParameters& eye, double luminance_cd_m2);

  [[nodiscard]] double pupil_mm() const { return pupil_mm_; }
  /// Returns H^2 at a frequency in cycles per degree, for detection of a known pattern: d'^2 per squared contrast and
  /// square degree. H^2 is 0 at frequency 0 and from the diffraction limit upwards.
  [[nodiscard]] double detection_power(double frequency_per_degree) const;
  /// Returns H^2 for identification: the detection power times (d'(M) / d'(1))^2, where d'(n) is detection_d_prime(n)
  /// and M is uncertainty_channels. The factor is needed because the parameters were fitted to detection data, which
  /// contain the effect of this uncertainty. An observer model with an explicit search has less uncertainty.
  [[nodiscard]] double identification_power(double frequency_per_degree) const {
    return identification_gain_ * detection_power(frequency_per_degree);
  }
  /// Returns d' of a Gabor pattern of contrast 1 with the Gaussian envelope exp(-r^2 / (2 sigma^2)).
  [[nodiscard]] double gabor_d_prime(double frequency_per_degree, double sigma_deg) const;

 private:
  EyeParameters eye_;
  double pupil_mm_, illuminance_td_, identification_gain_;
};

}  // namespace todbench
