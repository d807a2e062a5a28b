// SPDX-License-Identifier: GPL-3.0-or-later
// Row of one effect of the sensor chain: parameters, neutral value, stage, and bound for the planner. All other parts
// of the program read this row.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "acquisition/base/accuracy.h"
#include "acquisition/base/rng.h"
#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/effect_list.h"
#include "sim_devices/sensor/sensor_key.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// A sensor and a scene, as input of the stages of image formation. References are valid only during the call.
struct ChainScope {
  const SensorSpec& spec;
  const SensorPlan& plan;
  int wavelengths = 16;  ///< number of nodes of the spectral band
  SceneMotion motion{};
};

/// Random numbers by name, for one exposure of a camera or one draw of the estimate without frames. `ago` selects the
/// numbers of an earlier exposure, for noise that is correlated in time. Numbers of different names are independent.
using NoiseStreams = std::function<RandomStream(std::string_view name, std::uint64_t ago)>;
/// Changes a picture of samples in place.
using PictureStage = std::function<void(cv::Mat1f& picture)>;

/// The stage of the chain in which an effect acts, and its action.
namespace stage {

/// Optics: multiplies by a function of the radial frequency in cycles per pitch.
struct Optics {
  std::function<double(double rho)> (*factor)(const ChainScope& scope);
};
/// Detector: multiplies by factor(u) along x and factor(w) along y.
struct Footprint {
  double (*factor)(double f_per_pitch, const SensorSpec& spec, PitchAxis axis);
};
/// Any other filter of the continuous image. An empty function means that there is no filter.
struct Transfer {
  TransferFunction (*factor)(const ChainScope& scope);
};
/// Moves the positions of samples: returns the motion in pitches from one row of detectors to the next.
struct Readout {
  cv::Point2d (*pitches_per_row)(const SensorSpec& spec, SceneMotion motion);
};
/// Moves the positions of the whole scene, moving or not (effect_distortion.h).
struct Lens {};
/// Moves the whole scene, differently in each exposure (effect_image_dance.h).
struct Dance {};
/// Has no action: sets wavelengths or numbers of exposures that other effects read.
struct Parameter {};

/// Dependence of the noise between samples.
enum class Colour {
  white,    ///< the noise of the samples is independent; its variance is `white_variance_k2` of the row
  coloured  ///< samples share random numbers
};
/// Dependence of the noise between frames.
enum class Recurrence {
  every_exposure,  ///< the random numbers are new in each exposure
  fixed            ///< the random numbers are the same in every frame
};
/// Adds noise to a picture of samples, multiplied by `weight`: the weight of one exposure in an average over
/// exposures.
struct Noise {
  Colour colour;
  Recurrence recurrence;
  void (*add)(cv::Mat1f& picture, const SensorSpec& spec, const NoiseStreams& streams, double weight);
};
/// Works on the averaged picture, after all noise. Prepared once for a sensor in which the effect is not neutral.
struct Picture {
  PictureStage (*prepare)(const SensorSpec& spec, const NoiseStreams& streams);
};
/// The last stage: rounds to whole counts (effect_quantisation.h).
struct Counts {};

}  // namespace stage

using EffectStage = std::variant<stage::Optics, stage::Footprint, stage::Transfer, stage::Readout, stage::Lens,
                                 stage::Dance, stage::Parameter, stage::Noise, stage::Picture, stage::Counts>;

/// Extent over which a stage of image formation spreads the light of a point, in pitches.
struct Spread {
  double period = 0;      ///< distance by which the period is enlarged, so that tails do not wrap round
  double window = 0;      ///< distance by which a window is enlarged; shapes inside are computed exactly
  double variance = 0;    ///< variance in pitches squared, for the axis with the larger variance
  double far = 0;         ///< far r^(-5/3) is the share of light from beyond r pitches in a uniform plane
  double halo_share = 0;  ///< share of the light that is spread over `halo_reach`
  double halo_reach = 0;  ///< distance by which the period and a frame are enlarged for the halo
};

/// Samples that share one random number.
enum class SharedBy { detector, row, column };

/// Input of the planner's estimate of noise. Variances are per sample, in units of the contrast squared.
struct NoiseScope {
  const SensorSpec& spec;
  double contrast_k2 = 1;  ///< contrast squared, in K^2
  /// Returns the variance of the differences between templates for random numbers that these samples share, divided by
  /// the variance for white noise of the same size.
  std::function<double(SharedBy)> variance_ratio;
};

/// One contrast of a scene, as the planner expects it: the input of a bound. References are valid only during the call.
struct ExpectedScene {
  const SensorSpec& spec;
  const SensorPlan& everything;  ///< every effect that is not neutral
  SceneMotion motion{};
  double s75_pitch = 0;
  double noise_exponent = 0;                                ///< d ln S75 / d ln (noise / contrast), margin included
  std::array<double, all_effects.size()> noise_variance{};  ///< variance of each effect, in units of the contrast
                                                            ///< squared
  double total_variance = 0;                                ///< variance of all noise, including the noise of the
                                                            ///< observer
  /// Returns the change of ln S75 if this effect is left out, from the ratio of discriminabilities.
  std::function<double(Effect without)> discriminability_change;

  [[nodiscard]] double variance_of(Effect effect) const { return noise_variance[static_cast<std::size_t>(effect)]; }
  /// Returns the change of ln S75 for a change of the noise variance, in units of the contrast squared.
  [[nodiscard]] double noise_change(double variance_change) const;
};

/// Permission for the planner to skip an effect that has a bound.
enum class WhenBounded { may_be_skipped, simulated };
/// Whether the effect acts alike along both axes. alike: the effect changes a picture that is rotated by 90 degrees in
/// the same way as the original picture.
enum class AxisDirections { alike, different };

/// Row of the table. A member at its default means that the effect does not use it.
struct EffectRow {
  std::string_view title;  ///< title in the report
  std::vector<SensorKey> keys;
  /// Returns a sentence about an impossible combination of parameters; otherwise empty. Called after the check of the
  /// ranges.
  std::string (*impossible)(const SensorSpec& spec) = nullptr;

  bool (*is_neutral)(const SensorSpec& spec, SceneMotion motion) = nullptr;
  /// Sets the neutral value. Null if the effect has no neutral value; its stage then reads the plan.
  void (*neutralise)(SensorSpec& spec) = nullptr;
  std::string_view neutral;  ///< the neutral value in words: "netd_k is 0"

  EffectStage stage = stage::Parameter{};
  AxisDirections directions = AxisDirections::alike;
  Spread (*spread)(const ChainScope& scope) = nullptr;
  /// Highest frequency that passes, in cycles per pitch.
  double (*band)(const SensorSpec& spec, const Accuracy& accuracy) = nullptr;

  /// Variance per displayed sample of spatially white noise, averaged over exposures. `noise_factor`: factor by which
  /// the observer enlarges the temporal noise.
  double (*white_variance_k2)(const SensorSpec& spec, double noise_factor) = nullptr;
  /// For coloured noise: variance of white noise with the same effect on the threshold, in contrasts squared.
  double (*coloured_variance)(const NoiseScope& scope) = nullptr;
  /// Bound on the change of ln S75 when the effect is skipped; empty if there is no bound
  /// (docs/method/effect-planning.md).
  std::optional<double> (*bound)(const ExpectedScene& scene) = nullptr;
  std::string_view always;  ///< reason for which the effect is simulated, if it has no bound or is never skipped
  WhenBounded when_bounded = WhenBounded::may_be_skipped;
};

/// Returns the row of an effect. Immutable; lives as long as the program.
[[nodiscard]] const EffectRow& row_of(Effect effect);

/// Returns the variance of all white noise in the plan, per displayed sample. `noise_factor` as in EffectRow.
[[nodiscard]] double white_variance_k2(const SensorSpec& spec, const SensorPlan& plan, double noise_factor);

/// The rows. Each row is defined in the file of its effect.
namespace effect_rows {
#define TODBENCH_EFFECT_ROW(name) [[nodiscard]] EffectRow name();
TODBENCH_EFFECTS(TODBENCH_EFFECT_ROW)
#undef TODBENCH_EFFECT_ROW
}  // namespace effect_rows

}  // namespace todbench
