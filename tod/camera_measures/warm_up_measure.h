// SPDX-License-Identifier: GPL-3.0-or-later
// Warm-up of a camera from its first image: level, fixed pattern and noise as functions of time and of the temperature
// of the camera.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measures/drift_law.h"

namespace todbench {

/// Options of measure_warm_up().
struct WarmUpOptions {
  double duration_s = 600;         ///< duration of the observation, > 0
  double start_s = 0;              ///< time from a starting moment, for example power-on, to the first image; all times
                                   ///< of the result are measured from this moment
  double frame_rate_hz = 0;        ///< frame rate that the camera states; 0: not stated
  double stable_k_per_min = 0.05;  ///< drift below which the level is stable, > 0
};

/// Successive frames of a uniform scene, in kelvin of the camera's scale.
struct WarmUpGroup {
  double time_s = 0;  ///< mean time
  int frames = 0;
  double mean_k = 0;
  double pattern_k = 0;  ///< standard deviation over the pixels, without shading and temporal noise
  double noise_k = 0;    ///< temporal noise of a pixel
  std::optional<double> camera_temperature_c{};
  bool corrected = false;  ///< a correction happened since the previous group
};

/// Change of the level with the temperature of the camera, by least squares.
struct TemperatureDrift {
  double slope = 0, slope_u = 0;  ///< K of the picture per K of the camera, with standard uncertainty
};

/// Result of measure_warm_up().
struct WarmUp {
  std::vector<WarmUpGroup> groups;
  /// Drift during the longest interval without a correction; empty if the fit failed, and `reasons` contains the
  /// reason.
  std::optional<DriftLaw> law{};
  /// Time after which the drift of the level stays below the limit. Empty: the limit is exceeded until the end of the
  /// observation, or there is no law.
  std::optional<double> stable_s{};
  std::optional<TemperatureDrift> by_temperature{};
  std::vector<std::string> reasons;  ///< reasons for absent values
};

/// Returns the temperature of the camera in degrees Celsius; empty: not reported.
using ReadCameraTemperature = std::function<std::optional<double>()>;

/// Observes the camera in 40 groups of equal duration with at most 64 frames each. Commands no correction. Errors:
/// those of FrameTaker::average().
[[nodiscard]] Result<WarmUp> measure_warm_up(FrameTaker& taker, const WarmUpOptions& options,
                                             const ReadCameraTemperature& temperature, const std::stop_token& stop);

/// Returns the time after which |d level / dt| stays below `k_per_min` according to the law. Empty if this time is
/// after the last group. For A (1 - exp(-t / T)), t from the first group, it is T ln(A / (T r)), r in K/s.
[[nodiscard]] std::optional<double> stable_from(const DriftLaw& law, double k_per_min);

}  // namespace todbench
