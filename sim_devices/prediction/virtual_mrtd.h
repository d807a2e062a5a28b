// The MRTD of a simulated camera judged by the template observer: four bars with the machinery of the triangles.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/bar_pattern.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/range/mrtd_formula.h"

namespace todbench {

enum class BarCriterion {
  four_or_five,   ///< two intervals, four bars in one and five in the other: which had four? 75 %, free of bias
  bars_resolved,  ///< yes or no: every gap lower than both bars beside it; 75 % yes, 5 % of them to nothing at all
  detection       ///< two intervals, four bars in one: which was it? 75 %; no MRTD
};
[[nodiscard]] std::string_view to_string(BarCriterion criterion);

struct VirtualMrtdTask {
  SensorSpec sensor;
  SensorPlan plan;
  TemplateObserverSpec observer{};
  Accuracy accuracy{};
  BarCriterion criterion = BarCriterion::four_or_five;
  BarAxis axis = BarAxis::horizontal;
  std::vector<double> frequencies_per_mrad;
  int draws = 2000;  ///< of noise, for each frequency
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

struct VirtualMrtdPoint {
  double frequency_per_mrad = 0;
  double frequency_over_nyquist = 0;
  /// Contrast in kelvin for 75 % over all phases; nothing: none up to the highest that was tried.
  std::optional<double> threshold_k;
  double relative_error = 0;  ///< one standard error of threshold_k over it, from the draws
  /// The same at the best and the worst of eight phases across the bars.
  std::optional<double> best_phase_k, worst_phase_k;
  double highest_k = 0;           ///< contrast at which it was given up
  double proportion_at_most = 0;  ///< right answers there, over all phases
  double ideal_k = 0;        ///< of an ideal observer that knows the phase, before the white noise of the sensor alone
  double share_of_four = 0;  ///< of phases across the bars at which four bars are apart, without noise
  double modulation_best = 0, modulation_worst = 0;  ///< of four sampled bars (tod/range/bars_sampled.h)
};

/// One point per frequency. Noise of camera and observer as in identify(); both intervals have noise and fixed pattern
/// of their own; patterns stand in one of 8 x 2 phases (eight across the bars). The proportion is that of all pairs of
/// draws. `invalid_input`: no frequency above 0, a pattern that has under four or over 400 samples on a side, no noise
/// at all, counts coarser than the noise; `interrupted`.
[[nodiscard]] Result<std::vector<VirtualMrtdPoint>> virtual_mrtd(const VirtualMrtdTask& task);

/// What the camera of the task shows of bars: the pictures of virtual_mrtd(), for another observer. Immutable,
/// thread-safe.
class BarFrames {
 public:
  /// Errors: those of virtual_mrtd() about the task.
  [[nodiscard]] static Result<BarFrames> of(const VirtualMrtdTask& task);
  /// Kelvin above the surround on the display, with the noise of this draw, in one of 8 x 2 phases. All frames of a
  /// frequency have one size.
  [[nodiscard]] cv::Mat1f frame_k(std::size_t frequency, BarPattern pattern, double contrast_k, std::size_t phase,
                                  std::uint64_t draw) const;
  /// As VirtualMrtdPoint::ideal_k.
  [[nodiscard]] double ideal_k(std::size_t frequency) const;

 private:
  struct Frequency;
  BarFrames() = default;
  std::vector<std::shared_ptr<const Frequency>> frequencies_;
};

}  // namespace todbench
