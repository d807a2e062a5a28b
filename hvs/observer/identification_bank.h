// SPDX-License-Identifier: GPL-3.0-or-later
// Templates of an observer that identifies arbitrary shapes: one template for every view of every alternative at every
// search position.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/template_observer.h"
#include "hvs/shape/painted_shapes.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// One alternative: a list of views, each with its edges in displayed samples near the origin. Levels may have any
/// unit.
using AlternativeAspects = std::vector<std::vector<StepEdge>>;

/// A camera whose blur the templates include: transfer function in cycles per displayed sample, and its cut-off.
struct KnownCamera {
  TransferFunction transfer;
  double band_per_sample = 3;
};

/// Returns a picture minus its background. The background is the mean of the picture or, for an observer with an eye,
/// the mean of its outermost samples. The reason is that an eye does not respond to a uniform field, but responds to a
/// part of the mean of a large target.
[[nodiscard]] cv::Mat1f without_background(const TemplateObserverSpec& spec, cv::Mat1f picture);

/// Returns the side of the search window in samples, an even number.
[[nodiscard]] int identification_window_samples(const TemplateObserverSpec& spec,
                                                std::span<const AlternativeAspects> alternatives,
                                                int samples_per_pitch);

/// The template observer, generalised from triangles to other shapes. A template is the ideal picture after display and
/// blur of the eye, at one search position, minus its mean and divided by its norm. The score of an alternative is the
/// largest score over its views and search positions.
///
/// Blur affects the four orientations of a triangle equally, but it can make different shapes similar. The templates
/// can therefore include the blur of a known camera. Without an eye (hvs-1) this blur replaces display and blur of the
/// eye; with an eye it is applied before display and eye. Without noise, the shown alternative then has the largest
/// score (Cauchy-Schwarz inequality).
///
/// The templates of one view at all search positions (289 in hvs-1) are computed as linear combinations of fewer
/// orthonormal pictures: 30 to 70 for triangles up to 4 samples. The residual of every template is below 1e-4 of its
/// norm, so the error of a score is at most 1e-4 of the norm of the patch.
///
/// With an eye (hvs-2) a template is the ideal picture after display and eye, divided by its norm after the eye. This
/// norm is equal for all orientations of a triangle, but differs between shapes. The noise of the eye is white after H.
/// The scores of this noise are computed from white pictures on a lattice that is fine enough for the eye. For these
/// scores, display and H are applied to the templates once. Immutable, thread-safe.
class IdentificationBank {
 public:
  /// Computes the templates. `camera`: empty for ideal templates, as for triangles. Error: `invalid_input` (fewer than
  /// two alternatives, an alternative without views, a view without edges, or templates of more than 1 GiB).
  [[nodiscard]] static Result<IdentificationBank> build(const TemplateObserverSpec& spec,
                                                        std::span<const AlternativeAspects> alternatives,
                                                        int samples_per_pitch,
                                                        const std::optional<KnownCamera>& camera = std::nullopt);

  /// Returns the side of the square window in samples, an even number.
  [[nodiscard]] int window_samples() const { return window_; }
  [[nodiscard]] std::size_t alternatives() const { return first_aspect_.size() - 1; }
  /// Returns the total number of views of all alternatives.
  [[nodiscard]] std::size_t views() const { return aspects_.size(); }
  /// Returns the length of a score vector.
  [[nodiscard]] std::size_t scores() const { return aspects_.size() * static_cast<std::size_t>(places_ * places_); }
  /// Returns the scores of all templates for a patch of window_samples()^2 values whose mean is 0.
  [[nodiscard]] std::vector<float> project(const cv::Mat1f& patch) const;
  /// Returns project() of each patch, with bit-identical results. One call is faster than single calls, because the
  /// templates, which may have hundreds of megabytes, are read only once.
  [[nodiscard]] std::vector<std::vector<float>> project_all(std::span<const cv::Mat1f> patches) const;
  /// Returns the side of a noise picture of the eye, in points of the fine lattice; 0 without an eye.
  [[nodiscard]] int eye_points() const { return eye_ ? eye_->window_ : 0; }
  /// Returns the scores of the eye's noise with standard deviation 1. `white`: pictures of white noise with standard
  /// deviation 1 and eye_points() on a side. Precondition: the observer has an eye.
  [[nodiscard]] std::vector<std::vector<float>> project_eye(std::span<const cv::Mat1f> white) const {
    return eye_->project_all(white);
  }
  /// Returns the standard deviation of the eye's noise in a score, for pictures in kelvin. `aspect`: index of the shown
  /// view; `contrast_k`: its contrast; `level`: this contrast in the unit of the edges of the view. `seeing`: the
  /// observer of the bank, or an observer that differs from that observer only in sensitivity, channels or contrast
  /// noise. Precondition: the observer has an eye.
  [[nodiscard]] double eye_noise_k(const TemplateObserverSpec& seeing, std::size_t alternative, std::size_t aspect,
                                   double contrast_k, double level) const;
  /// Returns d'^2 of a view at luminance contrast 1, for the observer of the bank; `level` as in eye_noise_k().
  [[nodiscard]] double eye_energy(std::size_t alternative, std::size_t aspect, double level) const;
  /// Returns the index of the alternative with the largest element of signal + first_scale * first + second_scale *
  /// second.
  [[nodiscard]] std::size_t best(std::span<const float> signal, std::span<const float> first, float first_scale,
                                 std::span<const float> second, float second_scale) const;
  /// Writes the largest element of the sum of best() for every alternative, in the order of the alternatives.
  void largest_of_each(std::span<const float> signal, std::span<const float> first, float first_scale,
                       std::span<const float> second, float second_scale, std::span<float> largest) const;

 private:
  IdentificationBank() = default;
  struct Views;
  Result<void> add(const Views& views);
  int window_ = 0, places_ = 0;            ///< search positions per axis
  std::vector<cv::Mat1f> aspects_;         ///< [search position][coefficient in the view's part of the basis]
  std::vector<std::size_t> first_aspect_;  ///< index of the first view of each alternative, then the number of views
  std::vector<float> basis_;  ///< orthonormal pictures of all views: [block][sample][in block], as in TemplateBank
  std::shared_ptr<const IdentificationBank> eye_;  ///< the same views on the lattice of the noise of the eye
  std::vector<double> energy_;                     ///< energy of each view after the eye, in samples; only with an eye
  TemplateObserverSpec spec_;
};

}  // namespace todbench
