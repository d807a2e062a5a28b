// SPDX-License-Identifier: GPL-3.0-or-later
// Probabilities of an observer's answers to given patches, as a smooth function of the blur and the internal noise of
// the observer.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/observer.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// A patch with a recorded answer.
struct AnsweredPatch {
  cv::Mat1f kelvin;         ///< square with an even number of samples on a side; centred in the observer's window
  double contrast_k = 0;    ///< effective contrast, signed
  double noise_k = 0;       ///< temporal noise of the sensor, sd per sample
  double size_samples = 0;  ///< size of the target: square root of area
  int samples_per_pitch = 1;
};

/// ln of the probability of each alternative.
struct AnswerLogProbabilities {
  static constexpr std::size_t max_alternatives = Choice::max_alternatives;
  std::array<double, max_alternatives> value{};
};

/// Probabilities of a template observer's answers to patches, averaged over the internal noise of the observer. The
/// probabilities are available for any blur sigma and any standard deviation s of this noise per sample (relative to
/// the contrast).
///
/// Values are computed at the nodes of a lattice in ln sigma and ln s. All nodes and all patches of one size use the
/// same draws of white noise z in the window. The score of template T is <T, g> + s <T, z>, g = patch / contrast. The
/// component of z along the difference of the two best templates is integrated in closed form (conditioning, Owen 2013,
/// 8.7). The largest score of an alternative is a convex function of this component. This function is approximated as
/// piecewise linear between 19 points at distances of half a standard deviation. The probability of each range in which
/// an alternative has the largest score is computed from the normal distribution. Each z is used with both signs. To
/// avoid probabilities of 0, half a draw is added to each alternative, weighted by the probability that the best
/// template of the alternative has the largest score. Between the nodes, ln p is interpolated by monotone cubics
/// (Steffen 1990), first along s, then along sigma. The probabilities are then normalised to a sum of 1.
///
/// For an observer with an eye, the two coordinates are standard deviations: that of the eye's noise in a score
/// (EyeNoise::sd()), and that of the white noise per sample. Except for a common factor, the covariance of the scores
/// depends only on the ratio of these two standard deviations. Nodes with equal ratios therefore use the same draws.
/// The rest of the computation is the same.
///
/// Nodes are computed on first use. One thread at a time.
class AnswerLattice {
 public:
  struct Options {
    /// Number of noise vectors, even. Half of them are drawn; the other half are the same vectors with the opposite
    /// sign.
    int draws = 384;
    std::uint64_t seed = 1;
  };
  static constexpr double least_sigma = 0.15, most_sigma = 3;    ///< displayed samples
  static constexpr double least_noise = 0.005, most_noise = 10;  ///< sd per sample, relative to the contrast

  /// Creates a lattice with the search and the window of `spec`. Error: `invalid_input` with the number of the invalid
  /// patch, counted from 1. A patch is invalid if it is not square, smaller than the observer's window or not finite,
  /// or has a contrast of 0, negative noise or a size that the observer cannot judge.
  [[nodiscard]] static Result<AnswerLattice> create(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                                    std::vector<AnsweredPatch> patches, const Options& options);
  AnswerLattice(AnswerLattice&&) noexcept;
  AnswerLattice& operator=(AnswerLattice&&) noexcept;
  ~AnswerLattice();

  [[nodiscard]] std::size_t patches() const;
  [[nodiscard]] int alternatives() const;
  [[nodiscard]] const AnsweredPatch& patch(std::size_t index) const;

  /// Returns ln p of each alternative for a patch. `first`: sigma of the blur in samples; with an eye, the noise of the
  /// eye in a score. `noise`: s. Values outside the domain are replaced by the nearest limit.
  [[nodiscard]] AnswerLogProbabilities log_probabilities(std::size_t patch, double first, double noise);
  [[nodiscard]] bool has_eye() const;
  /// Returns the noise of the eye in a score of this patch, for an eye with `gain` times the sensitivity and with kappa
  /// = `contrast_noise` (EyeParameters). Precondition: has_eye().
  [[nodiscard]] double eye_noise(std::size_t patch, double gain, double contrast_noise) const;

 private:
  struct Content;
  explicit AnswerLattice(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace todbench
