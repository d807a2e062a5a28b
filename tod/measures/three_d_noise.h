// SPDX-License-Identifier: GPL-3.0-or-later
// Noise of a sequence of frames by direction: time, rows, columns and all their combinations.
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Standard deviations of the seven components of D'Agostino and Webb (1991), in the unit of the frames. t: time, v:
/// vertical (constant along a row), h: horizontal (constant along a column). Unbiased for any number of frames, rows
/// and columns (analysis of variance); a negative variance estimate is set to 0.
struct ThreeDNoise {
  double tvh = 0;  ///< remaining variation of pixels in time
  double tv = 0;   ///< flickering rows
  double th = 0;   ///< flickering columns
  double t = 0;    ///< whole frames
  double vh = 0;   ///< fixed pattern, and the scene if there is one
  double v = 0;    ///< fixed rows
  double h = 0;    ///< fixed columns
  /// Returns the temporal noise of a pixel: the root sum of squares of t, tv, th and tvh.
  [[nodiscard]] double temporal() const;
};

/// Computes the components. Errors: `invalid_input` (fewer than two frames, rows or columns, or frames of different
/// sizes).
[[nodiscard]] Result<ThreeDNoise> three_d_noise(std::span<const cv::Mat1f> frames);

/// The components, in the order of every list.
enum class NoiseComponent { t, v, h, tv, th, vh, tvh };
inline constexpr std::array noise_components{NoiseComponent::t,  NoiseComponent::v,  NoiseComponent::h,
                                             NoiseComponent::tv, NoiseComponent::th, NoiseComponent::vh,
                                             NoiseComponent::tvh};
[[nodiscard]] std::string_view to_string(NoiseComponent component);

/// One number for each component.
class ByComponent {
 public:
  [[nodiscard]] double& operator[](NoiseComponent component) { return values_[static_cast<std::size_t>(component)]; }
  [[nodiscard]] double operator[](NoiseComponent component) const {
    return values_[static_cast<std::size_t>(component)];
  }

 private:
  std::array<double, noise_components.size()> values_{};
};

/// Analysis of variance of the table frames x rows x columns, one value per cell (Scheffé 1959, ch. 7).
struct NoiseTable {
  int frames = 0, rows = 0, columns = 0;
  ByComponent mean_squares;        ///< mean squares in the squared unit of the frames
  ByComponent degrees_of_freedom;  ///< t: T - 1 (T frames), v: V - 1 (V rows), h: H - 1 (H columns); otherwise products
  /// First-order correlation rho of tvh in successive frames, below 1. The estimates are corrected for this
  /// correlation. 0: analysis of variance with independent cells. If the noise has memory, its variance over T frames
  /// is too small, and more than 1/T of the variance remains in the mean frame. The mean squares Q have the
  /// expectations b tvh^2 for Q_tvh and T vh^2 + g tvh^2 for Q_vh, with g = 1 + 2 sum over 0 < k < T of (1 - k / T)
  /// rho^k and b = 1 - (g - 1) / (T - 1). For example, with rho = 0.8 and 64 frames, the uncorrected noise is 6 % too
  /// low, and there is an apparent fixed pattern of a third of the noise.
  double pixel_memory = 0;
};

/// A variance component with its uncertainty.
struct ComponentEstimate {
  /// Signed and unbiased. Equal to the estimate with the correction for finite sampling of Haefner and Burks (Appl.
  /// Opt. 54, 4907, 2015).
  double variance = 0;
  /// 95 % interval for normal components: modified large sample (Ting et al. 1990, Graybill and Wang 1980). Signed. For
  /// noise with memory, half of the memory correction is added in quadrature, because the correction depends on the
  /// kind of memory. For example, the mean of two frames has the same lag-1 correlation as noise of first order, but
  /// needs only half of the correction.
  double low = 0, high = 0;
  /// For tv, th and vh: probability of a mean square at least this large without the component (F test against tvh).
  /// Empty: no test for this component, or no noise to test against.
  std::optional<double> p_absent{};
};

/// Estimates one component.
[[nodiscard]] ComponentEstimate estimate_of(const NoiseTable& table, NoiseComponent component);
/// Estimates all variation in time: the mean variance of the pixels over frames (t, tv, th and tvh together), with the
/// interval of a sum of mean squares (Graybill and Wang 1980).
[[nodiscard]] ComponentEstimate temporal_variance(const NoiseTable& table);

/// Computes a table from frames that are added one after another. Frames are not stored; the memory is that of three
/// pictures in double precision. The precision of a component does not depend on a fixed scene, a fixed pattern or
/// changes of whole frames. One thread at a time.
class NoiseCube {
 public:
  /// Add a frame. Errors: `invalid_input` (not the size of the first frame, or a value that is not finite).
  [[nodiscard]] Result<void> add(const cv::Mat1w& frame);
  [[nodiscard]] Result<void> add(const cv::Mat1f& frame);
  [[nodiscard]] Result<void> add(const cv::Mat1d& frame);
  [[nodiscard]] int frames() const { return frames_; }
  /// Returns the table. Errors: `invalid_input` (fewer than two frames, rows or columns).
  [[nodiscard]] Result<NoiseTable> table() const;
  /// Returns the table after subtraction of a fixed picture, for example the shading of the field. The subtraction
  /// changes v, h and vh. Errors as table(). Precondition: `fixed` has the size of the frames.
  [[nodiscard]] Result<NoiseTable> table_without(const cv::Mat1d& fixed) const;
  /// Returns the mean over all frames. Precondition: at least one frame.
  [[nodiscard]] cv::Mat1d mean_frame() const { return first_ + change_ / frames_; }
  /// Returns the lag-1 correlation of a pixel after removal of rows, columns and whole frames, in -0.99 to 0.99. The
  /// result is the rho of first-order noise with the same number of frames and the same ratio of mean squared
  /// successive difference to mean square. Empty: no noise, or fewer than five frames.
  [[nodiscard]] std::optional<double> lag1_correlation() const;
  /// Returns NoiseTable::pixel_memory of these frames. The result is lag1_correlation() if lag1_correlation() exceeds
  /// five standard errors and is at most 0.95; otherwise it is 0. A correlation above 0.95 cannot be distinguished from
  /// drift in so few frames.
  [[nodiscard]] double pixel_memory() const;
  /// Returns the index of the first frame that differs significantly from the previous frame, because of a correction
  /// or a moved scene. The statistic is the mean square of the difference of two successive frames, after removal of
  /// rows, columns and mean. Its expectation is equal for all pairs, also for noise with memory. The limit is 1.69
  /// times the value of the median pair. Chance exceeds this limit in less than 1e-9 of all recordings. Empty: no such
  /// frame, or fewer than five frames.
  [[nodiscard]] std::optional<int> abrupt_change() const;
  /// Returns whether at most three pairs of successive frames have a mean square difference above 1.3 times the median.
  /// The result is true if a correction occurred. With more of these pairs, the noise changes or the scene moves, and
  /// the result of abrupt_change() is meaningless.
  [[nodiscard]] bool few_pairs_stand_out() const;
  /// Returns whether the noise of a pixel differs between the first and the second half of the frames. True if the mean
  /// square differences of successive frames, as in abrupt_change(), have a ratio above 1.15 (7 % of the noise). Chance
  /// exceeds this limit in less than 1e-9 of all recordings. False for fewer than eight frames.
  [[nodiscard]] bool noise_changes() const;
  /// Returns the index of a row at the upper or lower edge that is not part of the picture, for example telemetry. Each
  /// of the outer four rows is compared with the four rows further inside. A row is outside the picture if a quantity
  /// is much larger than in the rows further inside. The quantities are the mean square successive difference without
  /// changes of the whole row (100 times), and the mean difference of adjacent pixels in the mean frame (10 times).
  /// Noise and a scene imaged by a lens are far below both limits. Empty: no such row, or fewer than 16 rows.
  [[nodiscard]] std::optional<int> row_outside_picture() const;

 private:
  template <typename Pixel>
  [[nodiscard]] Result<void> add_frame(const cv::Mat_<Pixel>& frame);

  int frames_ = 0;
  cv::Mat1d first_;                  ///< first frame, the reference of every frame
  cv::Mat1d change_;                 ///< sum over frames of (change - mean change of its frame)
  double squares_ = 0;               ///< sum of the squares of these changes
  cv::Mat1d last_;                   ///< change of the last frame without its mean
  std::vector<double> steps_;        ///< mean square of each successive difference
  std::vector<double> row_steps_;    ///< sum of squares of the successive differences of each row, about their mean
  std::vector<double> frame_means_;  ///< mean change of each frame
  /// Means of rows and columns of each frame in order, minus the mean of the frame.
  std::vector<double> row_means_, column_means_;
};

}  // namespace todbench
