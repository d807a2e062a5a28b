// SPDX-License-Identifier: GPL-3.0-or-later
// Tails of an edge: light that optics and electronics spread over large distances. The tails are modelled as a mixture
// of shapes with bounded shares.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "tod/measures/bounded_least_squares.h"

namespace todbench {

/// Model of a picture of cut-outs with level D and step S:
///     D + (S - sum beta - alpha / k) G + (alpha / k) C + sum beta_i H_i + shading.
/// G is the picture of the cut-outs after a narrow Gaussian blur. C is the picture of the cut-outs after a blur with
/// the MTF exp(-k f), where k is 2 pi cauchy_pitch and f the frequency in cycles per pitch. H_i is the picture of the
/// cut-outs after a Gaussian blur of sigma_i = 2 ... 70 pitches, in 23 steps of constant ratio. alpha / S is the slope
/// of the MTF at frequency 0 due to diffraction, and beta_i / S is the share of halo i. The model can represent any
/// positive mixture of Gaussian halos, for example exponential and power-law halos. The shapes need to be correct only
/// outside the core. The core is measured from the residuals, without a model.
///
/// The MTF is relative to a source of the size of the picture. Halos with a sigma above TailBounds::widest_pitch are
/// fitted, because they distort the picture. These wide halos are not part of the MTF, because they lower the contrast
/// of the whole picture. The MTF therefore refers to the contrast S - sum beta, where the sum is over these wide halos.
namespace edge_tails {
constexpr std::size_t halos = 23;
constexpr std::size_t level = 0, step = 1, slope = 2, first_halo = 3, first_shading = first_halo + halos;
constexpr double narrow_sigma_pitch = 0.45;
constexpr double cauchy_pitch = 0.5;  ///< width of C: its MTF is exp(-2 pi cauchy_pitch f)
/// Returns the sigma of halo i, counted from 0.
[[nodiscard]] double halo_sigma_pitch(std::size_t i);
}  // namespace edge_tails

/// Computes the columns of the model at a position in a picture (x, y in pixels): level, step, slope, halos, then
/// shading.
using TailColumns = std::function<void(cv::Point2d at, std::vector<double>& columns)>;

/// A cut-out: its middle, and the vectors from the middle to two sides, in pixels.
struct TailRectangle {
  cv::Point2d middle, half_u, half_v;
};
/// Sets the first columns for upright or rotated rectangles.
void set_tail_columns(const std::vector<TailRectangle>& cut_outs, cv::Point2d at, std::vector<double>& columns);
/// Sets the first columns for a half plane. `t`: distance from the edge of the half plane in pitches, positive inside.
void set_tail_columns(double t, std::vector<double>& columns);

/// Prior bounds of the tails.
struct TailBounds {
  double least_slope_pitch = 0;  ///< smallest slope of the MTF at frequency 0 due to diffraction, per cycle per pitch
  /// Largest slope of the MTF at frequency 0 due to diffraction, per cycle per pitch.
  double most_slope_pitch = 3;
  /// Largest share of the contrast in the halos that are part of the MTF. If only this bound limits an interval, the
  /// lower limit of the interval is not stated.
  double most_halo = 0.2;
  /// Replaces most_halo if the picture shows a larger share.
  double most_halo_seen = 0.7;
  double widest_pitch = 70;    ///< largest sigma of a halo that is part of the MTF
  double most_wide = 0.5;      ///< largest share of the step in halos wider than widest_pitch
  double most_undershoot = 1;  ///< largest sum of the sizes of negative shares, relative to the step
};
/// Returns the bounds for a stated aperture: 0.9 to 1.8 times (4 / pi) wavelength f-number / pitch. Obscured pupils and
/// aberrations can only increase the slope. The factor 0.9 allows for errors of the stated band and f-number.
[[nodiscard]] TailBounds diffraction_bounds(double f_number, double mean_wavelength_um, double pitch_um);

/// Returns the transfer of each of the first columns at a frequency in cycles per pitch. The transfer is 0 for the
/// level and for wide halos.
[[nodiscard]] std::array<double, edge_tails::first_shading> tail_transfer(double frequency_per_pitch,
                                                                          const TailBounds& bounds);
/// Returns the coefficients of the contrast to which the MTF refers. This contrast is a linear function of the factors
/// of the first columns.
[[nodiscard]] std::array<double, edge_tails::first_shading> tail_contrast(const TailBounds& bounds);

/// Fit of the model to a picture outside the core of every edge.
///
/// Halos have positive shares, because light is only spread. A filter that sharpens the picture adds negative shares.
/// The fit permits negative shares only if the picture shows them. The shares are then negative up to a limit of sigma,
/// which is at most TailBounds::widest_pitch, and positive above this limit. All results include every limit of sigma
/// that the picture does not exclude.
class TailFit {
 public:
  /// Returns the most likely values of the unknowns, in the order of the columns.
  [[nodiscard]] const std::vector<double>& best() const { return families_.front().problem->best(); }
  /// Returns the values of the unknowns with the weakest tails among all values whose chi-square is at most 1 above the
  /// minimum. For an edge without tails, these values contain no tails.
  [[nodiscard]] const std::vector<double>& stated() const { return stated_; }
  /// Returns the values x of the unknowns with the largest scalar product of `direction` and x, among all x whose
  /// chi-square is at most 5.99 above the minimum (95 %).
  [[nodiscard]] std::vector<double> farthest(const std::vector<double>& direction) const;
  /// Returns whether the share of the halos in x is at its upper bound. The picture then does not limit this share.
  [[nodiscard]] bool at_most_halo(const std::vector<double>& x) const;
  [[nodiscard]] const TailBounds& bounds() const { return bounds_; }
  /// Returns whether the picture shows negative shares.
  [[nodiscard]] bool sharpened() const { return families_.front().negative > 0; }
  /// Returns the upper limit (95 %) for the share of the contrast in halos that are part of the MTF.
  [[nodiscard]] double halo_allowance() const;
  /// Return the lower and the upper limit (95 %) of the share of the step in halos wider than TailBounds::widest_pitch,
  /// which are not part of the MTF.
  [[nodiscard]] double least_wide_share() const { return farthest_wide_share(-1); }
  [[nodiscard]] double most_wide_share() const { return farthest_wide_share(1); }
  /// Returns the standard deviation of a pixel, in the unit of the samples.
  [[nodiscard]] double noise() const { return noise_; }
  [[nodiscard]] std::size_t unknowns() const { return unknowns_; }

 private:
  friend class TailSamples;
  [[nodiscard]] double farthest_wide_share(double sign) const;
  /// Least-squares problem for given signs of the halos.
  struct Family {
    std::size_t negative = 0;                            ///< number of halos with shares that are not positive; these
                                                         ///< are the first halos
    std::shared_ptr<const BoundedLeastSquares> problem;  ///< unknowns, followed by slack variables
    double variance = 0;                                 ///< variance of a pixel
    double above = 0;  ///< chi-square at the minimum of this family minus the least chi-square of all families
  };
  std::size_t unknowns_ = 0;
  TailBounds bounds_;
  double noise_ = 0;
  std::vector<Family> families_;  ///< the best first; at least one
  std::vector<double> stated_;
};

/// Samples of a picture outside the core, in units in which the step is near 1.
class TailSamples {
 public:
  explicit TailSamples(std::size_t shading_columns);
  /// Adds the mean of `pixels` pixels near one position. Samples of one `block` (counted from 0) are close together.
  void add(const std::vector<double>& columns, double value, int pixels, std::size_t block);
  /// Fits the model. `level_error`: systematic error of the values, for example by rounding; only negative shares with
  /// a larger effect are found. Empty with fewer than two samples for each unknown, or if one side of the edge has no
  /// samples.
  [[nodiscard]] std::optional<TailFit> fit(const TailBounds& bounds, double level_error = 0) const;

 private:
  [[nodiscard]] TailFit::Family family(const TailBounds& bounds, std::size_t negative, double variance) const;
  [[nodiscard]] TailFit::Family settled(const TailBounds& bounds, std::size_t negative) const;
  /// Returns the families with negative shares if the picture shows negative shares; otherwise `positive`.
  [[nodiscard]] std::vector<TailFit::Family> families(const TailBounds& bounds, const TailFit::Family& positive,
                                                      double level_error) const;
  /// Returns the sum of the squares of the residuals.
  [[nodiscard]] double squares_about(const std::vector<double>& x) const;
  /// Returns the variance of a pixel from the residuals of a fit, increased if the residuals of neighbours are
  /// correlated.
  [[nodiscard]] double variance_about(const std::vector<double>& x) const;
  std::size_t unknowns_;
  struct Sample {
    double value = 0;
    int pixels = 1;
    std::size_t block = 0;
  };
  std::vector<Sample> samples_;
  std::vector<double> rows_;
  std::vector<double> gram_, right_;
  double square_ = 0, pixels_ = 0;  ///< sums over the samples: of pixels * value^2, and of pixels
};

}  // namespace todbench
