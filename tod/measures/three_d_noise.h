// Noise of a sequence of frames by direction: time, rows, columns and all of their combinations.
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Standard deviations of the seven components of D'Agostino and Webb (1991), in the unit of the frames. t: time,
/// v: vertical (constant along a row), h: horizontal (constant along a column). Estimated without bias for any number
/// of frames, rows and columns by the analysis of variance; a variance that comes out negative is 0.
struct ThreeDNoise {
  double tvh = 0;  ///< pixels in time: what is left
  double tv = 0;   ///< rows that flicker
  double th = 0;   ///< columns that flicker
  double t = 0;    ///< whole frames
  double vh = 0;   ///< fixed pattern, and the scene where there is one
  double v = 0;    ///< fixed rows
  double h = 0;    ///< fixed columns
  /// Temporal noise of a pixel: the root of the sum of the four squares with t.
  [[nodiscard]] double temporal() const;
};

/// `invalid_input`: fewer than two frames, rows or columns, or frames of different sizes.
[[nodiscard]] Result<ThreeDNoise> three_d_noise(std::span<const cv::Mat1f> frames);

/// The components by name, in the order in which they are listed everywhere.
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
  ByComponent mean_squares;        ///< in the square of the frames' unit
  ByComponent degrees_of_freedom;  ///< t T-1, v V-1, h H-1, and their products
  /// Correlation of tvh in successive frames, of first order, that the estimates allow for; 0: the plain analysis of
  /// variance, whose cells are independent. T frames that remember hold less than their noise in time and leave more
  /// than its T-th part in the mean frame: E Q_tvh = h tvh^2 and E Q_vh = T vh^2 + g tvh^2 with g = 1 + 2 sum over
  /// k < T of (1 - k / T) rho^k and h = 1 - (g - 1) / (T - 1). At rho = 0.8 and 64 frames that is 6 % of the noise, and
  /// a fixed pattern of a third of it that is not there. Below 1.
  double pixel_memory = 0;
};

/// A variance component with what is known of it.
struct ComponentEstimate {
  double variance = 0;  ///< signed and without bias; equal to the correction for finite sampling of Haefner and Burks
                        ///< (Appl. Opt. 54, 4907, 2015)
  /// 95 %, of normal components: modified large sample (Ting et al. 1990, Graybill and Wang 1980). Signed too. Of noise
  /// that remembers joined with half of what the memory changes: the mean of two frames with the same correlation as
  /// noise of first order leaves half as much.
  double low = 0, high = 0;
  /// Of tv, th and vh: how often a component that is not there gives so large a mean square (F test against tvh).
  /// Nothing: no such test, or no noise to test against.
  std::optional<double> p_absent{};
};

[[nodiscard]] ComponentEstimate estimate_of(const NoiseTable& table, NoiseComponent component);
/// Everything that changes in time: the mean variance of the pixels over frames (t, tv, th and tvh together), with the
/// interval of a sum of mean squares (Graybill and Wang 1980).
[[nodiscard]] ComponentEstimate temporal_variance(const NoiseTable& table);

/// Takes the frames of a table one after the other and keeps none of them: memory is that of three pictures in double
/// precision. A fixed scene or pattern and changes of whole frames cost no precision of the other components. One
/// thread at a time.
class NoiseCube {
 public:
  /// `invalid_input`: another size than the first frame, or a value that is not finite.
  [[nodiscard]] Result<void> add(const cv::Mat1w& frame);
  [[nodiscard]] Result<void> add(const cv::Mat1f& frame);
  [[nodiscard]] Result<void> add(const cv::Mat1d& frame);
  [[nodiscard]] int frames() const { return frames_; }
  /// `invalid_input`: fewer than two frames, rows or columns.
  [[nodiscard]] Result<NoiseTable> table() const;
  /// The same without a fixed picture, such as the shading of the field: it leaves v, h and vh. Precondition: of the
  /// frames' size.
  [[nodiscard]] Result<NoiseTable> table_without(const cv::Mat1d& fixed) const;
  /// Over all frames. Precondition: there is one.
  [[nodiscard]] cv::Mat1d mean_frame() const { return first_ + change_ / frames_; }
  /// Of a pixel in successive frames, rows, columns and whole frames left out: the rho of noise of first order whose
  /// successive differences and mean square have this ratio in so many frames, in [-0.99, 0.99]. Nothing: no noise, or
  /// fewer than five frames.
  [[nodiscard]] std::optional<double> lag1_correlation() const;
  /// What `NoiseTable::pixel_memory` is for these frames: lag1_correlation() where it is there with five standard
  /// errors and up to 0.95, else 0. Beyond that so few frames do not tell it from drift.
  [[nodiscard]] double pixel_memory() const;
  /// The first frame that differs from the one before it by more than the others do, pixel by pixel: a correction lies
  /// between them, or the scene moved. Told by the mean square of the difference without its rows, columns and mean,
  /// which is the same for every pair however the noise remembers: more than 1.69 of the median pair's, and in less
  /// than 1e-9 of all recordings by chance. Nothing: no such frame, or fewer than five frames to tell.
  [[nodiscard]] std::optional<int> abrupt_change() const;

 private:
  template <typename Pixel>
  [[nodiscard]] Result<void> add_frame(const cv::Mat_<Pixel>& frame);

  int frames_ = 0;
  cv::Mat1d first_;                               ///< what every frame is compared with
  cv::Mat1d change_;                              ///< sum over frames of change - mean change of its frame
  double squares_ = 0;                            ///< sum of the squares of the same
  cv::Mat1d last_;                                ///< change of the last frame without its mean
  std::vector<double> steps_;                     ///< mean square of each successive difference
  std::vector<double> frame_means_;               ///< mean change of each frame
  std::vector<double> row_means_, column_means_;  ///< of each frame, one after the other, without the frame's mean
};

}  // namespace todbench
