// SPDX-License-Identifier: GPL-3.0-or-later
// MRTD of a simulated camera: the template observer judges four bars with the same method as the triangles.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/bar_pattern.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/range/mrtd_formula.h"

namespace todbench {

/// Task of the observer.
enum class BarCriterion {
  four_or_five,  ///< two intervals with four and five bars: which had four? 75 %, free of bias
  /// Is every gap lower than both bars beside it? 75 % answers yes, at a limit with 5 % yes without bars. An observer
  /// with an eye judges the picture after display and eye (SeenPicture), any other observer the picture of the camera.
  bars_resolved,
  detection  ///< two intervals, one with four bars: which one? 75 %; not an MRTD
};
/// Returns the name with hyphens.
[[nodiscard]] std::string_view to_string(BarCriterion criterion);

/// MRTD to simulate.
struct VirtualMrtdTask {
  SensorSpec sensor;
  SensorPlan plan;  ///< planned effects
  TemplateObserverSpec observer{};
  Accuracy accuracy{};
  BarCriterion criterion = BarCriterion::four_or_five;  ///< task of the observer
  BarAxis axis = BarAxis::horizontal;                   ///< axis that the bars test
  std::vector<double> frequencies_per_mrad;             ///< frequencies of the bars, in cycles per mrad
  int draws = 2000;                                     ///< draws of noise for each frequency, at least 64
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Result at one frequency.
struct VirtualMrtdPoint {
  double frequency_per_mrad = 0;
  double frequency_over_nyquist = 0;  ///< bar frequency over the Nyquist frequency of the samples
  /// Contrast in kelvin at 75 % over all phases; empty if the proportion stays below 75 % up to highest_k.
  std::optional<double> threshold_k;
  /// threshold_k of an observer with an eye at both limits of its open parameters; empty if one of these limits has no
  /// threshold.
  std::optional<std::pair<double, double>> spread_k{};
  double relative_error = 0;  ///< standard error of threshold_k divided by threshold_k, from the draws
  /// Threshold in kelvin at the best and the worst of eight phases across the bars; empty if not reached.
  std::optional<double> best_phase_k, worst_phase_k;
  double highest_k = 0;           ///< highest contrast tried, at most 3081 times ideal_k
  double proportion_at_most = 0;  ///< correct answers at highest_k, over all phases
  /// Threshold in kelvin of an ideal observer that knows the phase, in the white noise of the sensor alone.
  double ideal_k = 0;
  double share_of_four = 0;  ///< share of the phases across the bars in which four bars are resolved without noise
  /// Modulation of four sampled bars at the best and worst phase (tod/range/bars_sampled.h).
  double modulation_best = 0, modulation_worst = 0;
};

/// Returns one point per frequency. Noise of camera and observer is as in identify(). Both intervals have independent
/// noise and fixed pattern. Patterns are in one of 8 x 2 phases (eight across the bars). The proportion
/// correct is computed over all pairs of a draw of one interval and a draw of the other interval. Errors:
/// `invalid_input` (no frequency above 0, a pattern with fewer than 4 or more than 400 samples on a side, no noise,
/// counts coarser than the noise), `interrupted`.
[[nodiscard]] Result<std::vector<VirtualMrtdPoint>> virtual_mrtd(const VirtualMrtdTask& task);

/// Pictures of virtual_mrtd() for use with a different observer. Immutable, thread-safe.
class BarFrames {
 public:
  /// Prepares the pictures of a task. Errors: those of virtual_mrtd() about the task.
  [[nodiscard]] static Result<BarFrames> of(const VirtualMrtdTask& task);
  /// Returns displayed kelvin above the surround, with the noise of this draw, in one of 8 x 2 phases. All frames of a
  /// frequency have the same size.
  [[nodiscard]] cv::Mat1f frame_k(std::size_t frequency, BarPattern pattern, double contrast_k, std::size_t phase,
                                  std::uint64_t draw) const;
  /// Returns VirtualMrtdPoint::ideal_k of this frequency.
  [[nodiscard]] double ideal_k(std::size_t frequency) const;

 private:
  struct Frequency;
  BarFrames() = default;
  std::vector<std::shared_ptr<const Frequency>> frequencies_;
};

}  // namespace todbench
