// SPDX-License-Identifier: GPL-3.0-or-later
// 75 % size of a simulated sensor without trials and without a psychometric form. It is interpolated from the
// proportion correct of the searching observer, averaged over the phases.
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

/// Estimate at one contrast.
struct DirectPoint {
  double delta_t_k = 0;
  /// Contrast by which the observer divides: the set contrast, or the reading of the camera if its counts are too
  /// coarse or too few for the set contrast.
  double seen_delta_t_k = 0;
  double s75_pitch = 0;                    ///< 75 % size in detector pitches
  double standard_error_pitch = 0;         ///< standard error of s75_pitch
  std::vector<double> sizes_pitch;         ///< estimated sizes
  std::vector<double> proportion_correct;  ///< proportion correct at each size
  int noise_draws = 0;                     ///< draws of noise for each size
};

/// Options of the estimate.
struct DirectEstimateOptions {
  int samples_per_pitch = 0;  ///< 2: 2x2 microscan; 0: as in the sensor
  SceneMotion motion{};       ///< motion of the target
  Accuracy accuracy;
  std::uint64_t seed = 1;
  ShownOrientations orientations = ShownOrientations::as_needed;  ///< orientations of the triangles
  /// Temperature of the surround, which determines the position of the surround within a count and within the range of
  /// counts. Empty: scene_temperature_k of the sensor.
  std::optional<double> background_k{};
  /// True contrast of the scene for each contrast that the camera reported. Used only if counts are too coarse or too
  /// few. A contrast without an entry is a true contrast, for which the expected reading is computed.
  std::map<double, double> scene_delta_t_k{};
  std::stop_token stop{};  ///< a stop request ends the estimate with `interrupted` within some hundredths of a second
};

/// Returns one point per contrast (kelvin, > 0). Noise is drawn once per size and shared by phases and contrasts. If a
/// count exceeds the noise (rounds_coarsely()), or if the contrast reaches the lowest or highest count, the function
/// simulates the counts of every pixel, with one projection for each draw and phase. This simulation takes up to
/// sixteen times as long. If the accuracy requires a standard error, draws are added until it is met. Errors:
/// `invalid_input` (the camera's reading of a contrast is 0; no size between 0.2 and 40 pitches brackets 75 %, so the
/// contrast has no threshold; the required standard error needs more draws than Accuracy::max_noise_draws; the message
/// states the reachable standard error).
[[nodiscard]] Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                               TemplateObserver& observer,
                                                               const std::vector<double>& delta_t_k,
                                                               const DirectEstimateOptions& options);

/// Proportion correct over size at one contrast.
struct ProportionCurve {
  double delta_t_k = 0;
  std::vector<double> sizes_pitch;         ///< increasing, in steps of 8 %
  std::vector<double> proportion_correct;  ///< averaged over phases and noise
  std::vector<double> standard_error;      ///< standard error of each proportion
};

/// Returns the psychometric functions that direct_estimate() interpolates, one per contrast. The sizes extend from
/// nearly chance level to nearly 100 % correct answers, within 0.2 to 40 pitches. Uses the draws of the accuracy and
/// ignores a required standard error. Errors: those of direct_estimate() except for the standard error.
[[nodiscard]] Result<std::vector<ProportionCurve>> proportion_curves(const SensorSpec& spec, const SensorPlan& plan,
                                                                     TemplateObserver& observer,
                                                                     const std::vector<double>& delta_t_k,
                                                                     const DirectEstimateOptions& options);

/// Returns the predicted time in seconds for one contrast with a 75 % size near `s75_pitch`, on one core that projects
/// about 2 x 10^10 template samples a second.
[[nodiscard]] double predicted_direct_seconds(const TemplateObserverSpec& observer, const SensorSpec& sensor,
                                              double s75_pitch, int noise_draws, int phases_per_axis);

}  // namespace todbench
