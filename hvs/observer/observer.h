// SPDX-License-Identifier: GPL-3.0-or-later
// Interface of observers, which determine the orientation of a target. The input of an observer is limited to patches
// and alternatives. Observers have no access to plates, files or cameras.
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
  cv::Mat1d kelvin;   ///< temperatures; the level of the background has no effect, because only differences are used
  cv::Point2d phase;  ///< target centroid minus window centre, in samples; ignored by observers that search
  /// Temporal noise of the sensor, sd per sample; used only by observers that enlarge this noise.
  double noise_k = 0;
};

/// The answer to one patch.
struct Choice {
  static constexpr int max_alternatives = 8;
  int alternative = 0;                            ///< index of the best alternative
  int alternatives = 0;                           ///< number of valid scores
  std::array<double, max_alternatives> scores{};  ///< decision variable of each alternative, in units of the contrast
};

/// Probabilities of all answers of an observer to one patch, averaged over the noise that the observer adds.
struct AnswerProbabilities {
  std::array<double, Choice::max_alternatives> probability{};  ///< probability of each alternative; the sum is 1
  /// Standard error of the largest probability, if estimated from draws of the noise; 0: exact.
  double standard_error = 0;
  int draws = 0;  ///< number of noise draws; 0: exact
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
  /// Returns the side of the square window that the observer needs, in samples.
  [[nodiscard]] virtual int window_samples() const = 0;
  /// Returns the search range of the templates beyond the window's edge, in samples.
  [[nodiscard]] virtual double search_samples() const = 0;
  /// Returns the answer. `contrast_k` (with sign): effective contrast of the target. `noise`: random stream for this
  /// trial, for the internal noise and for the choice between equal scores. The patch has window_samples() on a side.
  /// Allocates no memory.
  [[nodiscard]] virtual Choice choose(const Patch& patch, double contrast_k, const RandomStream& noise) const = 0;
  /// Returns the answer of choose() and the probability of every answer to the patch, averaged over the internal noise.
  /// The average is exact if possible; otherwise it is taken over `draws` noise draws. Allocates no memory after the
  /// first call.
  [[nodiscard]] virtual GradedChoice judge(const Patch& patch, double contrast_k, const RandomStream& noise,
                                           int draws) const = 0;
};

/// A model of an observer. Thread-safe.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Returns the versioned name of the parameter set, e.g. "hvs-1".
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Returns the observer for targets of `size_samples` (square root of area). `samples_per_pitch`: displayed samples
  /// per detector pitch (1; 2 for 2x2 microscan). Observers are built once per argument pair and cached. Error:
  /// `invalid_input` for a size that the observer cannot judge.
  [[nodiscard]] virtual Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                                int samples_per_pitch) = 0;
  /// Returns the error of an external observer that can no longer answer. Choices made since then are invalid.
  [[nodiscard]] virtual std::optional<Error> failure() const { return std::nullopt; }
};

/// The alternatives, each a polygon of unit area with its centroid at the origin, in the order of their labels.
using Alternatives = std::vector<Polygon>;

}  // namespace todbench
