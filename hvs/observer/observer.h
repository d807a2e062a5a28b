// SPDX-License-Identifier: GPL-3.0-or-later
// Interface of observers, which answer the direction of a target. Their input is patches and alternatives only, not
// plates, files or cameras.
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/base/rng.h"
#include "hvs/shape/polygon.h"

namespace todbench {

/// The window around one target, in displayed samples. Square, an even number of samples on a side.
struct Patch {
  cv::Mat1d kelvin;    ///< any constant background; only differences matter
  cv::Point2d phase;   ///< target centroid minus window centre, in samples; ignored by observers that search
  double noise_k = 0;  ///< temporal noise of the sensor, sd per sample; used only by observers of limited efficiency
};

/// The answer to one patch.
struct Choice {
  static constexpr int max_alternatives = 8;
  int alternative = 0;                            ///< index of the best alternative
  int alternatives = 0;                           ///< number of valid scores
  std::array<double, max_alternatives> scores{};  ///< decision variable of each, in units of the contrast
};

/// Probability of each answer of an observer to one patch, over all noise that the observer adds.
struct AnswerProbabilities {
  std::array<double, Choice::max_alternatives> probability{};  ///< of each alternative; they sum to 1
  double standard_error = 0;  ///< of the largest probability, if estimated from draws of that noise; 0: exact
  int draws = 0;              ///< number of noise draws; 0: exact
};

/// The answer to one patch, and the probabilities of all answers to this patch.
struct GradedChoice {
  Choice choice;  ///< the answer of choose()
  AnswerProbabilities answers;
};

/// An observer prepared for one size on one sampling grid. Immutable, thread-safe, shared.
class PreparedObserver {
 public:
  virtual ~PreparedObserver() = default;
  /// Side of the square window that the observer needs, in samples.
  [[nodiscard]] virtual int window_samples() const = 0;
  /// Search range of its templates beyond the window's edge, in samples.
  [[nodiscard]] virtual double search_samples() const = 0;
  /// Returns the answer. `contrast_k` (with sign) is the effective contrast of the target. Internal noise is drawn from
  /// `noise`, a stream of this trial alone, which also decides between equal scores. The patch has window_samples() on
  /// a side. Allocates no memory.
  [[nodiscard]] virtual Choice choose(const Patch& patch, double contrast_k, const RandomStream& noise) const = 0;
  /// Returns choose() and the probability of every answer to the patch, averaged over the observer's own noise: exact
  /// if possible, otherwise over `draws` of it. Allocates no memory after the first call.
  [[nodiscard]] virtual GradedChoice judge(const Patch& patch, double contrast_k, const RandomStream& noise,
                                           int draws) const = 0;
};

/// A model of an observer. Thread-safe.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Versioned name of the parameter set, e.g. "hvs-1".
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Returns the observer for targets of `size_samples` (square root of area) when a detector pitch has
  /// `samples_per_pitch` displayed samples (1; 2 for 2x2 microscan). Built once per argument pair and cached. Error:
  /// `invalid_input` for a size that it cannot judge.
  [[nodiscard]] virtual Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                                int samples_per_pitch) = 0;
  /// Error of an external observer that can no longer answer; choices made since then are invalid.
  [[nodiscard]] virtual std::optional<Error> failure() const { return std::nullopt; }
};

/// The alternatives, each a polygon of unit area with its centroid at the origin, in the order of their labels.
using Alternatives = std::vector<Polygon>;

}  // namespace todbench
