// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the camera remained constant during a run, and whether each picture shows the present target. The tests
// use the averages in which the contrasts are measured. All functions are pure functions of the records of a run.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/measurement/contrast_error.h"

namespace todbench {

/// Noise in the frames that are averaged to measure the contrast of one set-up.
struct PictureNoise {
  /// Set contrast.
  double set_delta_t_k = 0;
  /// Noise of a pixel in one frame, from differences of successive frames. Above 0.
  double noise_k = 0;
  /// Lag-1 correlation of the noise. Empty: too few frames.
  std::optional<double> lag1_correlation{};
  /// Number of averaged frames, at least 2.
  int frames = 16;
  /// Number of rows or of columns of the picture, whichever is smaller.
  int lines = 120;
  /// Number of large triangles, at least 2, for a contrast in grey levels. noise_k is then (noise / contrast) times the
  /// contrast of the target. 0: the contrast is in kelvin.
  int triangles = 0;
  /// Standard deviation of the contrasts of these triangles, divided by their mean. Used only for a contrast in grey
  /// levels.
  double triangle_scatter = 0;
};

/// Residue of the previous picture in the first frame of an average.
struct PictureResidue {
  /// Share of the difference between the previous picture and this picture that remains in the first frame. 0: no
  /// residue.
  double share = 0;
  /// Largest share that is not a finding.
  double limit = 0;
  /// True: the residue is in the pictures after processing stages. False: it is in the frames of the camera.
  bool behind_stages = false;
};

/// Contrast of the large triangles of one set-up at one set contrast: in its presentations, and in the preceding
/// average, in which the contrast was measured. Both contrasts are amplitudes of the same fit (fit_place()), so an
/// inexact blur changes both equally.
struct PresentedContrast {
  /// Set contrast.
  double set_delta_t_k = 0;
  /// Amplitude in the average, and its standard error.
  double measured = 0, measured_error = 0;
  /// Sums over the presentations: of the amplitudes, of their standard errors, and of PlateSeen::shared.
  double sum = 0, errors = 0, shared = 0;
  /// Number of presentations in the sums.
  int presentations = 0;
};

/// Values for the tests of constancy, computed from averages over the pictures of a run.
struct RunConstancy {
  /// One element for each average, in the order of the run.
  std::vector<PictureNoise> noise;
  /// Residue with the largest ratio of share to limit. Empty: no two successive pictures differed enough.
  std::optional<PictureResidue> residue{};
  /// Settled contrasts in kelvin, in the order of the run.
  std::vector<PresentedContrast> presented{};
};

/// A figure with its limit. A magnitude above the limit is a finding.
struct ConstancyFigure {
  /// Observed value, signed.
  double value = 0;
  /// Largest magnitude of the value that is not a finding.
  double limit = 0;
  /// Returns whether the magnitude of the value is above the limit.
  [[nodiscard]] bool beyond() const { return value > limit || value < -limit; }
};

/// Standard uncertainty of the ratio between the observed contrasts in two groups of set-ups. If the simulated camera
/// is less sharp than the real camera, the response of the contrast estimator differs by up to 2 % between plates with
/// different triangle sizes.
inline constexpr double transfer_systematic_u = 0.01;
/// Probability of a false alarm of transfer_change() in a whole run.
inline constexpr double transfer_false_alarm = 0.005;

/// Returns the relative change of the signal transfer between the first set-ups and the later set-ups. Every division
/// of the run into first and later set-ups is tested. The change with the largest ratio to its limit is returned. For a
/// set-up with several contrasts, the difference between the lowest and the highest contrast of each triangle is used.
/// In this difference, fixed pattern, row noise and column noise cancel. If a set-up has one contrast, the error also
/// includes a pattern common to all its triangles. The standard deviation of this pattern is set to the scatter of one
/// triangle. A set-up is excluded if its contrasts span less than half of the widest span. The error contains the
/// pooled scatter of the triangles within the set-ups (Student's t) and transfer_systematic_u. The probability of a
/// false alarm is shared among the divisions. Empty with fewer than two set-ups, or if no set-up has two triangles.
[[nodiscard]] std::optional<ConstancyFigure> transfer_change(std::span<const ContrastMeasurement> measurements);

/// Returns the change of the noise: ln (noise of a later average / noise of the first average at the same contrast).
/// The change with the largest ratio to its limit is returned, over all contrasts and later averages. The limit is
/// constancy_errors standard errors, at least most_noise_change.
///
/// Let n be the number of independent samples of a frame. Whole lines are assumed to cause half of the variance: 1/n =
/// 1/(4 L) + 1/(4 L^2), where L is the number of rows or of columns, whichever is smaller. For N frames of white noise,
/// the mean square of the N - 1 successive differences has the relative variance (3 N - 4) / ((N - 1)^2 n). For noise
/// with memory the variance is smaller.
///
/// Grey levels: the noise is relative to the contrast, so a change of the gain has no effect on the noise. The limit
/// then contains a further term, added in quadrature: the error of the quotient of the two contrasts, times Student's t
/// for the probability transfer_false_alarm, which the averages share. As in transfer_change(), this error contains
/// transfer_systematic_u and the scatter of a triangle, pooled over the averages of the contrast. The scatter is
/// counted twice: for the mean over the triangles of each average, and for a pattern common to these triangles.
[[nodiscard]] std::optional<ConstancyFigure> noise_change(std::span<const PictureNoise> noise);
inline constexpr double most_noise_change = 0.1397619;  ///< ln 1.15; five errors of 16 frames of 120 lines: 7 %
inline constexpr double constancy_errors = 5;

/// Returns the relative difference between the contrast in the presentations and the measured contrast. The difference
/// with the largest ratio to its limit is returned, over all elements of `presented`. The limit is constancy_errors
/// standard errors and most_presented_change, added in quadrature. The standard error combines the errors of both
/// amplitudes. This error takes into account that the fixed pattern is the same in all presentations. Empty if no
/// contrast was presented.
[[nodiscard]] std::optional<ConstancyFigure> presented_change(std::span<const PresentedContrast> presented);
/// Relative difference that is allowed in addition to the standard errors, because the amplitude of triangles of four
/// pixels depends on their phases.
inline constexpr double most_presented_change = 0.04;

/// Returns the lag-1 correlation of a later average minus that of the first average at the same contrast. The
/// difference with the largest ratio to its limit is returned, over all contrasts and later averages. The limit is
/// constancy_errors standard errors, at least most_correlation_change. The correlation is computed from the ratio of
/// the mean squares at the lags 1 and l = min(8, N / 4). The relative variance of this ratio is v(1) + v(l) - 2 c,
/// where v(l) = (2 m + max(0, m - l)) / m^2 / n, m = N - l and c = (2 m - 1) / (m (N - 1)) / n (N, n: noise_change()).
[[nodiscard]] std::optional<ConstancyFigure> correlation_change(std::span<const PictureNoise> noise);
inline constexpr double most_correlation_change = 0.2;  ///< five errors of 16 frames of 120 lines: 0.13

/// Returns the residue of the previous picture in an average. `first`, `last`, `mean`: first frame, last frame and mean
/// of the average; `before`: mean of the previous average. If the picture lags, the first frame contains a part of the
/// previous picture and the last frame does not. The share of `before - mean` in `first - last` is fitted by least
/// squares to the pixels that changed by more than four times the noise. The limit is five standard errors due to the
/// noise of a pixel, at least least_residue_share. Empty if the standard error of the share is 0.05 or larger.
[[nodiscard]] std::optional<PictureResidue> picture_residue(const cv::Mat1d& before, const cv::Mat1d& first,
                                                            const cv::Mat1d& last, const cv::Mat1d& mean,
                                                            double noise_k);
/// Returns the residue in the judged pictures of an average. The share is computed for each picture, because processing
/// stages may scale each picture differently. `before`: mean of the judged pictures of the previous average; `mean`:
/// mean of `pictures`. The residue is the share in the first picture minus the mean share in the second half of the
/// pictures. The limit includes five standard deviations of the shares in the second half. The noise is the median over
/// the pixels. Empty as for picture_residue(), for fewer than eight pictures, and if `before` is empty or has a
/// different size.
[[nodiscard]] std::optional<PictureResidue> judged_residue(const cv::Mat1d& before, std::span<const cv::Mat1w> pictures,
                                                           const cv::Mat1d& mean);
/// Smallest limit of a residue. It exceeds the residue that rounding, or a fixed pattern that drifts between
/// corrections, can cause.
inline constexpr double least_residue_share = 0.02;

}  // namespace todbench
