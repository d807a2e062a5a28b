// The 75 % size of a simulated sensor without trials and without a psychometric form: phase-averaged proportion correct
// of the searching observer, interpolated.
#pragma once

#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "acquisition/core/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/size_trial.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

struct DirectPoint {
  double delta_t_k = 0;
  /// What the observer divided by: the contrast, or what the camera reads of it where its counts are too coarse or too
  /// few.
  double seen_delta_t_k = 0;
  double s75_pitch = 0;  ///< in detector pitches
  double standard_error_pitch = 0;
  std::vector<double> sizes_pitch;
  std::vector<double> proportion_correct;
  int noise_draws = 0;  ///< per size
};

struct DirectEstimateOptions {
  int samples_per_pitch = 0;  ///< 2: 2x2 microscan; 0: as the sensor has it
  SceneMotion motion{};
  Accuracy accuracy;
  std::uint64_t seed = 1;
  ShownOrientations orientations = ShownOrientations::as_needed;
  /// Temperature of the surround: where it lies within a count, and between the ends of the counts; nothing: the
  /// sensor's scene_temperature_k.
  std::optional<double> background_k{};
  /// What the scene shows where a contrast is what a camera read of it; asked only where counts are too coarse or too
  /// few. By contrast; a missing one is what the scene shows, and its reading is the expected one.
  std::map<double, double> scene_delta_t_k{};
  std::stop_token stop{};  ///< ends with `interrupted`, within a few hundredths of a second
};

/// One point per contrast (kelvin, > 0). Noise is drawn once per size and shared by phases and contrasts.
/// Where a count is more than the noise (rounds_coarsely()), or the contrast reaches an end of the counts, the counts
/// of every pixel are simulated, one projection for each draw and phase: up to sixteen times as long. Where the
/// accuracy demands a standard error, draws are added until it is met. `invalid_input` when a camera reads nothing of a
/// contrast; when no size between 0.2 and 40 pitches brackets 75 %: the contrast then has no threshold; and when the
/// demanded standard error needs more draws than Accuracy::max_noise_draws: the message says what is reachable.
[[nodiscard]] Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                               TemplateObserver& observer,
                                                               const std::vector<double>& delta_t_k,
                                                               const DirectEstimateOptions& options);

/// Proportion correct over size at one contrast.
struct ProportionCurve {
  double delta_t_k = 0;
  std::vector<double> sizes_pitch;         ///< rising, in steps of 8 %
  std::vector<double> proportion_correct;  ///< averaged over phases and noise
  std::vector<double> standard_error;      ///< of each
};

/// The function behind direct_estimate(), from next to chance to next to certainty (at most 0.2 to 40 pitches), one
/// curve per contrast, from as many draws as the accuracy has, whatever standard error it demands. Errors as there, but
/// for that demand.
[[nodiscard]] Result<std::vector<ProportionCurve>> proportion_curves(const SensorSpec& spec, const SensorPlan& plan,
                                                                     TemplateObserver& observer,
                                                                     const std::vector<double>& delta_t_k,
                                                                     const DirectEstimateOptions& options);

/// Predicted time on one core of about 2 x 10^10 template samples a second, for one contrast near `s75_pitch`.
[[nodiscard]] double predicted_direct_seconds(const TemplateObserverSpec& observer, const SensorSpec& sensor,
                                              double s75_pitch, int noise_draws, int phases_per_axis);

}  // namespace todbench
