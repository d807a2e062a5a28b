// How probable each answer to given patches is, as a smooth function of an observer's blur and of its own noise.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "acquisition/core/result.h"
#include "hvs/observer/observer.h"
#include "hvs/observer/template_observer.h"

namespace todbench {

/// A patch that somebody answered.
struct AnsweredPatch {
  cv::Mat1f kelvin;       ///< square, an even number of samples on a side, its centre at the window's centre
  double contrast_k = 0;  ///< effective, with its sign
  double noise_k = 0;     ///< temporal noise of the sensor, sd per sample
  double size_samples = 0;
  int samples_per_pitch = 1;
};

/// ln of the probability of each alternative.
struct LogProbabilities {
  static constexpr std::size_t max_alternatives = Choice::max_alternatives;
  std::array<double, max_alternatives> value{};
};

/// Probabilities of the answers of a template observer to patches, over its own noise, for any blur sigma and any
/// standard deviation s of that noise per sample (relative to the contrast).
///
/// At the nodes of a lattice in ln sigma and ln s: with common draws z of white noise of a window, the same for every
/// patch of a size and every node, the score of template t is <T_t, g> + s <T_t, z>. The part of z along the difference
/// of the two best templates is integrated in closed form: the largest score of an alternative is a convex function of
/// it, taken as linear between 19 places half a standard deviation apart, and the range where an alternative is best
/// has a probability by the normal distribution (conditioning, Owen 2013, 8.7). Each z is taken with both signs. Half a
/// draw is added as far as an alternative's best template can win at all, so that no probability is 0. Between the
/// nodes ln p is interpolated by monotone cubics (Steffen 1990), along s, then along sigma, and what does not sum to 1
/// is scaled.
///
/// Nodes are computed when they are first asked for. One thread at a time.
class AnswerLattice {
 public:
  struct Options {
    int draws = 384;  ///< of the noise across the direction, an even number
    std::uint64_t seed = 1;
  };
  static constexpr double least_sigma = 0.15, most_sigma = 3;    ///< displayed samples
  static constexpr double least_noise = 0.005, most_noise = 10;  ///< sd per sample, relative to the contrast

  /// `spec` gives search and window. `invalid_input`: a patch that is not square or smaller than the observer's window,
  /// that is not finite, a contrast of 0, a size that the observer cannot judge; says which patch, counted from 1.
  [[nodiscard]] static Result<AnswerLattice> create(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                                    std::vector<AnsweredPatch> patches, const Options& options);
  AnswerLattice(AnswerLattice&&) noexcept;
  AnswerLattice& operator=(AnswerLattice&&) noexcept;
  ~AnswerLattice();

  [[nodiscard]] std::size_t patches() const;
  [[nodiscard]] int alternatives() const;
  [[nodiscard]] const AnsweredPatch& patch(std::size_t index) const;

  /// ln p of each alternative of a patch. Outside the domain: as at its edge.
  [[nodiscard]] LogProbabilities log_probabilities(std::size_t patch, double sigma_samples, double noise);

 private:
  struct Content;
  explicit AnswerLattice(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace todbench
