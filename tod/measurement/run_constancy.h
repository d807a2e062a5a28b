// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the camera stayed the same during a run and whether a picture shows the present target: figures with
// limits from the averages that measure the contrasts. Pure functions of the run's records.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/measurement/contrast_error.h"

namespace todbench {

/// Noise of a pixel in the average of one set-up and contrast.
struct PictureNoise {
  double set_delta_t_k = 0;
  double noise_k = 0;                        ///< from differences of successive frames; above 0
  std::optional<double> lag1_correlation{};  ///< empty: too few frames
  int frames = 16;                           ///< of the average, at least 2
  int lines = 120;                           ///< smaller number of rows and columns
  /// If the contrast is measured in grey levels, noise_k is noise over contrast, times the contrast of the target:
  /// number of large triangles (at least 2) and standard deviation of one of them, relative to their mean. 0: kelvin.
  int triangles = 0;
  double triangle_scatter = 0;
};

/// Residue of the previous picture in the first frame of an average.
struct PictureResidue {
  double share = 0;  ///< of the difference between the previous picture and this one; 0: no residue
  double limit = 0;  ///< above it, the picture was still changing
};

/// Further results of the averages of a run.
struct RunConstancy {
  std::vector<PictureNoise> noise;          ///< in the order of the run
  std::optional<PictureResidue> residue{};  ///< largest share relative to its limit; empty: no picture differed enough
};

/// A figure and the limit beyond which it is a finding.
struct ConstancyFigure {
  double value = 0;
  double limit = 0;
  [[nodiscard]] bool beyond() const { return value > limit || value < -limit; }
};

/// Standard uncertainty of the ratio of the observed contrasts of two groups of set-ups: if the simulated camera is not
/// as sharp as the real one, the estimator's response differs by up to 2 % between plates of different sizes.
inline constexpr double transfer_systematic_u = 0.01;
/// Probability of a false alarm of transfer_change() over a whole run.
inline constexpr double transfer_false_alarm = 0.005;

/// Relative change of the signal transfer between the first set-ups and the later ones, at the division of the run at
/// which it is largest in units of its error. A set-up with several contrasts contributes the difference of its extreme
/// ones, triangle by triangle: fixed pattern, row and column noise cancel. For a set-up with one contrast, the error
/// includes a pattern common to its triangles, as large as the scatter of one triangle. A set-up whose contrasts span
/// less than half of the widest span is left out. The error contains the pooled scatter of the triangles within the
/// set-ups (Student's t) and transfer_systematic_u; the divisions share the probability of a false alarm. Empty with
/// fewer than two set-ups, or if no set-up has two triangles.
[[nodiscard]] std::optional<ConstancyFigure> transfer_change(std::span<const ContrastMeasurement> measurements);

/// ln of the noise of a later average over that of the first one of the same contrast: of all contrasts and later
/// averages the change that is largest relative to its limit. The limit is constancy_errors standard errors, at least
/// most_noise_change. Of N frames the mean square of the N - 1 successive differences has the relative variance
/// (3 N - 4) / (N - 1)^2 / n for white noise, less for noise with memory. n is the number of independent samples of a
/// frame: 1/n = 1/(4 L) + 1/(4 L^2) if half of the variance is that of whole lines and L the smaller of rows and
/// columns.
/// For contrasts in grey levels the noise is relative to the contrast, so a change of the gain is none. Added to the
/// limit in quadrature: Student's t for a false-alarm probability of transfer_false_alarm, shared by the averages,
/// times the error of the quotient of both contrasts. As in transfer_change(), that is the scatter of a triangle,
/// pooled over the averages of the contrast, for the mean of each average and for a pattern that its triangles share,
/// and transfer_systematic_u.
[[nodiscard]] std::optional<ConstancyFigure> noise_change(std::span<const PictureNoise> noise);
inline constexpr double most_noise_change = 0.1397619;  ///< ln 1.15; five errors of 16 frames of 120 lines: 7 %
inline constexpr double constancy_errors = 5;

/// Difference of the lag-1 correlation between the first and a later average of the same contrast: of all contrasts and
/// later averages the difference that is largest relative to its limit. The limit is constancy_errors standard errors,
/// at least most_correlation_change.
/// The correlation follows from the ratio of the mean squares at the lags l = min(8, N / 4) and 1, whose relative
/// variance is v(1) + v(l) - 2 c: v(l) = (2 m + max(0, m - l)) / m^2 / n with m = N - l, c = (2 m - 1) / (m (N - 1)) /
/// n.
[[nodiscard]] std::optional<ConstancyFigure> correlation_change(std::span<const PictureNoise> noise);
inline constexpr double most_correlation_change = 0.2;  ///< five errors of 16 frames of 120 lines: 0.13

/// Share of `before - mean` in `first - last`, by least squares over the pixels that changed by more than four times
/// the noise. `first`, `last`, `mean`: frames and mean of an average; `before`: the previous average. In a picture that
/// lags, the first frame contains a part of the old one that the last does not. The limit is five standard errors by
/// the noise of a pixel, at least least_residue_share. Empty if the standard error of the share is not below 0.05.
[[nodiscard]] std::optional<PictureResidue> picture_residue(const cv::Mat1d& before, const cv::Mat1d& first,
                                                            const cv::Mat1d& last, const cv::Mat1d& mean,
                                                            double noise_k);
/// Smallest limit of a residue: above the residue that rounding, or a fixed pattern that drifts between corrections,
/// can cause.
inline constexpr double least_residue_share = 0.02;

}  // namespace todbench
