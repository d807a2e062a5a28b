// SPDX-License-Identifier: GPL-3.0-or-later
// Templates of one observer for one size: ideal shapes behind the viewing filter, at every place of the search.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/observer.h"

namespace todbench {

class EyeNoise;
class FilterTable;
struct TemplateObserverSpec;

/// Templates with zero mean and unit norm, in single precision. Immutable, thread-safe. With an eye they are the ideal
/// shapes behind display and eye, with a common scale: the norm of the central template of the first alternative is 1.
///
/// Template (o, p) is alternative o at search place p. It is sampled at the centres of displayed samples, k + 1/2 with
/// k = -m..m-1, measured from the window's centre.
class TemplateBank {
 public:
  /// Computes the templates. Error: `invalid_input` if the bank would exceed `max_bytes`.
  [[nodiscard]] static Result<TemplateBank> build(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                                  double size_samples, int samples_per_pitch);

  [[nodiscard]] int window_samples() const { return window_; }
  [[nodiscard]] int alternatives() const { return alternatives_; }
  /// Returns the number of search places per alternative.
  [[nodiscard]] int places() const { return places_; }
  /// Returns the number of templates, alternatives times places; template (o, p) has index o * places() + p.
  [[nodiscard]] int templates() const { return alternatives_ * places_; }
  /// Returns templates() rounded up to whole blocks: the length of a score vector. The padding scores are zero.
  [[nodiscard]] std::size_t padded_templates() const { return blocks_ * block; }
  [[nodiscard]] std::size_t blocks() const { return blocks_; }

  /// Computes the scores of all templates for a patch of window_samples()^2 values, row by row. `scores` has
  /// padded_templates() elements. Each score is one sum over samples in a fixed order, so it is bit-identical on every
  /// instruction set.
  void project(std::span<const float> patch, std::span<float> scores) const;
  /// Computes project() of every patch, bit-identical, but reads the bank only once. There are as many patches as
  /// scores.
  void project_all(std::span<const std::span<const float>> patches, std::span<const std::span<float>> scores) const;
  /// Copies the values of one template, sample by sample: window_samples()^2 elements.
  void copy_template(std::size_t index, std::span<float> values) const;
  /// Adds `amount` times the value of every template at one sample to the scores. This is the change of project() if
  /// that sample of the patch changes by `amount`.
  void add_sample(std::size_t sample, float amount, std::span<float> scores) const;
  /// Returns the noise of the eye; null without an eye.
  [[nodiscard]] const EyeNoise* eye() const { return eye_.get(); }
  /// Returns the sum of the squares of a template's values; 1 without an eye.
  [[nodiscard]] double square(std::size_t index) const;
  /// Returns one template as an image, for tests and pictures.
  [[nodiscard]] cv::Mat1f image(int alternative, int place) const;

  /// Returns the index of the search place without shift.
  [[nodiscard]] int central_place() const { return places_ / 2; }

  static constexpr std::size_t block = 64;                        ///< templates computed together
  static constexpr std::size_t max_bytes = std::size_t{1} << 30;  ///< 1 GiB

 private:
  TemplateBank() = default;
  void add_eye(const TemplateObserverSpec& spec, const Alternatives& alternatives, double size_samples,
               const FilterTable& filter);
  int window_ = 0, alternatives_ = 0, places_ = 0;
  std::size_t blocks_ = 0;
  std::shared_ptr<const EyeNoise> eye_;
  std::vector<float> values_;  ///< [block of templates][sample][template in block]
};

}  // namespace todbench
