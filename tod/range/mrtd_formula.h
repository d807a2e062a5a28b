// SPDX-License-Identifier: GPL-3.0-or-later
// MRTD from NETD, transfer functions and three-dimensional noise.
#pragma once

namespace todbench {

/// Standard deviations of the other components of three-dimensional noise, divided by that of tvh (t: time, v: rows, h:
/// columns). A component that is constant across the bars changes bars and spaces equally. The horizontal MRTD
/// therefore does not depend on tv and v, and the vertical MRTD does not depend on th and h.
struct NoiseRatios {
  double vh = 0, th = 0, tv = 0, h = 0, v = 0;
};

/// Parameters of an MRTD formula with the structure of FLIR92. Results differ from those of the program FLIR92. SNR
/// threshold and integration time determine the scale of the MRTD, and depend on the laboratory.
struct MrtdFormula {
  double pitch_mrad = 1;           ///< pitch of the samples, both axes
  double netd_k = 0.1;             ///< noise tvh of one frame
  double frame_rate_hz = 50;       ///< rate of independent frames
  double eye_integration_s = 0.1;  ///< integration time of the eye
  double snr_threshold = 2.5;
  NoiseRatios noise{};
  double noise_filter_sigma_mrad = 0;  ///< sigma of a Gaussian filter after the noise, per axis; 0: no filter
  /// Number of neighbours along either axis that share the fixed offset (vh) of one detector, for example in a
  /// microscan. Temporal noise is independent between these neighbours.
  int samples_per_detector = 1;
};

/// Axis along which the bars are resolved. horizontal: bars along y; vertical: bars along x.
enum class BarAxis { horizontal, vertical };

/// Returns the noise of the four bars after integration by eye and brain, in kelvin. For the horizontal axis it is
///   SNR NETD sqrt(E_t E_w E_L + (vh/tvh)^2 F_w F_L + (th/tvh)^2 E_t E_w + (h/tvh)^2 E_w).
/// For the vertical axis, tv and v replace th and h. Each factor is the share of a noise variance that remains after
/// integration:
/// - E_t: over time, 1 / (frame rate x integration time).
/// - E_w: over the width w = 1 / (2 f) of a bar, where f is the frequency of the bars. It is
///   E_w = 2 p int_0^inf N(u)^2 sinc^2(u w) du,
/// where u is the frequency of the noise, p the pitch of the samples, and N the transfer function of the noise filter.
/// - E_L: over the length of a bar. It is the same integral with 7 w in place of w.
/// - F_w and F_L: as E_w and E_L, but for the fixed offsets (vh). If n samples along an axis share a detector, the n
/// samples have the same offset. The integrand is therefore multiplied by shared_density(n, u p), the spectral density
/// of common offsets. At low frequencies this density is n, so the offsets have the same effect as those of samples at
/// the pitch of the detectors. For n = 1, F_w = E_w and F_L = E_L. Preconditions: all values > 0.
[[nodiscard]] double perceived_noise_k(const MrtdFormula& formula, double frequency_per_mrad, BarAxis axis);

/// Returns the spectral density of noise common to n neighbouring samples, relative to independent samples of the same
/// variance. It is the sum over |k| < n of (1 - |k| / n) cos(2 pi f k), where f is the frequency in cycles per sample.
/// Precondition: n > 0.
[[nodiscard]] double shared_density(int n, double cycles_per_sample);

/// Returns the MRTD: perceived noise / (MTF 8 / pi^2). The factor 8 / pi^2 is the product of 4 / pi, the amplitude of
/// the first harmonic of bars with amplitude 1, and 2 / pi, the mean of a sine over half a period.
/// Precondition: mtf > 0.
[[nodiscard]] double mrtd_k(const MrtdFormula& formula, double frequency_per_mrad, double mtf, BarAxis axis);
/// Returns (pi / 2) perceived noise / modulation at the best phase. With fine sampling the modulation is 4 / pi MTF,
/// and the result is the MRTD. This is a working definition, and results differ from those of the program TRM.
/// Precondition: modulation > 0.
[[nodiscard]] double mtdp_like_k(const MrtdFormula& formula, double frequency_per_mrad, double modulation,
                                 BarAxis axis);

}  // namespace todbench
