// SPDX-License-Identifier: GPL-3.0-or-later
// Probabilities of an observer's answers to given patches, as a smooth function of its blur and its own noise.
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
  cv::Mat1f kelvin;       ///< square, an even number of samples on a side, centred in the window
  double contrast_k = 0;  ///< effective, with its sign
  double noise_k = 0;     ///< temporal noise of the sensor, sd per sample
  double size_samples = 0;
  int samples_per_pitch = 1;
};

/// ln of the probability of each alternative.
struct AnswerLogProbabilities {
  static constexpr std::size_t max_alternatives = Choice::max_alternatives;
  std::array<double, max_alternatives> value{};
};

/// Probabilities of a template observer's answers to patches, averaged over the observer's own noise. They are
/// available for any blur sigma and any standard deviation s of that noise per sample (relative to the contrast).
///
/// Values are computed at the nodes of a lattice in ln sigma and ln s. One white noise z of a window is drawn for all
/// patches of a size and all nodes; the score of template t is <T_t, g> + s <T_t, z>. The component of z along the
/// difference of the two best templates is integrated in closed form (conditioning, Owen 2013, 8.7). The largest score
/// of an alternative is a convex function of that component. It is approximated as piecewise linear between 19 points
/// half a standard deviation apart. The probability of each range in which an alternative is best follows from the
/// normal distribution. Each z is used with both signs. So that no probability is 0, half a draw is added, weighted
/// with the probability that the alternative's best template wins. Between the nodes ln p is interpolated by monotone
/// cubics (Steffen 1990), first along s, then along sigma. The probabilities are then normalised to a sum of 1.
///
/// With an eye the two coordinates are the standard deviations of the observer's two noises: noise of the eye in a
/// score (EyeNoise::sd()) and white noise per sample. Up to a common factor, the covariance of the scores depends only
/// on the ratio of the two, so nodes of equal ratio share their draws. The computation is otherwise the same.
///
/// Nodes are computed on first use. One thread at a time.
class AnswerLattice {
 public:
  struct Options {
    int draws = 384;  ///< number of noise vectors, even: half of them are drawn, the others are these with the opposite
                      ///< sign
    std::uint64_t seed = 1;
  };
  static constexpr double least_sigma = 0.15, most_sigma = 3;    ///< displayed samples
  static constexpr double least_noise = 0.005, most_noise = 10;  ///< sd per sample, relative to the contrast

  /// Creates a lattice with the search and the window of `spec`. Error: `invalid_input` with the number of the patch,
  /// counted from 1 (not square, smaller than the observer's window, not finite, contrast of 0, negative noise, or a
  /// size that the observer cannot judge).
  [[nodiscard]] static Result<AnswerLattice> create(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                                    std::vector<AnsweredPatch> patches, const Options& options);
  AnswerLattice(AnswerLattice&&) noexcept;
  AnswerLattice& operator=(AnswerLattice&&) noexcept;
  ~AnswerLattice();

  [[nodiscard]] std::size_t patches() const;
  [[nodiscard]] int alternatives() const;
  [[nodiscard]] const AnsweredPatch& patch(std::size_t index) const;

  /// Returns ln p of each alternative of a patch. Outside the domain it returns the value at the edge. `first`: sigma
  /// of the blur in samples, or with an eye the noise of the eye in a score.
  [[nodiscard]] AnswerLogProbabilities log_probabilities(std::size_t patch, double first, double noise);
  [[nodiscard]] bool has_eye() const;
  /// Returns the noise of the eye in a score of this patch, for an eye with `gain` times the sensitivity. Precondition:
  /// has_eye().
  [[nodiscard]] double eye_noise(std::size_t patch, double gain, double contrast_noise) const;

 private:
  struct Content;
  explicit AnswerLattice(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace todbench
