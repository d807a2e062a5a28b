// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the camera remained constant during a run, and whether a picture shows the present target. The figures
// and their limits come from the averages in which the contrasts are measured. Pure functions of the run's records.
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
  int frames = 16;                           ///< number in the average, at least 2
  int lines = 120;                           ///< smaller number of rows and columns
  /// Number of large triangles (at least 2) and standard deviation of one of them, relative to their mean. For
  /// contrasts in grey levels, where noise_k is (noise / contrast) times the contrast of the target. 0: kelvin.
  int triangles = 0;
  double triangle_scatter = 0;
};

/// Residue of the previous picture in the first frame of an average.
struct PictureResidue {
  double share = 0;            ///< share of the difference between the previous picture and this one; 0: no residue
  double limit = 0;            ///< above this limit the picture was still changing
  bool behind_stages = false;  ///< in the judged pictures, and not in the camera's frames
};

/// Contrast of the large triangles in the presentations of one set-up and contrast, and in the average in which the
/// contrast was measured before them. Amplitudes of one fit (fit_place()), so that a blur that is not exact changes
/// both alike.
struct PresentedContrast {
  double set_delta_t_k = 0;
  double measured = 0, measured_error = 0;  ///< in the average, with its standard error
  double sum = 0, errors = 0, shared = 0;  ///< sums over the presentations: amplitudes, their errors, PlateSeen::shared
  int presentations = 0;
};

/// Further results of the averages of a run.
struct RunConstancy {
  std::vector<PictureNoise> noise;          ///< in the order of the run
  std::optional<PictureResidue> residue{};  ///< residue with the largest share relative to its limit; empty: no picture
                                            ///< differed enough
  std::vector<PresentedContrast> presented{};  ///< settled contrasts in kelvin, in the order of the run
};

/// A figure and the limit beyond which it is a finding.
struct ConstancyFigure {
  double value = 0;
  double limit = 0;
  [[nodiscard]] bool beyond() const { return value > limit || value < -limit; }
};

/// Standard uncertainty of the ratio of the observed contrasts of two groups of set-ups. If the simulated camera is not
/// as sharp as the real one, the estimator's response differs by up to 2 % between plates of different sizes.
inline constexpr double transfer_systematic_u = 0.01;
/// Probability of a false alarm of transfer_change() in a whole run.
inline constexpr double transfer_false_alarm = 0.005;

/// Returns the relative change of the signal transfer between the first set-ups and the later ones. The run is divided
/// where this change is largest in units of its error. A set-up with several contrasts contributes the difference of
/// its extreme contrasts, triangle by triangle; fixed pattern, row and column noise cancel. For a set-up with one
/// contrast, the error includes a pattern common to its triangles, as large as the scatter of one triangle. A set-up is
/// excluded if its contrasts span less than half of the widest span. The error contains the pooled scatter of the
/// triangles within the set-ups (Student's t) and transfer_systematic_u. The possible divisions share the probability
/// of a false alarm. Empty with fewer than two set-ups, or if no set-up has two triangles.
[[nodiscard]] std::optional<ConstancyFigure> transfer_change(std::span<const ContrastMeasurement> measurements);

/// Returns the change of the noise: ln (noise of a later average / noise of the first average at the same contrast). Of
/// all contrasts and later averages it is the change that is largest relative to its limit. The limit is
/// constancy_errors standard errors, at least most_noise_change. With N frames, the mean square of the N - 1 successive
/// differences has the relative variance (3 N - 4) / (N - 1)^2 / n for white noise, less for noise with memory. n is
/// the number of independent samples of a frame: 1/n = 1/(4 L) + 1/(4 L^2) if whole lines cause half of the variance; L
/// is the smaller of rows and columns.
/// For contrasts in grey levels the noise is relative to the contrast, so a change of the gain does not change it. A
/// further term is then added to the limit in quadrature: the error of the quotient of both contrasts, times Student's
/// t for a false-alarm probability of transfer_false_alarm, which the averages share. As in transfer_change(), this
/// error contains transfer_systematic_u and the scatter of a triangle, pooled over the averages of the contrast. The
/// scatter enters for the mean of each average and for a pattern that its triangles share.
[[nodiscard]] std::optional<ConstancyFigure> noise_change(std::span<const PictureNoise> noise);
inline constexpr double most_noise_change = 0.1397619;  ///< ln 1.15; five errors of 16 frames of 120 lines: 7 %
inline constexpr double constancy_errors = 5;

/// Returns the relative difference between the contrast in the presentations and the measured contrast, of the set-up
/// and contrast where it is largest relative to its limit. The limit is constancy_errors standard errors and
/// most_presented_change in quadrature. The standard error has the errors of both amplitudes; fixed pattern recurs in
/// all presentations. Empty if no contrast was presented.
[[nodiscard]] std::optional<ConstancyFigure> presented_change(std::span<const PresentedContrast> presented);
/// The amplitude of triangles of four pixels depends on their phases.
inline constexpr double most_presented_change = 0.04;

/// Returns the difference of the lag-1 correlation between the first and a later average at the same contrast. Of all
/// contrasts and later averages it is the difference that is largest relative to its limit. The limit is
/// constancy_errors standard errors, at least most_correlation_change.
/// The correlation follows from the ratio of the mean squares at the lags l = min(8, N / 4) and 1, whose relative
/// variance is v(1) + v(l) - 2 c: v(l) = (2 m + max(0, m - l)) / m^2 / n with m = N - l, c = (2 m - 1) / (m (N - 1)) /
/// n.
[[nodiscard]] std::optional<ConstancyFigure> correlation_change(std::span<const PictureNoise> noise);
inline constexpr double most_correlation_change = 0.2;  ///< five errors of 16 frames of 120 lines: 0.13

/// Returns the share of `before - mean` in `first - last`, by least squares over the pixels that changed by more than
/// four times the noise. `first`, `last`, `mean`: first frame, last frame and mean of an average; `before`: the
/// previous average. If a picture lags, its first frame contains a part of the old picture that its last frame does
/// not. The limit is five standard errors due to the noise of a pixel, at least least_residue_share. Empty if the
/// standard error of the share is 0.05 or larger.
[[nodiscard]] std::optional<PictureResidue> picture_residue(const cv::Mat1d& before, const cv::Mat1d& first,
                                                            const cv::Mat1d& last, const cv::Mat1d& mean,
                                                            double noise_k);
/// Returns the same for the judged pictures of an average, which stages may scale from picture to picture. `before`:
/// mean of the previous average; `mean`: mean of these pictures. The share is that of the first picture minus the mean
/// of the second half. Five standard deviations of the shares of the second half are part of the limit. The noise is
/// the median over the pixels. Empty as above, for fewer than eight pictures, and if `before` is empty or has another
/// size.
[[nodiscard]] std::optional<PictureResidue> judged_residue(const cv::Mat1d& before, std::span<const cv::Mat1w> pictures,
                                                           const cv::Mat1d& mean);
/// Smallest limit of a residue. It exceeds the residue that rounding, or a fixed pattern that drifts between
/// corrections, can cause.
inline constexpr double least_residue_share = 0.02;

}  // namespace todbench
