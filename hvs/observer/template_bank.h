// SPDX-License-Identifier: GPL-3.0-or-later
// Templates of one observer for one target size: the ideal shapes after the viewing filter, at every search position.
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

/// Templates in single precision. Immutable, thread-safe. Without an eye each template has zero mean and unit norm.
/// With an eye the templates are the ideal shapes after display and eye, with a common scale factor: the central
/// template of the first alternative has the norm 1.
///
/// Template (o, p) is alternative o at search position p. A template has one value for the centre of each displayed
/// sample: k + 1/2 from the centre of the window, k = -m .. m - 1, where 2 m is the side of the window.
class TemplateBank {
 public:
  /// Computes the templates. Error: `invalid_input` if the bank would exceed `max_bytes`.
  [[nodiscard]] static Result<TemplateBank> build(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                                  double size_samples, int samples_per_pitch);

  /// Returns the side of the square window in samples, 2 m.
  [[nodiscard]] int window_samples() const { return window_; }
  /// Returns the number of alternatives.
  [[nodiscard]] int alternatives() const { return alternatives_; }
  /// Returns the number of search positions per alternative.
  [[nodiscard]] int places() const { return places_; }
  /// Returns the number of templates: alternatives() times places(). Template (o, p) has the index o * places() + p.
  [[nodiscard]] int templates() const { return alternatives_ * places_; }
  /// Returns the length of a score vector: templates() rounded up to whole blocks. The added scores are zero.
  [[nodiscard]] std::size_t padded_templates() const { return blocks_ * block; }
  /// Returns the number of blocks of templates.
  [[nodiscard]] std::size_t blocks() const { return blocks_; }

  /// Computes the scores of all templates for one patch. `patch`: window_samples()^2 values, row by row; `scores`:
  /// padded_templates() elements. Each score is a sum over samples in a fixed order, so it is bit-identical on every
  /// instruction set.
  void project(std::span<const float> patch, std::span<float> scores) const;
  /// Computes the scores of several patches. Reads the bank only once. The results are bit-identical to those of
  /// project(). Precondition: `patches` and `scores` have the same number of elements.
  void project_all(std::span<const std::span<const float>> patches, std::span<const std::span<float>> scores) const;
  /// Copies the values of one template. `values`: window_samples()^2 elements, in the order of the samples.
  void copy_template(std::size_t index, std::span<float> values) const;
  /// Updates the scores for a change of one sample of the patch by `amount`: adds `amount` times the value of every
  /// template at that sample.
  void add_sample(std::size_t sample, float amount, std::span<float> scores) const;
  /// Returns the noise of the eye; null without an eye.
  [[nodiscard]] const EyeNoise* eye() const { return eye_.get(); }
  /// Returns the sum of the squared values of a template; 1 without an eye.
  [[nodiscard]] double square(std::size_t index) const;
  /// Returns one template as an image, for tests and figures.
  [[nodiscard]] cv::Mat1f image(int alternative, int place) const;

  /// Returns the index of the search position without shift.
  [[nodiscard]] int central_place() const { return places_ / 2; }

  /// Number of templates that are computed together.
  static constexpr std::size_t block = 64;
  /// Largest size of a bank: 1 GiB.
  static constexpr std::size_t max_bytes = std::size_t{1} << 30;

 private:
  TemplateBank() = default;
  void add_eye(const TemplateObserverSpec& spec, const Alternatives& alternatives, double size_samples,
               const FilterTable& filter);
  /// Side of the window in samples, number of alternatives, and number of search positions per alternative.
  int window_ = 0, alternatives_ = 0, places_ = 0;
  /// Number of blocks of templates.
  std::size_t blocks_ = 0;
  /// Noise of the eye; null without an eye.
  std::shared_ptr<const EyeNoise> eye_;
  /// Values of the templates: [block of templates][sample][template in block].
  std::vector<float> values_;
};

}  // namespace todbench
