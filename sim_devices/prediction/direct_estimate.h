// SPDX-License-Identifier: GPL-3.0-or-later
// The 75 % size of a simulated sensor without trials and without a psychometric form: interpolated proportion correct
// of the searching observer, averaged over the phases.
#pragma once

#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/size_trial.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

struct DirectPoint {
  double delta_t_k = 0;
  /// Contrast that the observer divides by: the set contrast, or the reading of the camera if its counts are too coarse
  /// or too few.
  double seen_delta_t_k = 0;
  double s75_pitch = 0;  ///< in detector pitches
  double standard_error_pitch = 0;
  std::vector<double> sizes_pitch;
  std::vector<double> proportion_correct;
  int noise_draws = 0;  ///< per size
};

struct DirectEstimateOptions {
  int samples_per_pitch = 0;  ///< 2: 2x2 microscan; 0: as in the sensor
  SceneMotion motion{};
  Accuracy accuracy;
  std::uint64_t seed = 1;
  ShownOrientations orientations = ShownOrientations::as_needed;
  /// Temperature of the surround. It determines its place within a count and between the ends of the counts. Empty:
  /// scene_temperature_k of the sensor.
  std::optional<double> background_k{};
  /// True contrast of the scene, by the contrast that the camera read. Used only if counts are too coarse or too few. A
  /// contrast without entry is the true one, and its reading is the expected one.
  std::map<double, double> scene_delta_t_k{};
  std::stop_token stop{};  ///< ends with `interrupted` within a few hundredths of a second
};

/// One point per contrast (kelvin, > 0). Noise is drawn once per size and shared by phases and contrasts. If a count
/// exceeds the noise (rounds_coarsely()), or if the contrast reaches an end of the counts, the counts of every pixel
/// are simulated with one projection for each draw and phase, which takes up to sixteen times as long. If the accuracy
/// demands a standard error, draws are added until it is met. `invalid_input`: the camera's reading of a contrast is 0;
/// no size between 0.2 and 40 pitches brackets 75 %, so the contrast has no threshold; the demanded standard error
/// needs more draws than Accuracy::max_noise_draws (the message states the reachable one).
[[nodiscard]] Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                               TemplateObserver& observer,
                                                               const std::vector<double>& delta_t_k,
                                                               const DirectEstimateOptions& options);

/// Proportion correct over size at one contrast.
struct ProportionCurve {
  double delta_t_k = 0;
  std::vector<double> sizes_pitch;         ///< increasing, in steps of 8 %
  std::vector<double> proportion_correct;  ///< averaged over phases and noise
  std::vector<double> standard_error;      ///< of each
};

/// The function behind direct_estimate(), one curve per contrast, from nearly chance to nearly certain within 0.2 to 40
/// pitches. Uses the draws of the accuracy and ignores a demanded standard error. Other errors as direct_estimate().
[[nodiscard]] Result<std::vector<ProportionCurve>> proportion_curves(const SensorSpec& spec, const SensorPlan& plan,
                                                                     TemplateObserver& observer,
                                                                     const std::vector<double>& delta_t_k,
                                                                     const DirectEstimateOptions& options);

/// Predicted time for one contrast near `s75_pitch`, on one core with about 2 x 10^10 template samples a second.
[[nodiscard]] double predicted_direct_seconds(const TemplateObserverSpec& observer, const SensorSpec& sensor,
                                              double s75_pitch, int noise_draws, int phases_per_axis);

}  // namespace todbench
