// What one effect of the sensor chain is: its parameters, its neutral value, its stage in the chain, and what the
// planner may expect of it. Everything else in the program asks the row.
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

#include "acquisition/core/accuracy.h"
#include "acquisition/core/rng.h"
#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/effect_list.h"
#include "sim_devices/sensor/sensor_key.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The sensor before a scene, for stages of image formation. Borrowed for the call.
struct ChainScope {
  const SensorSpec& spec;
  const SensorPlan& plan;
  int wavelengths = 16;
  SceneMotion motion{};
};

/// Random numbers by name, for one exposure of a camera or one draw of the estimate without frames. `ago` is for noise
/// that remembers: the numbers of the exposure so many before. Numbers of another name are independent of them.
using NoiseStreams = std::function<RandomStream(std::string_view name, std::uint64_t ago)>;
/// Changes a picture of samples in place.
using PictureStage = std::function<void(cv::Mat1f& picture)>;

/// Where in the chain an effect acts, and how.
namespace stage {

/// Optics: multiplies by a function of the radial frequency in cycles per pitch.
struct Optics {
  std::function<double(double rho)> (*factor)(const ChainScope& scope);
};
/// Detector: multiplies by factor(u) factor(w).
struct Footprint {
  double (*factor)(double f_per_pitch, const SensorSpec& spec);
};
/// Any other filter of the continuous image; an empty function: none.
struct Transfer {
  TransferFunction (*factor)(const ChainScope& scope);
};
/// Moves the places of samples: a row of detectors samples so many pitches of motion later than the row above it.
struct Readout {
  cv::Point2d (*pitches_per_row)(const SensorSpec& spec, SceneMotion motion);
};
/// Moves the places of all that is seen, whatever moves (effect_distortion.h).
struct Lens {};
/// Moves all that an exposure sees (effect_image_dance.h).
struct Dance {};
/// Says how often or at which wavelengths others act, through the parameters that they read.
struct Parameter {};

enum class Colour {
  white,    ///< independent from sample to sample; its size is `white_variance_k2` of the row
  coloured  ///< samples share numbers
};
enum class Recurrence {
  every_exposure,  ///< new numbers in each
  fixed            ///< the same in every frame
};
/// Adds noise to a picture of samples, multiplied by `weight` (an average over exposures adds each with its part).
struct Noise {
  Colour colour;
  Recurrence recurrence;
  void (*add)(cv::Mat1f& picture, const SensorSpec& spec, const NoiseStreams& streams, double weight);
};
/// Works on the averaged picture, after all noise. Made once for a sensor; precondition: not neutral in it.
struct Picture {
  PictureStage (*prepare)(const SensorSpec& spec, const NoiseStreams& streams);
};
/// The last: whole counts (effect_quantisation.h).
struct Counts {};

}  // namespace stage

using EffectStage = std::variant<stage::Optics, stage::Footprint, stage::Transfer, stage::Readout, stage::Lens,
                                 stage::Dance, stage::Parameter, stage::Noise, stage::Picture, stage::Counts>;

/// How far a stage of image formation spreads the picture of a point, in pitches.
struct Spread {
  double period = 0;    ///< more of the period, so that tails do not wrap round
  double window = 0;    ///< more round a window, within which shapes are computed exactly
  double variance = 0;  ///< per axis, pitches squared
  double far = 0;       ///< of a plane, what lies more than r pitches away adds far r^(-5/3)
};

/// Which samples share one random number.
enum class SharedBy { detector, row, column };

/// Noise in the eyes of the planner, per sample and in units of the contrast squared.
struct NoiseScope {
  const SensorSpec& spec;
  double contrast_k2 = 1;
  /// How much more than white noise of the same size a number shared by so many samples moves the differences between
  /// templates, in variance.
  std::function<double(SharedBy)> variance_ratio;
};

/// One contrast of a scene, as the planner expects it: what a bound may ask. Borrowed for the call.
struct ExpectedScene {
  const SensorSpec& spec;
  const SensorPlan& everything;  ///< every effect that is not neutral
  SceneMotion motion{};
  double s75_pitch = 0;
  double noise_exponent = 0;                                      ///< d ln S75 / d ln q, with its margin
  std::array<double, all_effects.size()> noise_variance{};        ///< by effect, in units of the contrast squared
  double total_variance = 0;                                      ///< that of the observer included
  std::function<double(Effect without)> discriminability_change;  ///< of ln S75 by the ratio of discriminabilities

  [[nodiscard]] double variance_of(Effect effect) const { return noise_variance[static_cast<std::size_t>(effect)]; }
  /// Of ln S75 when the variance changes by so much.
  [[nodiscard]] double noise_change(double variance_change) const;
};

/// Whether the planner may skip an effect that it can bound.
enum class WhenBounded { may_be_skipped, simulated };
/// Whether a picture turned by a quarter is affected alike.
enum class Directions { alike, different };

/// A row of the table. What is left at its default the effect does not have.
struct EffectRow {
  std::string_view title;  ///< as in the report
  std::vector<SensorKey> keys;
  /// A combination of parameters that cannot be, as a sentence; empty: none. Ranges are checked before.
  std::string (*impossible)(const SensorSpec& spec) = nullptr;

  bool (*is_neutral)(const SensorSpec& spec, SceneMotion motion) = nullptr;
  /// Sets the neutral value. Without it the effect has none and its stage is asked of the plan.
  void (*neutralise)(SensorSpec& spec) = nullptr;
  std::string_view neutral;  ///< the neutral value in words: "netd_k is 0"

  EffectStage stage = stage::Parameter{};
  Directions directions = Directions::alike;
  Spread (*spread)(const ChainScope& scope) = nullptr;
  /// Highest frequency that passes, in cycles per pitch.
  double (*band)(const SensorSpec& spec, const Accuracy& accuracy) = nullptr;

  /// Variance per displayed sample of noise that is white in space, exposures averaged, in the eyes of an observer who
  /// suffers `noise_factor` times the temporal noise.
  double (*white_variance_k2)(const SensorSpec& spec, double noise_factor) = nullptr;
  /// White noise that would harm as much, for noise that is not white.
  double (*coloured_variance)(const NoiseScope& scope) = nullptr;
  /// A bound on the change of ln S75 that skipping the effect makes; nothing where none can be promised
  /// (docs/effect-planning.md).
  std::optional<double> (*bound)(const ExpectedScene& scene) = nullptr;
  std::string_view always;  ///< why it is simulated where there is no bound, or always
  WhenBounded when_bounded = WhenBounded::may_be_skipped;
};

/// The row of an effect. Immutable; lives as long as the program.
[[nodiscard]] const EffectRow& row_of(Effect effect);

/// Variance per displayed sample of all white noise that the plan simulates.
[[nodiscard]] double white_variance_k2(const SensorSpec& spec, const SensorPlan& plan, double noise_factor);

/// The rows, each defined in the file of its effect.
namespace effect_rows {
#define TODBENCH_EFFECT_ROW(name) [[nodiscard]] EffectRow name();
TODBENCH_EFFECTS(TODBENCH_EFFECT_ROW)
#undef TODBENCH_EFFECT_ROW
}  // namespace effect_rows

}  // namespace todbench
