// Templates of any shapes for an observer that tells them apart: every alternative from every side, at every place of
// the search.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/core/result.h"
#include "hvs/observer/template_observer.h"
#include "hvs/shape/painted_shapes.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {

/// One alternative: its edges from every side, in displayed samples, near the origin. Levels in any unit.
using AlternativeAspects = std::vector<std::vector<StepEdge>>;

/// A camera that the observer knows: its transfer function in cycles per displayed sample, and where it is cut.
struct KnownCamera {
  TransferFunction transfer;
  double band_per_sample = 3;
};

/// Side of the window in which the alternatives are looked for, in samples, even.
[[nodiscard]] int identification_window_samples(const TemplateObserverSpec& spec,
                                                std::span<const AlternativeAspects> alternatives,
                                                int samples_per_pitch);

/// The template observer generalised from triangles: as there a template is the ideal picture behind display and blur
/// of the eye, without its mean and of unit norm, at every place of the search; an alternative's score is the largest
/// over its sides and places.
///
/// Blur harms the four orientations of one triangle alike; of different shapes it makes one look like another. So an
/// observer may know what its alternatives look like behind a camera: a template is then the picture behind the camera
/// in place of display and eye, and without noise the alternative that is shown has the largest score (Cauchy and
/// Schwarz).
///
/// The templates of one picture at all places, 289 in hvs-1, are sums of fewer orthonormal ones (30 to 70 for triangles
/// up to 4 samples), found so that what is left of every template is below 1e-4 of its norm. A score is off by at most
/// that much of the length of what is seen. Immutable, thread-safe.
class IdentificationBank {
 public:
  /// `camera`: nothing: ideal templates, as of triangles.
  /// `invalid_input`: fewer than two alternatives, one without sides or without edges, or templates that need over 1
  /// GiB.
  [[nodiscard]] static Result<IdentificationBank> build(const TemplateObserverSpec& spec,
                                                        std::span<const AlternativeAspects> alternatives,
                                                        int samples_per_pitch,
                                                        const std::optional<KnownCamera>& camera = std::nullopt);

  /// Side of the square window, in samples, even.
  [[nodiscard]] int window_samples() const { return window_; }
  [[nodiscard]] std::size_t alternatives() const { return first_aspect_.size() - 1; }
  /// Length of a score vector.
  [[nodiscard]] std::size_t scores() const { return aspects_.size() * static_cast<std::size_t>(places_ * places_); }
  /// Scores of all templates for a patch of window_samples()^2 values whose mean is 0.
  [[nodiscard]] std::vector<float> project(const cv::Mat1f& patch) const;
  /// project() of each, the same bits. Faster than one by one: the templates of large targets, hundreds of megabytes,
  /// are read once for all of them.
  [[nodiscard]] std::vector<std::vector<float>> project_all(std::span<const cv::Mat1f> patches) const;
  /// The alternative with the largest of signal + first_scale * first + second_scale * second, element by element.
  [[nodiscard]] std::size_t best(std::span<const float> signal, std::span<const float> first, float first_scale,
                                 std::span<const float> second, float second_scale) const;
  /// The largest of every alternative, one after the other.
  void largest_of_each(std::span<const float> signal, std::span<const float> first, float first_scale,
                       std::span<const float> second, float second_scale, std::span<float> largest) const;

 private:
  IdentificationBank() = default;
  int window_ = 0, places_ = 0;            ///< places per axis
  std::vector<cv::Mat1f> aspects_;         ///< [place][of the aspect's own part of the basis]
  std::vector<std::size_t> first_aspect_;  ///< of each alternative, and the end
  std::vector<float> basis_;  ///< of all aspects: [block][sample][in block], as the templates of TemplateBank
};

}  // namespace todbench
