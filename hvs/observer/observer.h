// Who answers "which way does it point?". An observer knows patches and alternatives, nothing of plates, files or
// cameras.
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "acquisition/core/rng.h"
#include "hvs/shape/polygon.h"

namespace todbench {

/// The window round one target, as displayed samples. Square, an even number of samples on a side.
struct Patch {
  cv::Mat1d kelvin;    ///< any constant background; only differences matter
  cv::Point2d phase;   ///< target centroid minus window centre, in samples; observers that search do not look at it
  double noise_k = 0;  ///< temporal noise of the sensor, sd per sample; only observers of limited efficiency look at it
};

/// The answer to one patch.
struct Choice {
  static constexpr int max_alternatives = 8;
  int alternative = 0;                            ///< index of the winner
  int alternatives = 0;                           ///< how many scores are valid
  std::array<double, max_alternatives> scores{};  ///< decision variable of each, in units of the contrast
};

/// How often an observer would give each answer to one patch, over all noise that it adds itself.
struct AnswerProbabilities {
  std::array<double, Choice::max_alternatives> probability{};  ///< of each alternative; they sum to 1
  double standard_error = 0;  ///< of the largest of them, where they come from draws of that noise; 0: exact
  int draws = 0;              ///< of that noise; 0: none was needed
};

/// The answer to one patch, and how probable it and the others are for this very patch.
struct GradedChoice {
  Choice choice;  ///< one answer, as choose() gives it
  AnswerProbabilities answers;
};

/// An observer prepared for one size on one sampling grid. Immutable, thread-safe, shared.
class PreparedObserver {
 public:
  virtual ~PreparedObserver() = default;
  /// Side of the square window it wants, in samples.
  [[nodiscard]] virtual int window_samples() const = 0;
  /// How far beyond the window's edge, in samples, its templates may look for the target (its search range).
  [[nodiscard]] virtual double search_samples() const = 0;
  /// Decides. `contrast_k` (sign included) is the effective contrast of the target; internal noise is drawn from
  /// `noise`, a stream of this trial alone. The patch has window_samples() on a side. Allocates nothing. Equal scores
  /// are decided by `noise`.
  [[nodiscard]] virtual Choice choose(const Patch& patch, double contrast_k, const RandomStream& noise) const = 0;
  /// choose(), and the probability of every answer given the patch, averaged over the observer's own noise: exactly
  /// where that is possible, else over `draws` of it. Allocates nothing after the first call.
  [[nodiscard]] virtual GradedChoice judge(const Patch& patch, double contrast_k, const RandomStream& noise,
                                           int draws) const = 0;
};

/// A model of an observer. Thread-safe.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Versioned name of the parameter set, e.g. "hvs-1".
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// The observer for targets of `size_samples` (square root of area) when `samples_per_pitch` displayed samples make a
  /// detector pitch (1; 2 for 2x2 microscan). Built once per argument pair and cached. `invalid_input` for a size that
  /// it cannot judge.
  [[nodiscard]] virtual Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                                int samples_per_pitch) = 0;
  /// Why it can no longer choose, for observers that are not in this program; choices made since are none.
  [[nodiscard]] virtual std::optional<Error> failure() const { return std::nullopt; }
};

/// The alternatives, each a polygon of unit area with its centroid at the origin, in the order of their labels.
using Alternatives = std::vector<Polygon>;

}  // namespace todbench
